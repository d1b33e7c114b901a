#include "datagen/dataset/join.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/file.h"
#include "tests/data/sample_fixture.h"

namespace lte::datagen {
namespace {

using testing::HasSubstr;

class Join : public data::test::Folder {
 protected:
  /// A data set of two scenes, of which the second is for validation.
  data::DatasetInfo make(const std::string& set, const std::vector<std::string>& names) {
    std::filesystem::create_directories(folder_ / set / "scenes");
    data::DatasetInfo info;
    for (const std::string& name : names) {
      write_file(data::scene_path(folder_ / set, name), concat("sample ", set, " ", name));
      const auto split = info.scenes.empty() ? data::Split::Train : data::Split::Val;
      info.scenes.push_back({name, split, 7, 10, 20});
    }
    data::write_dataset_info(folder_ / set, info);
    return info;
  }
  void write(const std::string& set, const data::DatasetInfo& info) {
    data::write_dataset_info(folder_ / set, info);
  }
  std::string refusal(const std::vector<std::filesystem::path>& sets, const char* out = "out") {
    try {
      join(sets, folder_ / out);
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing was refused";
  }
};

TEST_F(Join, HasEveryScenesBytesAndSplit) {
  make("boxes", {"box_0", "box_1"});
  data::DatasetInfo homes = make("homes", {"home_0", "home_1"});
  homes.suns = true;
  write("homes", homes);
  join({folder_ / "boxes", folder_ / "homes"}, folder_ / "both");
  const data::DatasetInfo info = data::read_dataset_info(folder_ / "both");
  ASSERT_EQ(info.scenes.size(), 4u);
  EXPECT_TRUE(info.suns);
  EXPECT_EQ(data::entries_of(info, data::Split::Val).size(), 2u);
  EXPECT_EQ(read_file(data::scene_path(folder_ / "both", "home_1")), "sample homes home_1");
  EXPECT_EQ(read_file(data::scene_path(folder_ / "both", "box_0")), "sample boxes box_0");
}

TEST_F(Join, NamesAfterTheFolderWhatIsThereTwice) {
  make("a", {"box_0"});
  make("b", {"box_0", "box_1"});
  join({folder_ / "a", folder_ / "b/"}, folder_ / "both");
  EXPECT_EQ(read_file(data::scene_path(folder_ / "both", "box_0")), "sample a box_0");
  EXPECT_EQ(read_file(data::scene_path(folder_ / "both", "b_box_0")), "sample b box_0");
  EXPECT_EQ(read_file(data::scene_path(folder_ / "both", "box_1")), "sample b box_1");
}

TEST_F(Join, RefusesWhatCannotBeOneDataSet) {
  make("a", {"box_0"});
  data::DatasetInfo b = make("b", {"box_0"});
  EXPECT_THAT(refusal({folder_ / "a"}), HasSubstr("at least two"));
  EXPECT_THAT(refusal({folder_ / "a", folder_ / "b/../a"}), HasSubstr("twice"));
  EXPECT_THAT(refusal({folder_ / "a", folder_ / "none"}), HasSubstr("no such data-set"));
  EXPECT_THAT(refusal({folder_ / "a", folder_ / "b"}, "a"), HasSubstr("not empty"));
  b.scale = 23;
  write("b", b);
  EXPECT_THAT(refusal({folder_ / "a", folder_ / "b"}), HasSubstr("23 m"));
  b.scale = 16;
  b.pruned = true;
  write("b", b);
  EXPECT_THAT(refusal({folder_ / "a", folder_ / "b"}), HasSubstr("only where light"));
  b.pruned = false;
  b.light_paths = 8;
  write("b", b);
  EXPECT_THAT(refusal({folder_ / "a", folder_ / "b"}), HasSubstr("8 paths"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out")) << "nothing half-written";
}

}  // namespace
}  // namespace lte::datagen
