#include "train/run_log.h"

#include <cmath>
#include <fstream>

#include <nlohmann/json.hpp>

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
