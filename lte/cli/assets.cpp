#include "lte/cli/assets.h"

#include <cstdlib>
#include <string_view>
#include <system_error>
#include <vector>

#include "lte/base/check.h"

namespace lte {
namespace fs = std::filesystem;

fs::path asset_path(const std::string& relative, const std::string& instead) {
  std::vector<fs::path> folders;
  if (const char* chosen = std::getenv("LTE_ASSETS")) {
    folders = {chosen};
  } else {
    std::error_code ignored;
    const fs::path executable = fs::read_symlink("/proc/self/exe", ignored);
    const fs::path prefix = executable.parent_path().parent_path();
    folders = {prefix / "share" / "lte" / "assets", prefix.parent_path() / "assets"};
    constexpr std::string_view kSourceAssets = LTE_SOURCE_ASSETS;  // empty in packages
    if (!kSourceAssets.empty()) folders.emplace_back(kSourceAssets);
  }
  std::string looked;
  for (const fs::path& folder : folders) {
    std::error_code ignored;
    if (fs::exists(folder / relative, ignored)) return folder / relative;
    looked += (looked.empty() ? "" : ", ") + folder.string();
  }
  throw Error(concat("shipped file ", relative, " not found (looked in ", looked, "): pass ",
                     instead, ", or set LTE_ASSETS to lte's assets folder"));
}

fs::path checkpoint_or_shipped(const std::string& checkpoint) {
  return checkpoint.empty() ? asset_path(kDefaultModel, "--checkpoint") : fs::path(checkpoint);
}

}  // namespace lte
