// Rate of the checksum that model and sample files carry. ctest does not run it.
//   lte_checksum_microbench
#include <filesystem>
#include <vector>

#include <benchmark/benchmark.h>

#include "lte/base/checksum.h"
#include "lte/base/safetensors.h"

namespace {

void Hash(benchmark::State& state) {
  const std::vector<char> bytes(static_cast<size_t>(state.range(0)), 'x');
  for (auto _ : state) {
    lte::Checksum checksum;
    checksum.add(bytes.data(), bytes.size());
    benchmark::DoNotOptimize(checksum.value());
  }
  state.SetBytesProcessed(state.iterations() * state.range(0));
}
BENCHMARK(Hash)->Arg(1 << 20)->Arg(1 << 28)->Unit(benchmark::kMillisecond);

/// Opening a file that is in memory, with and without its verification.
void Open(benchmark::State& state, bool verify) {
  const std::vector<float> values(size_t{10} << 20);
  const auto path = std::filesystem::temp_directory_path() / "lte_checksum_bench.safetensors";
  lte::SafetensorsWriter writer;
  writer.add("values", {static_cast<int64_t>(values.size())}, values.data());
  writer.write(path);
  for (auto _ : state) {
    const lte::SafetensorsFile file(path);
    if (verify) file.verify();
  }
  state.SetBytesProcessed(state.iterations() * static_cast<int64_t>(values.size() * sizeof(float)));
  std::filesystem::remove(path);
}
BENCHMARK_CAPTURE(Open, verified, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Open, header_alone, false)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
