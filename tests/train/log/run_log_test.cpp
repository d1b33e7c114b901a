#include "train/log/run_log.h"

#include <cmath>
#include <fstream>

#include <nlohmann/json.hpp>

#include "lte/base/file.h"
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

TEST(RunLog, AFolderThatIsMissingIsNamed) {
  test::expect_error([] { RunLog("/nonexistent/folder/log.jsonl", 0); },
                     {"/nonexistent/folder/log.jsonl"});
}

}  // namespace
}  // namespace lte::train
