// The cheap predictors against sums done by hand.
#include "infer/eval/rivals/baselines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/eval/rivals/blur.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "tests/infer/fixture.h"

namespace lte::infer {
namespace {

using data::SceneSample;

Baselines fit(const std::vector<SceneSample>& samples) {
  BaselineFit out;
  for (const SceneSample& sample : samples) out.add(sample);
  return out.finish();
}

QueryPoints queries_of(const SceneSample& sample) {
  return {sample.query_position, sample.query_normal, sample.query_albedo};
}

/// Emission scalar by its definition: area-weighted mean over points and channels.
double scalar_of(const SceneSample& sample) {
  double sum = 0, area = 0;
  for (size_t i = 0; i < sample.scene_area.size(); ++i) {
    const Rgb& e = sample.scene_emission[i];
    sum += sample.scene_area[i] * (e.x + e.y + e.z) / 3;
    area += sample.scene_area[i];
  }
  return sum / area;
}

TEST(ConstantMean, IsTheMeanOverScenesOfNormalizedIndirectIrradiance) {
  const std::vector<SceneSample> samples = {test::random_sample("a", 1),
                                            test::random_sample("b", 2)};
  double expected = 0;
  for (const SceneSample& sample : samples) {
    double sum = 0;
    for (const Rgb& value : sample.indirect) sum += value.x + value.y + value.z;
    // Groups add up; queries and channels are averaged.
    expected += sum / (3.0 * static_cast<double>(sample.query_points())) / scalar_of(sample) / 2;
  }
  const Baselines fitted = fit(samples);
  EXPECT_NEAR(fitted.mean, expected, 1e-5 * expected);
  EXPECT_EQ(fitted.scenes, 2);
  const BaselinePredictor predictor(fitted, samples[0], 1);
  for (const Rgb& value : predictor.constant_mean(queries_of(samples[0]))) {
    EXPECT_EQ(value, (Rgb{static_cast<float>(fitted.mean), static_cast<float>(fitted.mean),
                          static_cast<float>(fitted.mean)}));
  }
}

TEST(NearestPoint, FindsTheMeanOfItsOwnBinWhereScenePointsAreTheQueries) {
  SceneSample sample = test::random_sample("a", 5);
  // Irradiance that depends on what the bins see alone, so every bin's mean is exact: floor 3,
  // ceiling 1, walls 2.
  const auto light = [](const Vec3& n) { return n.y > 0.9f ? 3.0f : n.y < -0.9f ? 1.0f : 2.0f; };
  const auto N = static_cast<size_t>(sample.query_points());
  for (size_t i = 0; i < N; ++i) {
    sample.indirect[i] = sample.indirect[N + i] =
        Rgb{1, 2, 3} * (0.5f * light(sample.query_normal[i]));
  }
  const Baselines fitted = fit({sample});
  sample.scene_position = sample.query_position;
  sample.scene_normal = sample.query_normal;
  sample.scene_albedo = sample.query_albedo;
  const double radiance = scalar_of(test::random_sample("a", 5));
  const BaselinePredictor predictor(fitted, sample, radiance);
  const std::vector<Rgb> found = predictor.nearest_point(queries_of(sample));
  for (size_t i = 0; i < N; ++i) {
    const float expected = light(sample.query_normal[i]) / static_cast<float>(radiance);
    EXPECT_NEAR(found[i].x, expected, 1e-4f * expected);
    EXPECT_NEAR(found[i].z, 3 * expected, 3e-4f * expected);
  }
}

TEST(BlurSources, IsTheGaussianWeightedMeanByBruteForce) {
  const std::vector<Vec3> position = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}}, normal(3, Vec3{0, 1, 0});
  const std::vector<Rgb> albedo = {{0.5f, 1, 1}, {0.25f, 1, 1}, {1, 1, 1}},
                         direct = {{4, 1, 0}, {8, 2, 0}, {1, 3, 0}};
  const std::vector<Vec3> at = {{0.3f, 0.1f, 0}, {1000, 0, 0}};
  const std::vector<Rgb> blurred = BlurSources({position, normal, albedo}, direct).blur(at, 0.7);
  double sum = 0, weights = 0;
  for (size_t j = 0; j < 3; ++j) {
    const Vec3 offset = at[0] - position[j];
    const double weight = std::exp(-dot(offset, offset) / (2 * 0.7 * 0.7));
    sum += weight * albedo[j].x * direct[j].x;
    weights += weight;
  }
  EXPECT_NEAR(blurred[0].x, sum / weights, 1e-5);
  EXPECT_NEAR(blurred[1].x, (2 + 2 + 1) / 3.0, 1e-6) << "far away: the plain mean";
}

TEST(BlurredDirect, RecoversTheGainOfUniformLight) {
  SceneSample sample = test::random_sample("a", 7);
  const auto N = static_cast<size_t>(sample.query_points());
  for (size_t i = 0; i < N; ++i) {
    sample.query_albedo[i] = {0.5f, 0.5f, 0.5f};
    sample.direct[i] = sample.direct[N + i] = {2, 2, 2};      // 4 in all, 2 reflected
    sample.indirect[i] = sample.indirect[N + i] = {3, 3, 3};  // 6 in all: a gain of 3
  }
  const Baselines fitted = fit({sample});
  EXPECT_NEAR(fitted.blur_gain, 3, 1e-4);
  const BaselinePredictor predictor(fitted, sample, 2);
  for (const Rgb& value : predictor.blurred_direct(queries_of(sample)))
    EXPECT_NEAR(value.y, 6 / 2.0, 1e-4);
}

TEST(BlurredDirect, ChoosesTheBandwidthThatExplainsMost) {
  // The target is the light blurred with a known bandwidth, so that one must win, with the gain it
  // was made with.
  SceneSample sample = test::random_sample("a", 9);
  sample.light_groups = 1;
  sample.direct.resize(static_cast<size_t>(sample.query_points()));
  for (size_t i = 0; i < sample.direct.size(); ++i) {
    sample.direct[i] *= sample.query_position[i].x * sample.query_position[i].x * 4;
  }
  const double bandwidth = BaselineFit::kBandwidths[2];
  sample.indirect =
      BlurSources(queries_of(sample), sample.direct).blur(sample.query_position, bandwidth);
  for (Rgb& value : sample.indirect) value *= 1.5f;
  const Baselines fitted = fit({sample});
  EXPECT_EQ(fitted.blur_bandwidth, bandwidth);
  EXPECT_NEAR(fitted.blur_gain, 1.5, 1e-4);
}

TEST(Baselines, SurviveTheRoundTripThroughTheirFile) {
  const test::TempDir folder;
  const Baselines fitted = fit({test::random_sample("a", 1), test::random_sample("b", 2)});
  const auto path = baselines_path(folder / "model.safetensors");
  EXPECT_EQ(path.filename(), "model.baselines.json");
  write_baselines(path, fitted);
  const Baselines read = read_baselines(path);
  EXPECT_EQ(read.mean, fitted.mean);
  EXPECT_EQ(read.scenes, fitted.scenes);
  EXPECT_EQ(read.table, fitted.table);
  EXPECT_EQ(read.blur_bandwidth, fitted.blur_bandwidth);
  EXPECT_EQ(read.blur_gain, fitted.blur_gain);
}

TEST(Baselines, RefuseForeignFilesByName) {
  const test::TempDir folder;
  const auto message = [&](const std::string& text) {
    write_file(folder / "b.json", text);
    try {
      read_baselines(folder / "b.json");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("nothing was thrown");
  };
  EXPECT_THAT(message("{"), testing::HasSubstr("b.json"));
  EXPECT_THAT(message("[1, 2]"), testing::HasSubstr("b.json"));
  EXPECT_THAT(message(R"({"format":"other","version":1})"),
              testing::HasSubstr("not a baselines file"));
  EXPECT_THAT(message(R"({"format":"lte-baselines","version":2})"),
              testing::HasSubstr("version 2"));
  EXPECT_THROW(read_baselines(folder / "none.json"), Error);
  EXPECT_THROW(BaselineFit().finish(), Error);
}

}  // namespace
}  // namespace lte::infer
