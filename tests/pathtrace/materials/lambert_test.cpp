// The Lambertian surface keeps the contract of materials/bsdf.h.
#include "lte/pathtrace/materials/lambert.h"

#include <gtest/gtest.h>

#include "lte/base/random.h"

namespace lte::pathtrace {
namespace {

TEST(Lambert, ReflectsItsAlbedo) {
  constexpr int kSteps = 2000;
  const Rgb albedo{0.2f, 0.5f, 1};
  Rgb sum;
  double density = 0;
  for (int i = 0; i < kSteps; ++i) {  // dω = 2π d(cosθ)
    const float cosine = (static_cast<float>(i) + 0.5f) / kSteps;
    sum += lambert_value(albedo, cosine) * (2 * kPi / kSteps);
    density += double{lambert_pdf(cosine)} * 2 * M_PI / kSteps;
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], albedo[c], 1e-4f);
  EXPECT_NEAR(density, 1, 1e-6);
}

TEST(Lambert, WeighsAndDrawsWhatItSays) {
  const Vec3 normal = normalize({1, -2, 0.5f});
  const Rgb albedo{0.2f, 0.5f, 1};
  Rng rng(3);
  Vec3 mean;
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    float pdf = 0;
    const Vec3 direction = sample_lambert(normal, {rng.uniform(), rng.uniform()}, &pdf);
    const float cosine = dot(normal, direction);
    ASSERT_NEAR(length(direction), 1, 1e-5f);
    ASSERT_NEAR(pdf, lambert_pdf(cosine), 1e-5f);
    ASSERT_GE(pdf, 0);
    if (cosine > 1e-3f) {
      const Rgb weight = lambert_value(albedo, cosine) / lambert_pdf(cosine);
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(weight[c], lambert_weight(albedo)[c], 1e-6f);
    }
    mean += direction * (1.0f / kDraws);
  }
  // ∫ ω cosθ / π dω = 2/3 of the normal.
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(mean[axis], normal[axis] * 2 / 3, 0.02f);
}

}  // namespace
}  // namespace lte::pathtrace
