#include "lte/cli/assets.h"

#include <cstdlib>
#include <string_view>
#include <system_error>
#include <vector>

#include "lte/base/check.h"

namespace lte {
namespace fs = std::filesystem;

namespace {

fs::path& own() {
  static fs::path folder;
  return folder;
}

std::vector<fs::path> asset_folders() {
  if (const char* chosen = std::getenv("LTE_ASSETS")) return {chosen};
  std::error_code ignored;
  const fs::path executable = fs::read_symlink("/proc/self/exe", ignored);
  const fs::path prefix = executable.parent_path().parent_path();
  std::vector<fs::path> folders;
  if (!own().empty()) folders.push_back(own());
  folders.insert(folders.end(),
                 {prefix / "share" / "lte" / "assets", prefix.parent_path() / "assets"});
  constexpr std::string_view kSourceAssets = LTE_SOURCE_ASSETS;  // empty in packages
  if (!kSourceAssets.empty()) folders.emplace_back(kSourceAssets);
  return folders;
}

/// The file, or nothing; then `looked` has the folders.
fs::path find_asset(const std::string& relative, std::string* looked) {
  for (const fs::path& folder : asset_folders()) {
    std::error_code ignored;
    if (fs::exists(folder / relative, ignored)) return folder / relative;
    *looked += (looked->empty() ? "" : ", ") + folder.string();
  }
  return {};
}

bool is_model_name(const std::string& text) {
  return (text == "lte" || text.starts_with("lte-")) &&
         text.find_first_of("./") == std::string::npos;
}

}  // namespace

fs::path asset_path(const std::string& relative, const std::string& instead) {
  std::string looked;
  fs::path found = find_asset(relative, &looked);
  LTE_CHECK(!found.empty(), "shipped file ", relative, " not found (looked in ", looked, "): pass ",
            instead, ", or set LTE_ASSETS to lte's assets folder");
  return found;
}

fs::path checkpoint_or_shipped(const std::string& checkpoint) {
  if (checkpoint.empty()) return asset_path(kDefaultModel, "--checkpoint");
  if (!is_model_name(checkpoint)) return checkpoint;
  std::string looked;
  fs::path found = find_asset(concat("models/", checkpoint, ".safetensors"), &looked);
  LTE_CHECK(!found.empty(), checkpoint, ": no model of that name in ", looked,
            "; assets/models of lte's sources and the Debian package lte-models have more: give "
            "the path of ",
            checkpoint, ".safetensors");
  return found;
}

std::map<std::string, fs::path> shipped_models() {
  std::map<std::string, fs::path> models;
  for (const fs::path& folder : asset_folders()) {
    std::error_code error;
    for (fs::directory_iterator at(folder / "models", error), end; !error && at != end;
         at.increment(error)) {
      if (at->path().extension() == ".safetensors")
        models.try_emplace(at->path().stem().string(), at->path());
    }
  }
  return models;
}

void set_own_assets(const fs::path& folder) { own() = folder; }

const fs::path& own_assets() { return own(); }

}  // namespace lte
