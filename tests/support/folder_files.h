// What a folder holds, to compare two of them.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "lte/base/file.h"

namespace lte::test {

/// Relative path -> bytes of every file below `folder` but .jsonl files, which hold times.
inline std::map<std::string, std::string> folder_files(const std::filesystem::path& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().extension() != ".jsonl")
      all[std::filesystem::relative(entry.path(), folder).string()] = read_file(entry.path());
  }
  return all;
}

}  // namespace lte::test
