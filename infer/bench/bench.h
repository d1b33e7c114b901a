// lte_bench: run time of every stage, and run time against error. Each figure is one row of JSON.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lte/nn/precision.h"

namespace lte::infer {

/// One measurement: warm-up, then `repeats` timed runs.
struct BenchResult {
  std::string name;
  int64_t n = 0;  ///< size of the problem: points, queries or rays
  double seconds_min = 0, seconds_median = 0;
  std::map<std::string, double> figures;  ///< what else was measured, e.g. gflops, peak_rss
  std::string precision{};                ///< fp32 or bf16; empty where nothing depends on it
};

struct BenchOptions {
  int repeats = 5;
  int64_t channels = 128;         ///< D of the benchmarked network
  int64_t scene_points = 20'000;  ///< M
  int64_t queries = 512 * 512;
  std::string precision = "fp32";  ///< encoder and decoder: or bf16
  double max_memory_mb = 0;        ///< encoder and decoder: above the model; 0 for no limit
  std::string scene;               ///< glTF file of the pathtrace and pareto benchmarks
  std::string checkpoint;          ///< pareto: the model whose error is measured
  int width = 160, height = 120;   ///< pareto: view
  int reference_rays = 4096;       ///< pareto: rays a pixel of the reference
};

/// Runs `work` once to warm up, then `repeats` times.
BenchResult time_repeats(const std::string& name, int64_t n, int repeats,
                         const std::function<void()>& work);

/// Runs `work` once, cold: for peers that take minutes.
BenchResult time_once(const std::string& name, int64_t n, const std::function<void()>& work);

/// Adds `flops`, and how many times as long it took as a product of as many at the rate
/// `gemm_gflops`.
void add_limit(BenchResult& result, double flops, double gemm_gflops);

/// Sustained GEMM rate of this machine in this process, GFLOP/s: the limit the network is held to.
/// Of bf16 operands the better one of LibTorch's product and lte's.
double measure_gemm_gflops(nn::Precision precision = nn::Precision::Fp32);

std::vector<BenchResult> bench_ops(const BenchOptions& options);
std::vector<BenchResult> bench_encoder(const BenchOptions& options);
std::vector<BenchResult> bench_decoder(const BenchOptions& options);
/// Path tracing against bare Embree calls on the same rays.
std::vector<BenchResult> bench_pathtrace(const BenchOptions& options);
/// Error (relative MSE of indirect irradiance over a view) against run time: path tracing at 1 to
/// 1,024 rays a pixel, the network at several numbers of scene points.
std::vector<BenchResult> bench_pareto(const BenchOptions& options);

std::string bench_json(const std::vector<BenchResult>& results);
void print_bench_table(const std::vector<BenchResult>& results);

}  // namespace lte::infer
