// What a reader and a writer of scene samples refuse.
#include <cmath>
#include <limits>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/file.h"
#include "lte/base/safetensors.h"
#include "lte/data/scene_sample.h"
#include "tests/data/sample_fixture.h"
#include "tests/support/temp_dir.h"

namespace lte::data::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST_F(SceneSampleFile, MissingFileIsNamed) {
  EXPECT_THAT(error_of([&] { read_scene_sample(path()); }), HasSubstr(path().string()));
}

TEST_F(SceneSampleFile, EveryTruncationIsRefused) {
  write_scene_sample(path(), make_sample());
  const std::string bytes = read_file(path());
  for (const size_t size :
       {size_t{0}, size_t{4}, size_t{8}, size_t{100}, bytes.size() / 2, bytes.size() - 1}) {
    const auto cut = folder_ / "cut.safetensors";
    write_file(cut, std::string_view(bytes).substr(0, size));
    EXPECT_THAT(error_of([&] { read_scene_sample(cut); }), HasSubstr(cut.string()))
        << size << " bytes";
  }
}

/// Every fifth bit, so that all places in a byte are met; refused, or the same sample.
TEST_F(SceneSampleFile, FlippedBitsAreRefusedOrHarmless) {
  const SceneSample whole = make_sample();
  write_scene_sample(path(), whole);
  const std::string bytes = read_file(path());
  const auto damaged = folder_ / "damaged.safetensors";
  size_t harmless = 0;
  for (size_t bit = 0; bit < 8 * bytes.size(); bit += 5) {
    std::string copy = bytes;
    copy[bit / 8] = static_cast<char>(copy[bit / 8] ^ (1 << bit % 8));
    lte::test::write_text(damaged, copy);
    try {
      expect_equal(read_scene_sample(damaged), whole);
      ++harmless;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("damaged.safetensors")) << "bit " << bit;
    }
  }
  EXPECT_LE(harmless, 8 * std::string(kChecksumKey).size()) << "in the name of that key alone";
}

TEST_F(SceneSampleFile, ForeignAndNewerFilesAreRefused) {
  const float values[3] = {1, 2, 3};
  SafetensorsWriter weights;
  weights.add("weight", {3}, values);
  weights.write(path());
  EXPECT_THAT(error_of([&] { read_scene_sample(path()); }),
              AllOf(HasSubstr(path().string()), HasSubstr("format is missing")));
  weights.set_metadata("format", "lte-scene");
  weights.set_metadata("version", "2");
  weights.write(path());
  EXPECT_THAT(error_of([&] { read_scene_sample(path()); }),
              AllOf(HasSubstr("version 2"), HasSubstr("update lte")));
  weights.set_metadata("version", "-1");
  weights.write(path());
  EXPECT_THAT(error_of([&] { read_scene_sample(path()); }), HasSubstr("metadata version"));
  write_file(path(), "glTF is not safetensors, and this text is longer than a header length");
  EXPECT_THAT(error_of([&] { read_scene_sample(path()); }), HasSubstr(path().string()));
}

/// Rewrites a good file with one tensor replaced (no data: left out) and returns the reader's line.
std::string error_with(const std::filesystem::path& path, const std::string& name,
                       const TensorView& tensor) {
  write_scene_sample(path, make_sample());
  const auto broken = path.parent_path() / "broken.safetensors";
  {
    const SafetensorsFile file(path);
    SafetensorsWriter writer;
    for (const auto& [key, value] : file.metadata()) writer.set_metadata(key, value);
    for (const auto& [key, value] : file.tensors())
      if (key != name) writer.add(key, value);
    if (tensor.data) writer.add(name, tensor);
    writer.write(broken);
  }
  return error_of([&] { read_scene_sample(broken); });
}

TensorView floats(std::vector<int64_t> shape, const std::vector<float>& values) {
  return {DType::F32, std::move(shape), reinterpret_cast<const std::byte*>(values.data())};
}

TEST_F(SceneSampleFile, BadValuesAreNamedWithTensorAndIndex) {
  const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
  struct Case {
    const char* tensor;
    std::vector<int64_t> shape;
    size_t at;  // flat index of the bad value
    float bad, good;
    const char* entry;
  };
  const std::vector<Case> cases{{"scene_position", {8, 3}, 22, nan, 0, "entry 7"},
                                {"query_position", {6, 3}, 4, inf, 0, "entry 1"},
                                {"scene_emission", {8, 3}, 3, -1, 0, "entry 1"},
                                {"scene_albedo", {8, 3}, 0, 1.5f, 0.5f, "entry 0"},
                                {"query_albedo", {6, 3}, 17, -0.5f, 0.5f, "entry 5"},
                                {"scene_normal", {8, 3}, 6, 2, 0.57735027f, "entry 2"},
                                {"query_normal", {6, 3}, 9, 0, 0.57735027f, "entry 3"},
                                {"scene_area", {8}, 5, -0.1f, 1, "entry 5"},
                                {"direct", {2, 6, 3}, 35, -1e-3f, 1, "entry 11"},
                                {"indirect", {2, 6, 3}, 20, nan, 1, "entry 6"},
                                {"variance", {6}, 2, nan, 1, "entry 2"},
                                {"path_traced_64", {6, 3}, 1, -2, 1, "entry 0"},
                                {"view0_variance", {3, 4}, 11, -1, 1, "entry 11"},
                                {"view0_indirect", {2, 3, 4, 3}, 36, nan, 0, "entry 12"},
                                {"view0_position", {3, 4, 3}, 4, 1, 0, "entry 1 "}};
  for (const Case& c : cases) {
    int64_t numel = 1;
    for (const int64_t n : c.shape) numel *= n;
    std::vector<float> values(static_cast<size_t>(numel), c.good);
    values[c.at] = c.bad;
    EXPECT_THAT(error_with(path(), c.tensor, floats(c.shape, values)),
                AllOf(HasSubstr("broken.safetensors"), HasSubstr(concat("tensor ", c.tensor, ":")),
                      HasSubstr(c.entry)));
  }
}

TEST_F(SceneSampleFile, LightGroupsAndMasksOutOfRangeAreRefused) {
  for (const int32_t bad : {2, -2}) {
    std::vector<int32_t> light(8, -1);
    light[3] = bad;
    const TensorView tensor{DType::I32, {8}, reinterpret_cast<const std::byte*>(light.data())};
    EXPECT_THAT(error_with(path(), "scene_light", tensor),
                AllOf(HasSubstr("scene_light: entry 3"), HasSubstr("below 2")));
  }
  std::vector<uint8_t> mask(12, 1);
  mask[7] = 2;
  const TensorView tensor{DType::U8, {3, 4}, reinterpret_cast<const std::byte*>(mask.data())};
  EXPECT_THAT(error_with(path(), "view0_mask", tensor), HasSubstr("view0_mask: entry 7 is 2"));
}

TEST_F(SceneSampleFile, MissingTensorsAndWrongShapesOrTypesAreNamed) {
  for (const char* name :
       {"scene_position", "scene_area", "direct", "variance", "view0_mask", "view0_indirect"})
    EXPECT_THAT(error_with(path(), name, {}),
                AllOf(HasSubstr("broken.safetensors"), HasSubstr(name)));
  const std::vector<float> ones(64, 1);
  EXPECT_THAT(error_with(path(), "scene_area", floats({7}, ones)), HasSubstr("scene_area"));
  EXPECT_THAT(error_with(path(), "direct", floats({6, 3}, ones)), HasSubstr("direct"));
  EXPECT_THAT(error_with(path(), "indirect", floats({3, 6, 3}, ones)), HasSubstr("indirect"));
  EXPECT_THAT(error_with(path(), "view0_mask", floats({3, 4}, ones)), HasSubstr("view0_mask"));
  EXPECT_THAT(error_with(path(), "view0_albedo", floats({4, 3, 3}, ones)),
              HasSubstr("view0_albedo"));
}

TEST_F(SceneSampleFile, BadMetadataIsNamed) {
  for (const auto& [key, value] :
       std::map<std::string, std::string>{{"seed", "one"},
                                          {"rays", "-5"},
                                          {"max_depth", "0"},
                                          {"target_error", "-0.1"},
                                          {"pruned_query_points", "few"},
                                          {"views", "99999"},
                                          {"bounds", "[0, 0, 0, 1]"},
                                          {"bounds", "[0, 0, 0, 1, 1, null]"}}) {
    write_scene_sample(path(), make_sample());
    const auto broken = folder_ / "broken.safetensors";
    const SafetensorsFile file(path());
    SafetensorsWriter writer;
    for (const auto& [name, tensor] : file.tensors()) writer.add(name, tensor);
    for (const auto& [name, text] : file.metadata()) writer.set_metadata(name, text);
    writer.set_metadata(key, value);
    writer.write(broken);
    EXPECT_THAT(error_of([&] { read_scene_sample(broken); }),
                AllOf(HasSubstr(broken.string()), HasSubstr(key)));
  }
}

TEST_F(SceneSampleFile, WriterRefusesWhatReaderWouldRefuse) {
  SceneSample short_array = make_sample();
  short_array.scene_area.pop_back();
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), short_array); }),
              HasSubstr("scene_area: expected 8 entries, got 7"));
  SceneSample black_hole = make_sample();
  black_hole.indirect[3].y = -1;
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), black_hole); }),
              HasSubstr("indirect: entry 3"));
  SceneSample wrong_group = make_sample();
  wrong_group.light_groups = 3;
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), wrong_group); }),
              HasSubstr("expected 18 entries, got 12"));
  SceneSample empty = make_sample(0, 6, 0);
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), empty); }),
              HasSubstr("at least one scene point"));
  EXPECT_FALSE(std::filesystem::exists(path())) << "a refused sample left a file";
}

TEST_F(SceneSampleFile, UnwritablePlaceIsNamed) {
  write_file(folder_ / "file", "in the way");
  const auto below = folder_ / "file" / "room.safetensors";
  EXPECT_THAT(error_of([&] { write_scene_sample(below, make_sample()); }),
              HasSubstr(below.string()));
}

}  // namespace
}  // namespace lte::data::test
