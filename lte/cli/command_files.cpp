#include "lte/cli/command_files.h"

#include <algorithm>
#include <system_error>

#include <sys/stat.h>

#include "lte/base/check.h"
#include "lte/cli/cli.h"

namespace lte {
namespace {

namespace fs = std::filesystem;

/// Where writing to `path` would put a file: absolute, and every link followed, that of a file
/// which does not exist yet too.
fs::path place_of(fs::path path) {
  constexpr int kMaxLinks = 40;  // as the kernel
  std::error_code error;
  for (int i = 0; i < kMaxLinks && fs::is_symlink(path, error); ++i) {
    const fs::path target = fs::read_symlink(path, error);
    if (error) break;
    path = path.parent_path() / target;  // an absolute target replaces all before it
  }
  const fs::path absolute = fs::absolute(path, error);
  const fs::path place = fs::weakly_canonical(error ? path : absolute, error);
  return error ? absolute : place;
}

bool same_inode(const fs::path& a, const fs::path& b) {
  struct stat first {};
  struct stat second {};
  return ::stat(a.c_str(), &first) == 0 && ::stat(b.c_str(), &second) == 0 &&
         first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}

/// A device or a pipe.
bool is_stream(const fs::path& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode);
}

bool has_other_names(const fs::path& file) {
  struct stat info {};
  return ::stat(file.c_str(), &info) == 0 && S_ISREG(info.st_mode) && info.st_nlink > 1;
}

bool lies_in(const fs::path& place, const fs::path& folder) {
  const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), place.begin(), place.end());
  return end == folder.end() && rest != place.end();
}

/// Whether `file` is a hard link to a file somewhere in `folder`.
bool is_linked_in(const fs::path& file, const fs::path& folder) {
  std::error_code error;
  if (!has_other_names(file) || !fs::is_directory(folder, error)) return false;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error)) {
    if (same_inode(at->path(), file)) return true;
  }
  return false;
}

}  // namespace

void CommandFiles::claim(const std::string& flag, const fs::path& path, bool part,
                         std::vector<Claim>* claims) {
  if (!path.empty()) claims->push_back({flag, path, place_of(path), part});
}

void CommandFiles::reads(const std::string& flag, const fs::path& path) {
  claim(flag, path, false, &inputs_);
}

void CommandFiles::writes(const std::string& flag, const fs::path& path) {
  claim(flag, path, false, &outputs_);
}

void CommandFiles::reads_parts(const std::string& flag, const fs::path& folder,
                               const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    if (!folder.empty()) claim(flag, folder / part, true, &inputs_);
}

void CommandFiles::writes_parts(const std::string& flag, const fs::path& folder,
                                const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    if (!folder.empty()) claim(flag, folder / part, true, &outputs_);
}

void CommandFiles::writes_common(const CommonOptions& options) {
  writes("--json", options.json);
  writes("--log-file", options.log_file);
}

bool CommandFiles::overlap(const Claim& a, const Claim& b) {
  if (is_stream(a.path) || is_stream(b.path)) return false;
  if (a.place == b.place || same_inode(a.path, b.path)) return true;
  return (a.whole_folder && (lies_in(b.place, a.place) || is_linked_in(b.path, a.path))) ||
         (b.whole_folder && (lies_in(a.place, b.place) || is_linked_in(a.path, b.path)));
}

void CommandFiles::check() const {
  for (const Claim& output : outputs_) {
    for (const Claim& input : inputs_) {
      LTE_CHECK(!overlap(output, input), output.flag, " ", output.path.string(),
                ": would replace an input, ", input.path.string(), " of ", input.flag,
                "; name another file");
    }
  }
  for (size_t i = 0; i < outputs_.size(); ++i) {
    for (size_t k = 0; k < i; ++k) {
      const Claim &first = outputs_[k], &second = outputs_[i];
      LTE_CHECK(first.flag == second.flag || !overlap(first, second), second.flag, " ",
                second.path.string(), ": is also what ", first.flag, " writes, ",
                first.path.string(), "; name another file");
    }
  }
}

void CommandFiles::check_what_was_read() const {
  for (const Claim& output : outputs_) {
    LTE_CHECK(output.whole_folder || is_stream(output.path) || !watch_.saw(output.path),
              output.flag, " ", output.path.string(),
              ": would replace an input, which another input file names; name another file");
  }
}

}  // namespace lte
