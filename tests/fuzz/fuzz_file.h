// What the fuzz targets share: an input as a file, for importers that read files.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <unistd.h>

#include "lte/base/check.h"
#include "lte/scene/load.h"

namespace lte::fuzz {

/// A folder in memory where there is one; it stays behind, as a fuzzer ends by a signal.
inline std::filesystem::path folder() {
  const std::filesystem::path base =
      std::filesystem::exists("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path();
  std::filesystem::path out = base / ("lte-fuzz-" + std::to_string(getpid()));
  std::filesystem::create_directories(out);
  return out;
}

inline void write(const std::filesystem::path& path, const void* data, size_t size) {
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  if (file == nullptr || std::fwrite(data, 1, size, file) != size) std::abort();
  std::fclose(file);
}

/// Small enough that every input ends soon.
inline scene::LoadLimits small_limits() {
  scene::LoadLimits limits;
  limits.triangles = 20'000;
  limits.texture_pixels = 1 << 14;
  limits.includes = 8;
  limits.text_bytes = 1 << 18;
  return limits;
}

/// Loads the input; an lte::Error of one line is the answer to bad input, anything else a finding.
inline void load(const std::filesystem::path& path, const uint8_t* data, size_t size) {
  write(path, data, size);
  try {
    const scene::Scene scene = scene::load_scene(path, small_limits());
    if (scene.triangle_count() <= 0 || scene.materials.empty()) std::abort();
    for (size_t i = 0; i < scene.instances.size(); ++i)
      scene::evaluate_surface(scene, static_cast<int>(i), 0, 0.3f, 0.3f, 0);
  } catch (const Error& error) {
    if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
  }
}

}  // namespace lte::fuzz
