// Feeds bytes to the PLY reader, gzip included.
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::filesystem::path folder = lte::fuzz::folder();
  lte::fuzz::load(folder / "input.ply", data, size);
  return 0;
}
