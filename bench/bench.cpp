#include "bench/bench.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <ATen/ATen.h>
#include <ATen/Parallel.h>
#include <c10/core/impl/VirtualGuardImpl.h>
#include <nlohmann/json.hpp>

#include "lte/base/process_memory.h"
#include "lte/base/timer.h"
#include "lte/ops/linear.h"

namespace lte::bench {
namespace {

BenchResult result_of(const std::string& name, int64_t n, std::vector<double> seconds) {
  std::sort(seconds.begin(), seconds.end());
  BenchResult result{name, n, seconds.front(), seconds[seconds.size() / 2], {}};
  result.figures["peak_rss_mb"] = peak_rss_mb();
  result.figures["peak_rss"] = peak_rss_mb() * 1024 * 1024;
  result.figures["flops"] = 0;
  result.figures["threads"] = at::get_num_threads();
  return result;
}

}  // namespace

void add_limit(BenchResult& result, double flops, double gemm_gflops) {
  result.figures["flops"] = flops;
  result.figures["gemm_gflops_measured"] = gemm_gflops;
  result.figures["times_gemm_limit"] = result.seconds_min * 1e9 * gemm_gflops / flops;
}

BenchResult time_repeats(const std::string& name, int64_t n, int repeats,
                         const std::function<void()>& work) {
  work();
  std::vector<double> seconds;
  for (int i = 0; i < std::max(1, repeats); ++i) {
    const Timer timer;
    work();
    seconds.push_back(timer.seconds());
  }
  return result_of(name, n, std::move(seconds));
}

BenchResult time_repeats(const std::string& name, int64_t n, int repeats, c10::Device device,
                         const std::function<void()>& work) {
  if (device.is_cpu()) return time_repeats(name, n, repeats, work);
  const c10::impl::VirtualGuardImpl of_device(device.type());
  return time_repeats(name, n, repeats, [&] {
    work();
    of_device.synchronizeDevice(device.index());
  });
}

double measure_gemm_gflops(c10::Device device, nn::Precision precision) {
  // The decoder's largest product at the size of its blocks; on a GPU of more rows, next to which
  // its launch is nothing.
  const int64_t rows = device.is_cpu() ? 4096 : 262144, inner = 128, columns = 512;
  const at::Tensor a = at::rand({rows, inner}, device), b = at::rand({columns, inner}, device);
  const auto seconds = [&](const std::function<void()>& product) {
    return time_repeats("gemm", rows, 31, device, product).seconds_min;
  };
  double least = 0;
  if (precision == nn::Precision::Fp32) {
    least = seconds([&] { ops::linear(a, b); });
  } else {
    const at::Tensor rounded_a = a.to(at::kBFloat16), rounded_b = b.to(at::kBFloat16);
    least = std::min(seconds([&] { at::linear(rounded_a, rounded_b); }),
                     seconds([&] { ops::linear(a, rounded_b); }));
  }
  return 2e-9 * static_cast<double>(rows * inner * columns) / least;
}

std::string bench_json(const std::vector<BenchResult>& results) {
  nlohmann::json rows = nlohmann::json::array();
  for (const BenchResult& result : results) {
    nlohmann::json row{{"name", result.name},
                       {"n", result.n},
                       {"seconds_min", result.seconds_min},
                       {"seconds_median", result.seconds_median}};
    if (!result.precision.empty()) row["precision"] = result.precision;
    for (const auto& [key, value] : result.figures) row[key] = value;
    rows.push_back(row);
  }
  return rows.dump(1) + "\n";
}

std::string bench_table(const std::vector<BenchResult>& results) {
  const auto text = [](const char* pattern, auto... values) {
    char buffer[160];
    std::snprintf(buffer, sizeof buffer, pattern, values...);
    return std::string(buffer);
  };
  std::string out = text("%-34s %10s %12s %12s\n", "name", "n", "min s", "median s");
  for (const BenchResult& result : results) {
    out += text("%-34s %10lld %12.5f %12.5f", result.name.c_str(), static_cast<long long>(result.n),
                result.seconds_min, result.seconds_median);
    for (const auto& [key, value] : result.figures) {
      if (key != "threads" && key != "peak_rss") out += text("  %s %.4g", key.c_str(), value);
    }
    out += '\n';
  }
  return out;
}

}  // namespace lte::bench
