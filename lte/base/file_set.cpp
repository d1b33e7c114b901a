#include "lte/base/file_set.h"

#include <system_error>

#include "lte/base/parallel_each.h"

namespace lte {
namespace {

std::string with_name(std::string text, const std::string& temporary, const std::string& name) {
  const size_t at = text.find(temporary);
  if (at != std::string::npos) text.replace(at, temporary.size(), name);
  return text;
}

}  // namespace

FileSet::FileSet(const std::filesystem::path& folder) : folder_(folder) {
  std::error_code ignored;
  made_ = !std::filesystem::exists(folder, ignored);
  make_directory(folder);
}

FileSet::~FileSet() {
  files_.clear();
  std::error_code ignored;
  // Only ever an empty one.
  if (made_) std::filesystem::remove(folder_, ignored);
}

void FileSet::write(const std::string& name, std::string_view text) {
  // Not into the file that stays open: what a full disk does to it would show in commit() alone.
  write(name, [&](const std::filesystem::path& path) { write_file(path, text); });
}

void FileSet::write(const std::string& name, const Writer& writer) {
  write_into(files_.emplace_back(folder_ / name).temporary_path(), name, writer);
}

void FileSet::write_all(const std::vector<std::pair<std::string, Writer>>& writers) {
  std::vector<std::filesystem::path> temporary;
  temporary.reserve(writers.size());
  for (const auto& [name, writer] : writers)
    temporary.push_back(files_.emplace_back(folder_ / name).temporary_path());
  parallel_each(writers.size(), 1,
                [&](size_t i) { write_into(temporary[i], writers[i].first, writers[i].second); });
}

void FileSet::write_into(const std::filesystem::path& temporary, const std::string& name,
                         const Writer& writer) const {
  try {
    writer(temporary);
  } catch (const DiskFull& error) {
    throw DiskFull(with_name(error.what(), temporary.string(), (folder_ / name).string()));
  } catch (const Error& error) {
    throw Error(with_name(error.what(), temporary.string(), (folder_ / name).string()));
  }
}

void FileSet::commit() {
  for (AtomicFile& file : files_) file.commit();
  files_.clear();
}

}  // namespace lte
