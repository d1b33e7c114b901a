// The benchmarks of single stages: run time, a row of JSON each. bench/pareto has run time against
// error.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lte/cli/scene_flags.h"
#include "lte/nn/blocks/precision.h"

namespace c10 {
struct Device;
}

namespace lte::bench {

/// One measurement: warm-up, then `repeats` timed runs.
struct BenchResult {
  std::string name;
  int64_t n = 0;  ///< size of the problem: points, queries or rays
  double seconds_min = 0, seconds_median = 0;
  std::map<std::string, double> figures;  ///< what else was measured, e.g. gflops, peak_rss
  std::string precision{};                ///< fp32 or bf16; empty where it makes no difference
};

struct BenchOptions {
  int repeats = 5;
  int64_t channels = 128;         ///< D of the benchmarked network
  int64_t scene_points = 20'000;  ///< M
  int64_t queries = 512 * 512;
  std::string precision = "fp32";  ///< encoder and decoder: or bf16
  std::string device = "cpu";      ///< ops, encoder and decoder: or cuda
  double max_memory_mb = 0;        ///< encoder and decoder: memory above the model; 0: no limit
  std::string scene;               ///< pathtrace: scene file; empty: the shipped Cornell box
  SceneFlags loading;
};

/// Runs `work` once to warm up, then `repeats` times.
BenchResult time_repeats(const std::string& name, int64_t n, int repeats,
                         const std::function<void()>& work);

/// The same of work on `device`, which each run waits for.
BenchResult time_repeats(const std::string& name, int64_t n, int repeats, c10::Device device,
                         const std::function<void()>& work);

/// Adds `flops`, and how many times as long the work took as a matrix product of as many operations
/// at the rate `gemm_gflops`.
void add_limit(BenchResult& result, double flops, double gemm_gflops);

/// Measures the sustained rate of matrix products on a device, GFLOP/s, which the network is
/// compared with. For bf16 it is the higher one of LibTorch's product and lte's.
double measure_gemm_gflops(c10::Device device, nn::Precision precision = nn::Precision::Fp32);

/// Times every operator alone.
std::vector<BenchResult> bench_ops(const BenchOptions& options);
/// Times an untrained network from scene points to embedding.
std::vector<BenchResult> bench_encoder(const BenchOptions& options);
/// Times an untrained network from query points to irradiance, and to radiance towards the viewer.
std::vector<BenchResult> bench_decoder(const BenchOptions& options);
/// Times path tracing: rays a second of irradiance at points of a scene.
std::vector<BenchResult> bench_pathtrace(const BenchOptions& options);

/// One row for each result.
std::string bench_json(const std::vector<BenchResult>& results);
/// The same as a table for a terminal.
std::string bench_table(const std::vector<BenchResult>& results);

}  // namespace lte::bench
