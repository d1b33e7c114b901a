// PLY, gzip included.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/load.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  lte::fuzz::write("scene.ply", {reinterpret_cast<const char*>(data), size});
  lte::fuzz::load_and_inspect("scene.ply");
  return 0;
}
