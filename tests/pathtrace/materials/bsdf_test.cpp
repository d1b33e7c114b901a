// The metallic surface against textbook formulas in double, quadrature and statistics.
#include <vector>

#include <gtest/gtest.h>

#include "lte/base/random.h"
#include "lte/pathtrace/materials/glossy_bsdf.h"
#include "tests/pathtrace/materials/ggx_reference.h"

namespace lte::pathtrace {
namespace {

using test::direction_at;
using test::Double3;
using test::ggx_reflection;
using test::integrate_hemisphere;

constexpr Vec3 kUp{0, 0, 1};

Vec3 to_vec(const Double3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

struct Case {
  float roughness;
  double theta;  ///< of the outgoing direction
  float metallic = 1;
};

/// What is steep lies around the mirror direction, which azimuth π of `outgoing` puts at 0.
Vec3 outgoing_of(const Case& c) { return to_vec(direction_at(c.theta, M_PI)); }
double width_of(const Case& c) { return std::max(0.02, 0.5 * c.roughness * c.roughness); }

class Glossy : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Cases, Glossy,
                         testing::Values(Case{0.15f, 0.3}, Case{0.3f, 0.0}, Case{0.3f, 1.2},
                                         Case{0.6f, 0.8}, Case{1, 0.1}, Case{1, 1.5},
                                         Case{0.4f, 0.7, 0.5f}, Case{0.2f, 1.0, 0.2f}));

TEST_P(Glossy, HasTheTextbooksValues) {
  const Case c = GetParam();
  const Rgb color{0.9f, 0.5f, 0};
  const double alpha = double{c.roughness} * c.roughness;
  const GlossyBsdf bsdf(color, c.metallic, c.roughness, kUp, outgoing_of(c));
  Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec2 u{rng.uniform(), rng.uniform()};
    // Half of them where the reflection is, half of them anywhere.
    const Vec3 in =
        i % 2 == 0 ? bsdf.sample(u).direction : to_vec(direction_at(1.5 * u.x, 6.2 * u.y));
    if (!(in.z > 0.01f)) continue;
    const Scattering got = bsdf.evaluate(in);
    for (int channel = 0; channel < 3; ++channel) {
      const double conductor = ggx_reflection(test::to_double(outgoing_of(c)), test::to_double(in),
                                              alpha, color[channel]);
      const double expected =
          c.metallic * conductor + (1 - c.metallic) * color[channel] * in.z / M_PI;
      ASSERT_NEAR(got.value[channel], expected, 2e-3 * expected + 1e-7) << i;
    }
  }
}

TEST_P(Glossy, IsReciprocal) {
  const Case c = GetParam();
  const Rgb color{0.9f, 0.5f, 0.1f};
  const Vec3 out = outgoing_of(c);
  Rng rng(2);
  for (int i = 0; i < 200; ++i) {
    const Vec3 in = to_vec(direction_at(1.5 * rng.uniform(), 2 * M_PI * rng.uniform()));
    const Rgb there =
        GlossyBsdf(color, c.metallic, c.roughness, kUp, out).evaluate(in).value / in.z;
    const Rgb back =
        GlossyBsdf(color, c.metallic, c.roughness, kUp, in).evaluate(out).value / out.z;
    for (int channel = 0; channel < 3; ++channel)
      ASSERT_NEAR(there[channel], back[channel], 1e-3 * there[channel]);
  }
}

/// A furnace of radiance 1: what a white surface sends back is its single-scattering albedo.
TEST_P(Glossy, FurnaceGivesTheAlbedoOfOneScattering) {
  const Case c = GetParam();
  const double alpha = double{c.roughness} * c.roughness;
  const Double3 out = test::to_double(outgoing_of(c));
  const double conductor = integrate_hemisphere(
      [&](const Double3& in) { return ggx_reflection(out, in, alpha, 1); }, c.theta, width_of(c));
  const double expected = c.metallic * conductor + (1 - c.metallic);
  EXPECT_LE(expected, 1 + 1e-4);
  const GlossyBsdf bsdf({1, 1, 1}, c.metallic, c.roughness, kUp, outgoing_of(c));
  double sum = 0, squares = 0;
  constexpr int kSide = 400;
  Rng rng(3);
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vec2 u{(static_cast<float>(i % kSide) + rng.uniform()) / kSide,
                 (static_cast<float>(i / kSide) + rng.uniform()) / kSide};
    const ScatteringSample sample = bsdf.sample(u);
    ASSERT_LE(sample.weight.x, 1.0001f);
    if (!(sample.pdf > 0)) continue;
    sum += sample.weight.x;
    squares += sample.weight.x * sample.weight.x;
  }
  const double n = kSide * kSide, mean = sum / n,
               error = std::sqrt((squares / n - mean * mean) / n);
  EXPECT_NEAR(mean, expected, 4 * error + 5e-4);
}

/// The density sums to the share of samples that are not lost below the surface.
TEST_P(Glossy, PdfIntegratesToTheShareOfSamplesThatLeave) {
  const Case c = GetParam();
  const GlossyBsdf bsdf({1, 1, 1}, c.metallic, c.roughness, kUp, outgoing_of(c));
  const double integral =
      integrate_hemisphere([&](const Double3& in) { return double{bsdf.evaluate(to_vec(in)).pdf}; },
                           c.theta, width_of(c));
  Rng rng(4);
  constexpr int kSamples = 100'000;
  int above = 0;
  for (int i = 0; i < kSamples; ++i)
    above += bsdf.sample({rng.uniform(), rng.uniform()}).pdf > 0 ? 1 : 0;
  const double share = static_cast<double>(above) / kSamples;
  EXPECT_NEAR(integral, share, 4 * std::sqrt(share * (1 - share) / kSamples) + 1e-3);
}

/// χ² of where samples fall against the density, in cells of equal solid angle.
TEST_P(Glossy, SamplesFallAsTheDensitySays) {
  const Case c = GetParam();
  const GlossyBsdf bsdf({1, 1, 1}, c.metallic, c.roughness, kUp, outgoing_of(c));
  constexpr int kRings = 12, kSectors = 12, kSamples = 200'000, kFine = 24;
  const auto cell_of = [](const Vec3& d) {
    const double ring = std::min(kRings - 1.0, std::floor((1 - double{d.z}) * kRings));
    const double turn = std::atan2(d.y, d.x) / (2 * M_PI) + 0.5;
    return static_cast<size_t>(ring * kSectors +
                               std::min(kSectors - 1.0, std::floor(turn * kSectors)));
  };
  std::vector<double> expected(kRings * kSectors), counts(kRings * kSectors);
  for (int ring = 0; ring < kRings * kFine; ++ring) {
    for (int sector = 0; sector < kSectors * kFine; ++sector) {
      const double cosine = 1 - (ring + 0.5) / (kRings * kFine);
      const double phi = 2 * M_PI * ((sector + 0.5) / (kSectors * kFine) - 0.5);
      const Vec3 in = to_vec(direction_at(std::acos(cosine), phi));
      expected[cell_of(in)] +=
          kSamples * bsdf.evaluate(in).pdf * 2 * M_PI / (kRings * kFine * kSectors * kFine);
    }
  }
  Rng rng(5);
  for (int i = 0; i < kSamples; ++i) {
    const ScatteringSample sample = bsdf.sample({rng.uniform(), rng.uniform()});
    if (sample.pdf > 0) ++counts[cell_of(sample.direction)];
  }
  double chi2 = 0, pooled = 0, pooled_count = 0;
  int freedom = 0;
  for (size_t i = 0; i < expected.size(); ++i) {
    if (expected[i] < 200) {
      pooled += expected[i];
      pooled_count += counts[i];
      continue;
    }
    // Midpoints leave an error of the density itself; it counts as a third of a percent.
    const double slack = 0.003 * expected[i];
    chi2 += (counts[i] - expected[i]) * (counts[i] - expected[i]) / (expected[i] + slack * slack);
    ++freedom;
  }
  EXPECT_LT(chi2, freedom + 5 * std::sqrt(2.0 * freedom) + 5) << freedom << " cells";
  EXPECT_NEAR(pooled_count, pooled, 5 * std::sqrt(pooled) + 0.02 * pooled + 5);
}

/// "Weak white furnace" (Heitz 2014): visible normals are a distribution, ∫ G1 (o·h)+ D / cosθ = 1.
TEST(Ggx, VisibleNormalsSumToOne) {
  for (const float alpha : {0.02f, 0.1f, 0.5f, 1.0f}) {
    for (const double theta : {0.0, 0.6, 1.3, 1.55}) {
      const Vec3 out = to_vec(direction_at(theta, M_PI));
      const double g1_over_cosine = 2.0 / (out.z + ggx_masking_root(out.z, alpha));
      const double sum = integrate_hemisphere(
          [&](const Double3& h) {
            return g1_over_cosine * ggx_distribution(to_vec(h), alpha) *
                   std::max(0.0, test::dot(test::to_double(out), h));
          },
          0, alpha);
      EXPECT_NEAR(sum, 1, 2e-3) << "alpha " << alpha << ", theta " << theta;
    }
  }
}

TEST(Ggx, NormalsProjectToTheWholeSurface) {
  for (const float alpha : {kMinAlpha, 0.1f, 1.0f}) {
    const double area = integrate_hemisphere(
        [&](const Double3& h) { return ggx_distribution(to_vec(h), alpha) * h[2]; }, 0, alpha);
    EXPECT_NEAR(area, 1, 1e-3);
  }
}

TEST(Ggx, WithoutRoughnessIsAMirror) {
  const Rgb f0{0.9f, 0.5f, 0};
  Rng rng(6);
  for (const double theta : {0.0, 0.5, 1.0, 1.4}) {
    const Vec3 normal = normalize({1, 2, -3});
    Vec3 tangent, bitangent;
    make_frame(normal, &tangent, &bitangent);
    const auto sine = static_cast<float>(std::sin(theta)),
               cosine = static_cast<float>(std::cos(theta));
    const GlossyBsdf bsdf(f0, 1, 0, normal, tangent * sine + normal * cosine);
    const Vec3 mirrored = tangent * -sine + normal * cosine;
    Rgb mean;
    for (int i = 0; i < 1000; ++i) {
      const ScatteringSample sample = bsdf.sample({0.99f * rng.uniform(), rng.uniform()});
      ASSERT_GT(dot(sample.direction, mirrored), 1 - 0.03f * 0.03f / 2) << theta;
      mean += sample.weight / 1000;
    }
    for (int c = 0; c < 3; ++c) {
      const double fresnel = f0[c] + (1 - f0[c]) * std::pow(1 - cosine, 5);
      EXPECT_NEAR(mean[c], fresnel, 1e-3 + 2e-3 * fresnel) << theta;
    }
  }
}

TEST(Ggx, StaysFiniteAtTheEdges) {
  for (const float roughness : {0.0f, 0.03f, 1.0f}) {
    for (const Vec3& out :
         {Vec3{1, 0, 0}, Vec3{0, 0, 1}, normalize({1, 0, 1e-6f}), Vec3{0, -1, 0}}) {
      const GlossyBsdf bsdf({1, 1, 1}, 1, roughness, kUp, out);
      for (const float a : {0.0f, 0.5f, 1 - 0x1p-24f}) {
        for (const float b : {0.0f, 0.25f, 0.75f, 1 - 0x1p-24f}) {
          const ScatteringSample sample = bsdf.sample({a, b});
          ASSERT_TRUE(is_finite(sample.direction) && is_finite(sample.weight));
          ASSERT_TRUE(std::isfinite(sample.pdf));
          ASSERT_LE(sample.weight.x, 1.001f);
          const Scattering back = bsdf.evaluate(normalize(Vec3{-out.x, -out.y, out.z + 1e-4f}));
          ASSERT_TRUE(is_finite(back.value) && std::isfinite(back.pdf));
        }
      }
    }
  }
}

/// What a white metal loses, as further scatterings are left out. Expected: 400,000 samples in
/// NumPy, microfacet normals drawn from D alone (Walter et al. 2007) instead of visible ones.
TEST(Ggx, LosesWhatSeveralScatteringsWouldReturn) {
  for (const auto& [roughness, reflected] :
       {std::pair{0.1f, 0.9994}, {0.3f, 0.9762}, {0.6f, 0.8022}, {1.0f, 0.4090}}) {
    constexpr int kSide = 300;
    Rng rng(7);
    double mean = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
      const Vec2 u{rng.uniform(), rng.uniform()};
      float pdf;
      const Vec3 out = cosine_direction(kUp,
                                        {(static_cast<float>(i % kSide) + rng.uniform()) / kSide,
                                         (static_cast<float>(i / kSide) + rng.uniform()) / kSide},
                                        &pdf);
      mean += GlossyBsdf({1, 1, 1}, 1, roughness, kUp, out).sample(u).weight.x / (kSide * kSide);
    }
    EXPECT_NEAR(mean, reflected, 0.004) << roughness;
  }
}

}  // namespace
}  // namespace lte::pathtrace
