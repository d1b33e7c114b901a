// lte_fuzz_model OUT: the small network of random weights that lte_render_fuzz encodes with.
#include <cstdio>

#include "tests/nn/tiny_model.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("lte_fuzz_model: expected the name of the file to write\n", stderr);
    return 2;
  }
  lte::test::save_random_model(argv[1], lte::test::tiny_config());
  return 0;
}
