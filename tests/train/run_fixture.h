// Runs of the tiny configuration on four rooms, and how two of them are compared.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/train/support.h"
#include "train/loop/trainer.h"

namespace lte::test {

class RunFixture : public testing::Test {
 protected:
  static void SetUpTestSuite();
  static void TearDownTestSuite();

  train::TrainConfig config(const std::string& run, const std::string& extra = "") const {
    return tiny_config(data_->path(), dir_ / run, extra);
  }
  static train::TrainSummary train(const train::TrainConfig& config, bool resume = false,
                                   int64_t stop_after = 0) {
    return train::Trainer(config, "note: of the test\n", at::kCPU, resume).run(stop_after);
  }

  TempDir dir_;
  static TempDir* data_;
};

/// Tensors equal bit for bit, the log's bytes apart, which hold times; metadata may differ (it
/// names the run directory).
void expect_same_tensors(const std::filesystem::path& a, const std::filesystem::path& b);

/// Lines of the log without what a clock or a meter gives.
std::vector<nlohmann::json> log_values(const std::filesystem::path& run);

/// What `body` prints on standard error.
template <typename Body>
std::string captured_stderr(const Body& body) {
  testing::internal::CaptureStderr();
  body();
  return testing::internal::GetCapturedStderr();
}

}  // namespace lte::test
