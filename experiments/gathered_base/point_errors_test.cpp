#include "experiments/gathered_base/point_errors.h"

#include <random>

#include <gtest/gtest.h>

#include "lte/base/check.h"

namespace lte::experiments {
namespace {

constexpr int kPoints = 20000;

std::vector<Rgb> around(float mean, float deviation, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<float> noise(0, deviation);
  std::vector<Rgb> out(kPoints);
  for (Rgb& value : out) value = {mean + noise(engine), mean + noise(engine), mean + noise(engine)};
  return out;
}

/// References of deviation 1 have no part in the error of an answer that is 0.3 too bright and has
/// a deviation of 0.2; two such answers share the 0.3 alone.
TEST(PointErrors, TakesTheNoiseOfReferencesAway) {
  const PointReferences references{around(10, 1, 1), around(10, 1, 2), around(10, 0.5f, 3)};
  const PointErrors errors(references);
  const std::vector<Rgb> first = around(10.3f, 0.2f, 4), second = around(10.3f, 0.2f, 5);
  EXPECT_NEAR(errors.mse(first), 0.09 + 0.04, 0.02);
  EXPECT_NEAR(errors.product(first, second), 0.09, 0.02);
  EXPECT_NEAR(errors.mean_ratio(first), 1.03, 0.002);
  EXPECT_NEAR(errors.worth(0.25), kFewPaths, 0.1 * kFewPaths);
}

TEST(PointErrors, CapsFireflies) {
  PointReferences references{around(1, 0, 1), around(1, 0, 2), around(1, 0, 3)};
  std::vector<Rgb> answers = references.a;
  answers[7] = {1e6f, 1, 1};
  EXPECT_FLOAT_EQ(PointErrors(references).cap(), 4);
  EXPECT_NEAR(PointErrors(references).mse(answers), 9.0 / (3 * kPoints), 1e-9);
}

TEST(PointErrors, RefusesDarknessAndOtherNumbers) {
  const PointReferences dark{{{}}, {{}}, {{}}};
  EXPECT_THROW(PointErrors{dark}, Error);
  const PointReferences references{{{1, 1, 1}}, {{1, 1, 1}}, {{1, 1, 1}}};
  EXPECT_THROW(PointErrors(references).mse({}), Error);
}

}  // namespace
}  // namespace lte::experiments
