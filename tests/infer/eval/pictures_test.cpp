// lte_eval pictures: figures of files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "infer/eval/pictures_command.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/image/exr.h"
#include "tests/support/temp_dir.h"

namespace lte::infer {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class PicturesCommand : public testing::Test {
 protected:
  std::string write(const std::string& name, int width, float value) {
    image::Image picture(width, 16, 3);
    std::fill(picture.pixels.begin(), picture.pixels.end(), value);
    std::string path = (folder_ / name).string();
    image::write_exr(path, {{"", &picture}});
    return path;
  }
  test::TempDir folder_;
};

TEST_F(PicturesCommand, WritesTheErrorOfEachPicture) {
  PicturesRequest request;
  request.references = {write("reference.exr", 20, 2)};
  request.pictures = {write("same.exr", 20, 2), write("brighter.exr", 20, 2.5f)};
  CommonOptions common;
  common.json = (folder_ / "scores.json").string();
  run_pictures(request, common);
  const auto json = nlohmann::json::parse(read_file(common.json));
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0]["picture"], request.pictures[0]);
  EXPECT_EQ(json[0]["mse"], 0);
  EXPECT_EQ(json[0]["flip"], 0);
  EXPECT_NEAR(json[1]["mse"].get<double>(), 0.25, 1e-5);
  // Over the mean of 2: (1.25 - 1)^2 / (1 + 0.01).
  EXPECT_NEAR(json[1]["relmse"].get<double>(), 0.0625 / 1.01, 1e-5);
  EXPECT_NEAR(json[1]["mean_ratio"].get<double>(), 1.25, 1e-5);
  EXPECT_GT(json[1]["flip"].get<double>(), 0);
  EXPECT_FALSE(json[1].contains("error"));
}

/// Noise of one reference changes sign from column to column, that of the other from row to row.
TEST_F(PicturesCommand, LeavesOutTheNoiseOfTwoReferences) {
  PicturesRequest request;
  for (const bool columns : {true, false}) {
    image::Image picture(24, 16, 3);
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        const float value = (columns ? x : y) % 2 == 0 ? 1.5f : 2.5f;
        picture.set_rgb(picture.number(x, y), {value, value, value});
      }
    }
    request.references.push_back((folder_ / (columns ? "a.exr" : "b.exr")).string());
    image::write_exr(request.references.back(), {{"", &picture}});
  }
  request.pictures = {write("dark.exr", 24, 1.8f)};
  CommonOptions common;
  common.json = (folder_ / "scores.json").string();
  run_pictures(request, common);
  const auto json = nlohmann::json::parse(read_file(common.json));
  EXPECT_NEAR(json[0]["error"].get<double>(), 0.1, 1e-5);
  EXPECT_NEAR(json[0]["noise"].get<double>(), 0.25, 1e-5);
  EXPECT_NEAR(json[0]["mean_ratio"].get<double>(), 0.9, 1e-5);
}

TEST_F(PicturesCommand, NamesThePictureOfAnotherSize) {
  PicturesRequest request;
  request.references = {write("reference.exr", 20, 2)};
  request.pictures = {write("wide.exr", 24, 2)};
  try {
    run_pictures(request, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("wide.exr"), HasSubstr("24x16"), HasSubstr("20x16")));
  }
  request.pictures = {write("same.exr", 20, 2)};
  request.references.push_back(write("broad.exr", 28, 2));
  try {
    run_pictures(request, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("broad.exr"), HasSubstr("28x16")));
  }
}

}  // namespace
}  // namespace lte::infer
