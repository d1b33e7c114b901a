#include "lte/data/held_out.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/file.h"
#include "tests/data/sample_fixture.h"

namespace lte::data::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A data set of two samples, "mine" and "other".
class HeldOut : public Folder {
 protected:
  void SetUp() override {
    make_directory(folder_ / "scenes");
    for (const DatasetEntry& entry : entries_)
      write_scene_sample(scene_path(folder_, entry.name), make_sample());
  }

  /// Writes "other" again, as baked from a scene.
  void bake_from(const std::string& name, const std::string& geometry) {
    SceneSample sample = make_sample();
    sample.name = name;
    sample.geometry = geometry;
    write_scene_sample(scene_path(folder_, "other"), sample);
  }

  std::string refusal() {
    return error_of([&] { refuse_held_out(folder_, entries_); });
  }

  std::vector<DatasetEntry> entries_{{.name = "mine"}, {.name = "other"}};
};

TEST_F(HeldOut, TheListHasNamesAndChecksums) {
  std::set<std::string> names, prints;
  for (const HeldOutScene& scene : held_out_scenes()) {
    EXPECT_TRUE(names.insert(scene.name).second) << scene.name;
    EXPECT_TRUE(prints.insert(scene.geometry).second) << scene.name;
    EXPECT_EQ(scene.geometry.size(), 16u) << scene.name;
    EXPECT_EQ(scene.geometry.find_first_not_of("0123456789abcdef"), std::string::npos);
  }
  EXPECT_GE(names.size(), 14u);
}

TEST_F(HeldOut, OtherScenesPass) {
  EXPECT_EQ(refusal(), "");
  bake_from("my room", "0123456789abcdef");
  EXPECT_EQ(refusal(), "");
}

TEST_F(HeldOut, ANameInTheDataSetIsRefused) {
  entries_.push_back({.name = held_out_scenes().front().name});  // its file need not be there
  EXPECT_THAT(refusal(), AllOf(HasSubstr(folder_.string()),
                               HasSubstr("\"" + held_out_scenes().front().name + "\""),
                               HasSubstr("assets/scenes/outside")));
}

TEST_F(HeldOut, TheNameOfTheFileBehindASampleIsRefused) {
  bake_from(held_out_scenes().back().name, "");
  EXPECT_THAT(refusal(), AllOf(HasSubstr(folder_.string()), HasSubstr("\"other\""),
                               HasSubstr(held_out_scenes().back().name)));
}

TEST_F(HeldOut, ItsGeometryIsRefusedUnderAnyName) {
  bake_from("my room", held_out_scenes().back().geometry);
  EXPECT_THAT(refusal(), AllOf(HasSubstr("\"other\""), HasSubstr(held_out_scenes().back().name)));
}

TEST_F(HeldOut, FilesThatCannotBeReadAreLeftToTheirReader) {
  std::filesystem::remove(scene_path(folder_, "mine"));
  write_file(scene_path(folder_, "other"), "no sample");
  EXPECT_EQ(refusal(), "");
}

}  // namespace
}  // namespace lte::data::test
