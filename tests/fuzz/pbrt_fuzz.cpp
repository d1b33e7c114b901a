// PBRT text. Beside it lie a file to include, a mesh and a picture.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/load.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const bool written = [] {
    lte::fuzz::write("a.pbrt", "Translate 1 0 0\n");
    lte::fuzz::write(
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 1 0 0 0 1 0 3 0 1 2\n");
    lte::fuzz::write("a.pfm", {"PF\n1 1\n-1\n\0\0\0?\0\0\0?\0\0\0?", 22});
    return true;
  }();
  static_cast<void>(written);
  lte::fuzz::write("scene.pbrt", {reinterpret_cast<const char*>(data), size});
  lte::fuzz::load_and_inspect("scene.pbrt");
  return 0;
}
