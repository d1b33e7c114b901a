// Loads bytes as a scene file, as every fuzz target does.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <unistd.h>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/scene/inspect/inspect.h"
#include "lte/scene/load.h"

namespace lte::fuzz {

/// What stands in a file that no scene may read: no message may hold it.
inline constexpr std::string_view kSecret = "root:x:0:0:secret";

/// A folder of this process, in memory where the system has such a place. Beside it lies `secret`.
inline const std::filesystem::path& folder() {
  static const std::filesystem::path path = [] {
    const std::filesystem::path shared = "/dev/shm";
    std::error_code ignored;
    const auto root =
        std::filesystem::exists(shared, ignored) ? shared : std::filesystem::temp_directory_path();
    std::filesystem::path own = root / concat("lte-fuzz-", getpid()) / "scene";
    std::filesystem::create_directories(own);
    std::ofstream(own / ".." / "secret") << kSecret;
    set_num_threads(1);
    return own;
  }();
  return path;
}

/// Whether the scene that is written now holds the secret itself: the fuzzer learns it from the
/// comparison below, and a message may quote the scene's own files.
inline bool knows_secret = false;

inline void write(const std::string& name, std::string_view bytes) {
  knows_secret = knows_secret || bytes.find(kSecret) != bytes.npos;
  std::ofstream(folder() / name, std::ios::binary) << bytes;
}

/// Few of everything, so that an execution takes milliseconds.
inline scene::LoadLimits small_limits() {
  scene::LoadLimits limits;
  limits.triangles = 10'000;
  limits.texture_pixels = 1 << 16;
  limits.picture_bytes = 1 << 20;
  limits.inflated_bytes = 1 << 20;
  limits.includes = 8;
  limits.text_bytes = 1 << 18;
  return limits;
}

/// Nothing if the file is refused. An lte::Error that names the file is a good answer; anything
/// else is a finding.
inline std::optional<scene::Scene> load(const std::string& name, const scene::LoadLimits& limits) {
  const bool may_quote = std::exchange(knows_secret, false);
  try {
    return scene::load_scene(folder() / name, limits);
  } catch (const Error& error) {
    const std::string_view what = error.what();
    if (what.find(folder().string()) == what.npos || what.find('\n') != what.npos) std::abort();
    if (!may_quote && what.find(kSecret) != what.npos) std::abort();
    return std::nullopt;
  }
}

/// What the targets of the importers do with a file.
inline void load_and_inspect(const std::string& name) {
  if (const auto scene = load(name, small_limits())) scene::inspect(*scene);
}

}  // namespace lte::fuzz
