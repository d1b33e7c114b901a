// A folder of its own for a test of a tool, which is the current one while it runs.
#pragma once

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lte/base/log.h"
#include "tests/support/temp_dir.h"

namespace lte::test {

class InFolder : public ::testing::Test {
 protected:
  InFolder() : before_(std::filesystem::current_path()) {
    std::filesystem::current_path(dir_.path());
  }
  ~InFolder() override {
    std::filesystem::current_path(before_);
    set_log_level(LogLevel::Info);
  }

  /// The words of a command line that have no blanks in them.
  static std::vector<std::string> split(const std::string& line) {
    std::istringstream words(line);
    std::vector<std::string> out;
    for (std::string word; words >> word;) out.push_back(word);
    return out;
  }

  TempDir dir_;

 private:
  std::filesystem::path before_;
};

}  // namespace lte::test
