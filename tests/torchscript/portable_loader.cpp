// Loads a portable TorchScript module in a program that links LibTorch and nothing of lte, and
// answers a query:
//   portable_loader MODEL.pt COLUMNS POINTS QUERIES RESULT [DIRECTIONS RADIANCE]
// Files of raw float32: [M, COLUMNS], [Q, 9] -> [Q, 3], and [Q, N, 3] -> [Q, N, 3].
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

void write_rows(const char* path, const at::Tensor& rows) {
  const at::Tensor flat = rows.contiguous();
  std::ofstream(path, std::ios::binary)
      .write(static_cast<const char*>(flat.const_data_ptr()),
             static_cast<std::streamsize>(flat.nbytes()));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6 && argc != 8) return 2;
  try {
    const at::NoGradGuard no_grad;
    torch::jit::ExtraFilesMap extra{{"config.yaml", ""}, {"normalization.json", ""}};
    torch::jit::Module module = torch::jit::load(argv[1], std::nullopt, extra);
    if (extra["config.yaml"].empty() || extra["normalization.json"].empty()) return 3;
    const at::Tensor points = read_rows(argv[3], std::stoll(argv[2])),
                     queries = read_rows(argv[4], 9);
    const c10::IValue embedding = module.get_method("encode")({points});
    write_rows(argv[5], module.get_method("decode")({embedding, queries}).toTensor());
    if (argc == 6) return 0;
    const at::Tensor directions = read_rows(argv[6], 3).view({queries.size(0), -1, 3});
    write_rows(argv[7], module.get_method("radiance")({embedding, queries, directions}).toTensor());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "portable_loader: %s\n", error.what());
    return 1;
  }
}
