// OBJ, and after the first byte of value 255 the MTL file m.mtl beside it.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/load.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const size_t cut = std::min(bytes.find('\xff'), size);
  lte::fuzz::write("scene.obj", bytes.substr(0, cut));
  lte::fuzz::write("m.mtl", bytes.substr(std::min(cut + 1, size)));
  lte::fuzz::load_and_inspect("scene.obj");
  return 0;
}
