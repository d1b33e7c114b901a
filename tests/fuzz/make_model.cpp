// lte_fuzz_model OUT: the small network of random weights that lte_render_fuzz encodes with.
#include <cstdio>

#include "lte/nn/model_file.h"
#include "tests/nn/support.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("lte_fuzz_model: expected the name of the file to write\n", stderr);
    return 2;
  }
  lte::nn::LightTransportModel model(lte::test::tiny_config());
  lte::test::randomize(*model, 5);
  model->eval();
  lte::nn::save_model(argv[1], model);
  return 0;
}
