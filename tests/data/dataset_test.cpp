#include "lte/data/dataset.h"

#include <array>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/file.h"
#include "tests/data/sample_fixture.h"

namespace lte::data::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class Dataset : public Folder {
 protected:
  /// A directory with the scene files that `info` names.
  void make(const DatasetInfo& info) {
    std::filesystem::create_directories(folder_ / "scenes");
    for (const DatasetEntry& entry : info.scenes) write_file(scene_path(folder_, entry.name), "");
    write_dataset_info(folder_, info);
  }
  std::string error() const {
    return error_of([&] { read_dataset_info(folder_); });
  }
  /// The good dataset.json with `from` replaced by `to`.
  void patch(const std::string& from, const std::string& to) {
    make(example());
    std::string text = read_file(folder_ / "dataset.json");
    const size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write_file(folder_ / "dataset.json", text.replace(at, from.size(), to));
  }
  static DatasetInfo example() {
    DatasetInfo info;
    info.tool_version = "0.1.0";
    info.seed = 18446744073709551615ULL;
    info.scale = 12.5;
    info.scenes = {{"a", Split::Train, 18446744073709551614ULL, 100, 200},
                   {"b", Split::Test, 2, 101, 201},
                   {"c", Split::Train, 3, 102, 202},
                   {"d-1.x_y", Split::Val, 4, 103, 203}};
    return info;
  }
};

TEST_F(Dataset, InfoComesBack) {
  const DatasetInfo written = example();
  make(written);
  const DatasetInfo read = read_dataset_info(folder_);
  EXPECT_EQ(read.version, 1);
  EXPECT_EQ(read.tool_version, written.tool_version);
  EXPECT_EQ(read.seed, written.seed);
  EXPECT_EQ(read.scale, written.scale);
  ASSERT_EQ(read.scenes.size(), written.scenes.size());
  for (size_t i = 0; i < read.scenes.size(); ++i) {
    EXPECT_EQ(read.scenes[i].name, written.scenes[i].name);
    EXPECT_EQ(read.scenes[i].split, written.scenes[i].split);
    EXPECT_EQ(read.scenes[i].seed, written.scenes[i].seed);
    EXPECT_EQ(read.scenes[i].scene_points, written.scenes[i].scene_points);
    EXPECT_EQ(read.scenes[i].query_points, written.scenes[i].query_points);
  }
}

TEST_F(Dataset, PruningAndThePlanComeBackAndOlderFilesHaveNeither) {
  DatasetInfo written = example();
  make(written);
  EXPECT_FALSE(read_dataset_info(folder_).pruned);
  EXPECT_EQ(read_dataset_info(folder_).planned, 4);
  written.pruned = true;
  written.planned = 9;
  make(written);
  EXPECT_TRUE(read_dataset_info(folder_).pruned);
  EXPECT_EQ(read_dataset_info(folder_).planned, 9);
  patch("\"pruned\": false,\n\"planned\": 4,\n", "");
  EXPECT_FALSE(read_dataset_info(folder_).pruned);
  EXPECT_EQ(read_dataset_info(folder_).planned, 4);
  EXPECT_EQ(read_file(folder_ / "dataset.json").find("suns"), std::string::npos)
      << "data without suns are the same bytes as ever";
  written.suns = true;
  make(written);
  EXPECT_TRUE(read_dataset_info(folder_).suns);
  patch("\"planned\": 4", "\"suns\": \"yes\",\n\"planned\": 4");
  EXPECT_THAT(error(), AllOf(HasSubstr("\"suns\""), HasSubstr("true or false")));
  patch("\"pruned\": false", "\"pruned\": 0");
  EXPECT_THAT(error(), HasSubstr("\"pruned\""));
  patch("\"planned\": 4", "\"planned\": 3");
  EXPECT_THAT(error(), AllOf(HasSubstr("\"planned\": 3"), HasSubstr("4 scenes are listed")));
}

TEST_F(Dataset, HowLightWasEstimatedComesBackAndHasDefaultsInOlderFiles) {
  DatasetInfo written = example();
  written.light_paths = 128;
  written.light_depth = 8;
  make(written);
  EXPECT_EQ(read_dataset_info(folder_).light_paths, 128);
  EXPECT_EQ(read_dataset_info(folder_).light_depth, 8);
  patch("\"light_paths\": 32,\n\"light_depth\": 5,\n", "");
  EXPECT_EQ(read_dataset_info(folder_).light_paths, 32);
  EXPECT_EQ(read_dataset_info(folder_).light_depth, 5);
  patch("\"light_paths\": 32", "\"light_paths\": 0");
  EXPECT_THAT(error(), AllOf(HasSubstr("\"light_paths\""), HasSubstr("got 0")));
  patch("\"light_depth\": 5", "\"light_depth\": 1025");
  EXPECT_THAT(error(), AllOf(HasSubstr("\"light_depth\""), HasSubstr("1 to 1024")));
  patch("\"light_depth\": 5", "\"light_depth\": \"5\"");
  EXPECT_THAT(error(), HasSubstr("expected a non-negative integer"));
}

TEST_F(Dataset, AnUnfinishedDatasetSaysSo) {
  std::filesystem::create_directories(folder_ / "scenes");
  write_file(folder_ / "config.yaml", "scenes: 4\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("unfinished"), Not(HasSubstr("--"))));
}

TEST_F(Dataset, EntriesOfASplitKeepFileOrder) {
  const auto train = entries_of(example(), Split::Train);
  ASSERT_EQ(train.size(), 2u);
  EXPECT_EQ(train[0].name, "a");
  EXPECT_EQ(train[1].name, "c");
  EXPECT_EQ(entries_of(example(), Split::Val).size(), 1u);
}

TEST_F(Dataset, EmptyListIsADataset) {
  make(DatasetInfo{});
  EXPECT_TRUE(read_dataset_info(folder_).scenes.empty());
}

TEST_F(Dataset, MissingDirectoryFileAndSceneAreNamed) {
  EXPECT_THAT(error_of([&] { read_dataset_info(folder_ / "none"); }),
              HasSubstr((folder_ / "none").string()));
  EXPECT_THAT(error(), HasSubstr("dataset.json: missing"));
  make(example());
  std::filesystem::remove(scene_path(folder_, "c"));
  EXPECT_THAT(error(), AllOf(HasSubstr("scenes[2]"), HasSubstr(scene_path(folder_, "c").string())));
}

TEST_F(Dataset, TruncatedAndForeignJsonAreRefused) {
  make(example());
  const std::string text = read_file(folder_ / "dataset.json");
  for (const size_t size : {size_t{0}, size_t{1}, text.size() / 2, text.size() - 3}) {
    write_file(folder_ / "dataset.json", text.substr(0, size));
    EXPECT_THAT(error(), HasSubstr("truncated")) << size << " bytes";
  }
  write_file(folder_ / "dataset.json", "[1, 2]");
  EXPECT_THAT(error(), HasSubstr("not a JSON object"));
}

TEST_F(Dataset, WrongKeysAreNamed) {
  const std::map<std::pair<std::string, std::string>, std::string> cases{
      {{"\"version\": 1", "\"version\": 2"}, "update lte"},
      {{"\"version\": 1", "\"version\": \"1\""}, "key \"version\""},
      {{"lte-dataset", "other"}, "key \"format\""},
      {{"\"scale\": 12.5", "\"scale\": -1"}, "key \"scale\""},
      {{"\"scale\": 12.5", "\"scal\": 1"}, "key \"scale\" is missing"},
      {{"\"name\": \"b\"", "\"name\": \"a\""}, "scenes[1]: key \"name\": \"a\" is there twice"},
      {{"\"name\": \"b\"", "\"name\": \"../b\""}, "is not a scene name"},
      {{"\"name\": \"b\"", "\"name\": 3"}, "scenes[1]: key \"name\""},
      {{"\"test\"", "\"exam\""}, "scenes[1]: key \"split\": \"exam\" is not a split"},
      {{"\"seed\": 2", "\"seed\": -2"}, "scenes[1]: key \"seed\""},
      {{"\"scene_points\": 101", "\"scene_points\": 1.5"}, "scenes[1]: key \"scene_points\""},
      {{"\"query_points\": 201", "\"queries\": 201"},
       "scenes[1]: key \"query_points\" is missing"}};
  for (const auto& [change, message] : cases) {
    patch(change.first, change.second);
    EXPECT_THAT(error(), AllOf(HasSubstr("dataset.json"), HasSubstr(message))) << change.second;
  }
}

TEST_F(Dataset, WriterRefusesNamesThatAreNoFiles) {
  for (const char* name : {"", ".hidden", "a/b", "a b", ".."}) {
    DatasetInfo info = example();
    info.scenes[0].name = name;
    EXPECT_THAT(error_of([&] { write_dataset_info(folder_, info); }),
                HasSubstr("is not a scene name"))
        << name;
  }
}

TEST(Split, NamesComeBackAndOthersAreRefused) {
  for (const Split split : {Split::Train, Split::Val, Split::Test})
    EXPECT_EQ(parse_split(split_name(split)), split);
  EXPECT_THAT(error_of([] { parse_split("Train"); }), HasSubstr("\"Train\""));
}

TEST(Split, SharesAreMetByEveryRunOfScenes) {
  for (const uint64_t seed : {0ULL, 1ULL, 77ULL}) {
    for (const int64_t start : {0, 1000}) {
      for (const int64_t count : {20, 100, 5000}) {
        std::array<int64_t, 3> counts{};
        for (int64_t i = start; i < start + count; ++i)
          ++counts[static_cast<size_t>(assign_split(seed, i, 0.1, 0.2))];
        EXPECT_NEAR(counts[1], 0.1 * count, 2.0) << "val of " << count << ", seed " << seed;
        EXPECT_NEAR(counts[2], 0.2 * count, 2.0) << "test of " << count << ", seed " << seed;
      }
    }
  }
}

TEST(Split, DependsOnSeedAndIndexAlone) {
  int moved = 0;
  for (int64_t i = 0; i < 100; ++i) {
    EXPECT_EQ(assign_split(5, i, 0.25, 0.25), assign_split(5, i, 0.25, 0.25));
    moved += assign_split(5, i, 0.25, 0.25) != assign_split(6, i, 0.25, 0.25);
  }
  EXPECT_GT(moved, 0);
}

TEST(Split, ExtremeSharesAndBadSharesAreHandled) {
  for (int64_t i = 0; i < 50; ++i) {
    EXPECT_EQ(assign_split(1, i, 0, 0), Split::Train);
    EXPECT_EQ(assign_split(1, i, 1, 0), Split::Val);
    EXPECT_EQ(assign_split(1, i, 0, 1), Split::Test);
  }
  EXPECT_THAT(error_of([] { assign_split(1, 0, 0.7, 0.6); }), HasSubstr("val_share"));
  EXPECT_THAT(error_of([] { assign_split(1, 0, -0.1, 0); }), HasSubstr("val_share"));
}

}  // namespace
}  // namespace lte::data::test
