#include "train/log/run_log.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>

#include <nlohmann/json.hpp>

#include "lte/base/file.h"
#include "tests/support/file_limit.h"
#include "tests/train/support.h"

namespace lte::train {
namespace {

using Lines = std::vector<std::string>;

TEST(RunLog, WritesOneObjectALine) {
  const test::TempDir dir;
  RunLog log(dir / "log.jsonl", 0);
  log.write(10, {{"loss", 0.5}, {"lr", 1e-4}});
  log.write(20, {{"val_loss", std::nan("")}});
  const Lines lines = test::lines_of(dir / "log.jsonl");
  ASSERT_EQ(lines.size(), 2u);
  const auto first = nlohmann::json::parse(lines[0]), second = nlohmann::json::parse(lines[1]);
  EXPECT_EQ(first, (nlohmann::json{{"step", 10}, {"loss", 0.5}, {"lr", 1e-4}}));
  EXPECT_TRUE(second.at("val_loss").is_null()) << "JSON has no NaN";
}

TEST(RunLog, EventsGroupValidationAndNormsOfModules) {
  const test::TempDir dir;
  RunLog log(dir / "log.jsonl", 0);
  log.add_events(dir / "events", 0);
  log.write(10, {{"grad_norm", 2}, {"grad_norm_encoder_up0", 1}, {"val_loss", 3}});
  const auto file = std::filesystem::directory_iterator(dir / "events")->path();
  const std::string bytes = read_file(file);
  for (const char* tag : {"train/grad_norm", "grad_norm/encoder_up0", "val/loss"})
    EXPECT_NE(bytes.find(tag), std::string::npos) << tag;
  EXPECT_EQ(bytes.find("train/grad_norm_"), std::string::npos);
}

TEST(RunLog, IsCutBackToTheStepThatIsResumed) {
  const test::TempDir dir;
  std::ofstream(dir / "log.jsonl")
      << "{\"step\":1,\"loss\":3}\n{\"step\":2,\"loss\":2}\n{\"step\":2,\"val_loss\":2}\n"
         "{\"step\":3,\"loss\":1}\n{\"step\":4,\"lo";
  RunLog log(dir / "log.jsonl", 2);
  EXPECT_EQ(
      test::lines_of(dir / "log.jsonl"),
      (Lines{"{\"step\":1,\"loss\":3}", "{\"step\":2,\"loss\":2}", "{\"step\":2,\"val_loss\":2}"}));
  log.write(3, {{"loss", 1}});
  EXPECT_EQ(test::lines_of(dir / "log.jsonl").size(), 4u);
}

TEST(RunLog, ANewRunStartsAnEmptyFile) {
  const test::TempDir dir;
  std::ofstream(dir / "log.jsonl") << "{\"step\":0,\"loss\":3}\n";
  const RunLog log(dir / "log.jsonl", 0);
  EXPECT_TRUE(test::lines_of(dir / "log.jsonl").empty());
}

/// A log of 100 lines: the limit that stands for a full disk is one of every file, that of captured
/// warnings too, and these are shorter.
std::string long_log() {
  std::string text;
  for (int i = 0; i < 100; ++i) text += "{\"step\":1,\"note\":\"" + std::string(80, '.') + "\"}\n";
  return text;
}

/// Lines that a full disk keeps out wait, and come in their order; no line is cut.
TEST(RunLog, AFullDiskLosesNothing) {
  const test::TempDir dir;
  const std::filesystem::path path = dir / "log.jsonl";
  std::string said;
  {
    RunLog log(path, 1, long_log());
    const std::string before = read_file(path);
    testing::internal::CaptureStderr();
    {
      const test::FileLimit full(before.size() + 5);
      log.write(2, {{"loss", 2}});
      log.write(3, {{"loss", 3}});
      EXPECT_EQ(read_file(path), before) << "neither emptied nor with half a line";
      EXPECT_NE(log.text(), before);
    }
    log.write(4, {{"loss", 4}});
    EXPECT_EQ(read_file(path), log.text());
    said = testing::internal::GetCapturedStderr();
  }
  EXPECT_EQ(test::lines_of(path).size(), 103u);
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 2) << said;
  EXPECT_NE(said.find("File too large; lines wait"), std::string::npos) << said;
  EXPECT_NE(said.find("room again; 3 lines are written late"), std::string::npos) << said;
}

TEST(RunLog, TheEndSaysWhatIsMissingOrWritesIt) {
  const test::TempDir dir;
  for (const bool room_at_the_end : {false, true}) {
    const std::filesystem::path path = dir / (room_at_the_end ? "late.jsonl" : "never.jsonl");
    testing::internal::CaptureStderr();
    {
      std::optional<test::FileLimit> full;
      RunLog log(path, 1, long_log());
      full.emplace(long_log().size() + 5);
      log.write(1, {{"loss", 1}});
      log.write(2, {{"loss", 2}});
      if (room_at_the_end) full.reset();
    }
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(test::lines_of(path).size(), room_at_the_end ? 102u : 100u);
    EXPECT_NE(
        said.find(room_at_the_end ? "2 lines are written late" : "2 lines could not be written"),
        std::string::npos)
        << said;
  }
}

TEST(RunLog, OnAFullDiskTheOldFileStaysUntilTheNewOneFits) {
  const test::TempDir dir;
  const std::filesystem::path path = dir / "log.jsonl";
  const std::string old = "{\"step\":1,\"loss\":3}\n{\"step\":9,\"loss\":2}\n",
                    saved = "{\"step\":1,\"loss\":3}\n{\"step\":2,\"loss\":2}\n";
  write_file(path, old);
  testing::internal::CaptureStderr();
  {
    std::optional<test::FileLimit> full(std::in_place, 10);
    RunLog log(path, 2, saved);
    EXPECT_EQ(read_file(path), old);
    full.reset();
    log.write(3, {{"loss", 1}});
  }
  testing::internal::GetCapturedStderr();
  EXPECT_EQ(read_file(path), saved + "{\"step\":3,\"loss\":1.0}\n");
}

/// What TensorBoard reads stays whole: a record that did not fit is cut off, and comes later.
TEST(RunLog, EventsWaitToo) {
  const test::TempDir dir;
  const auto bytes_of = [&] {
    return read_file(std::filesystem::directory_iterator(dir / "events")->path());
  };
  RunLog log(dir / "log.jsonl", 0);
  log.add_events(dir / "events", 0);
  log.write(1, {{"loss", 1}});
  const std::string before = bytes_of();
  testing::internal::CaptureStderr();
  {
    const test::FileLimit full(before.size() + 7);
    log.write(2, {{"grad_norm", 2}});
    EXPECT_EQ(bytes_of(), before);
  }
  log.write(3, {{"lr", 3}});
  testing::internal::GetCapturedStderr();
  const std::string after = bytes_of();
  EXPECT_TRUE(after.starts_with(before));
  EXPECT_LT(after.find("train/grad_norm"), after.find("train/lr"));
  EXPECT_NE(after.find("train/lr"), std::string::npos);
}

TEST(RunLog, AFolderThatIsMissingIsNamed) {
  test::expect_error([] { RunLog("/nonexistent/folder/log.jsonl", 0); },
                     {"/nonexistent/folder/log.jsonl"});
}

}  // namespace
}  // namespace lte::train
