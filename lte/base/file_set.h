// Files that belong together: they appear all or none.
#pragma once

#include <filesystem>
#include <functional>
#include <list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lte/base/file.h"

namespace lte {

/// Every file goes to a temporary name in the folder; commit() renames them all. Without it, on an
/// error or on Ctrl-C (install_signal_cleanup()) what stood in the folder stays as it was, and a
/// folder that was made for it goes.
class FileSet {
 public:
  /// Makes the folder and its parents where they do not exist.
  /// @throws lte::Error naming the folder.
  explicit FileSet(const std::filesystem::path& folder);
  ~FileSet();
  FileSet(const FileSet&) = delete;
  FileSet& operator=(const FileSet&) = delete;

  void write(const std::string& name, std::string_view text);
  using Writer = std::function<void(const std::filesystem::path&)>;
  /// The same by a function that writes a file of the name it is given. Its errors that name the
  /// temporary name the file instead.
  void write(const std::string& name, const Writer& writer);
  /// The same of several, side by side.
  void write_all(const std::vector<std::pair<std::string, Writer>>& writers);
  void commit();

  const std::filesystem::path& folder() const { return folder_; }

 private:
  void write_into(const std::filesystem::path& temporary, const std::string& name,
                  const Writer& writer) const;

  std::filesystem::path folder_;
  bool made_ = false;
  std::list<AtomicFile> files_;
};

}  // namespace lte
