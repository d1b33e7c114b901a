// The constant against a sum done by hand, and its file.
#include "infer/eval/baselines/baselines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
