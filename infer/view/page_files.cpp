#include "infer/view/page_files.h"

#include <cstdlib>
#include <system_error>
#include <vector>

#include "lte/base/check.h"
#include "lte/base/file.h"

namespace lte::infer::view {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxBytes = size_t{4} << 20;  // of a file

/// nullptr for what is no part of a page.
const char* media_type(const fs::path& file) {
  const std::string extension = file.extension().string();
  if (extension == ".html") return "text/html; charset=utf-8";
  if (extension == ".css") return "text/css; charset=utf-8";
  if (extension == ".js") return "text/javascript; charset=utf-8";
  if (extension == ".svg") return "image/svg+xml";
  return nullptr;
}

}  // namespace

PageFiles::PageFiles(const fs::path& folder) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, ignored)) {
    const char* type = media_type(entry.path());
    if (type == nullptr || !entry.is_regular_file()) continue;
    const std::string name = '/' + fs::relative(entry.path(), folder).generic_string();
    files_[name] = {type, read_file(entry.path(), kMaxBytes)};
  }
  LTE_CHECK(files_.count("/index.html") > 0, folder.string(),
            ": expected the page of lte_view, with index.html");
}

const PageFile* PageFiles::find(std::string_view path) const {
  const auto found = files_.find(path == "/" ? "/index.html" : path);
  return found == files_.end() ? nullptr : &found->second;
}

fs::path page_folder() {
  std::vector<fs::path> folders;
  if (const char* chosen = std::getenv("LTE_VIEW_PAGE")) {
    folders = {chosen};
  } else {
    std::error_code ignored;
    const fs::path executable = fs::read_symlink("/proc/self/exe", ignored);
    const fs::path prefix = executable.parent_path().parent_path();
    folders = {prefix / "share" / "lte" / "view", prefix.parent_path() / "infer" / "view" / "page"};
    constexpr std::string_view kSourcePage = LTE_SOURCE_PAGE;  // empty in packages
    if (!kSourcePage.empty()) folders.emplace_back(kSourcePage);
  }
  std::string looked;
  for (const fs::path& folder : folders) {
    std::error_code ignored;
    if (fs::exists(folder / "index.html", ignored)) return folder;
    looked += (looked.empty() ? "" : ", ") + folder.string();
  }
  throw Error(concat("the page of lte_view was not found (looked in ", looked,
                     "): set LTE_VIEW_PAGE to its folder"));
}

}  // namespace lte::infer::view
