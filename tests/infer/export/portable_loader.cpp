// Loads a portable TorchScript module in a program that links LibTorch and nothing of lte, and
// answers a query:
//   portable_loader MODEL.pt POINTS QUERIES RESULT     raw float32 files: [M, 13], [Q, 9] -> [Q, 3]
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <ATen/ops/from_blob.h>
#include <torch/csrc/jit/api/module.h>
#include <torch/csrc/jit/serialization/import.h>

namespace {

at::Tensor read_rows(const char* path, int64_t columns) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in),
                                std::istreambuf_iterator<char>()};
  const auto rows = static_cast<int64_t>(bytes.size() / sizeof(float)) / columns;
  return at::from_blob(const_cast<char*>(bytes.data()), {rows, columns}, at::kFloat).clone();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  try {
    const at::NoGradGuard no_grad;
    torch::jit::ExtraFilesMap extra{{"config.yaml", ""}, {"normalization.json", ""}};
    torch::jit::Module module = torch::jit::load(argv[1], std::nullopt, extra);
    if (extra["config.yaml"].empty() || extra["normalization.json"].empty()) return 3;
    const at::Tensor points = read_rows(argv[2], 13), queries = read_rows(argv[3], 9);
    const c10::IValue embedding = module.get_method("encode")({points});
    const at::Tensor result =
        module.get_method("decode")({embedding, queries}).toTensor().contiguous();
    std::ofstream(argv[4], std::ios::binary)
        .write(static_cast<const char*>(result.const_data_ptr()),
               static_cast<std::streamsize>(result.nbytes()));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "portable_loader: %s\n", error.what());
    return 1;
  }
}
