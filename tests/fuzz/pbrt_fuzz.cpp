// Feeds PBRT text to the importer. Beside it lie a file to include, a mesh and a picture.
#include "lte/base/parallel.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::filesystem::path folder = [] {
    const std::filesystem::path path = lte::fuzz::folder();
    lte::set_num_threads(1);
    const std::string part = "Translate 1 0 0\n";
    const std::string mesh =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 1 0 0 0 1 0 3 0 1 2\n";
    const std::string picture("PF\n1 1\n-1\n\0\0\0?\0\0\0?\0\0\0?", 22);
    lte::fuzz::write(path / "a.pbrt", part.data(), part.size());
    lte::fuzz::write(path / "a.ply", mesh.data(), mesh.size());
    lte::fuzz::write(path / "a.pfm", picture.data(), picture.size());
    return path;
  }();
  lte::fuzz::load(folder / "input.pbrt", data, size);
  return 0;
}
