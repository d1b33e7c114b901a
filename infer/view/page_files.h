// The page's own files, which are all that the server ever sends by name.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace lte::infer::view {

struct PageFile {
  std::string media_type;
  std::string bytes;
};

/// The files of a folder, read once: a request can only name what is in this table, so that no path
/// of a request ever reaches the file system.
class PageFiles {
 public:
  /// Reads .html, .css, .js and .svg files of the folder and of the folders in it.
  /// @throws lte::Error if there is no index.html
  explicit PageFiles(const std::filesystem::path& folder);

  /// The file for a path such as "/main.js", "/" for the index; nullptr if there is none.
  const PageFile* find(std::string_view path) const;

 private:
  std::map<std::string, PageFile, std::less<>> files_;
};

/// Where the page lies: $LTE_VIEW_PAGE, else the first that exists of
/// <executable>/../share/lte/view (installed), <executable>/../../infer/view/page (build/bin of the
/// source tree) and the source tree that was compiled.
/// @throws lte::Error that lists where it looked.
std::filesystem::path page_folder();

}  // namespace lte::infer::view
