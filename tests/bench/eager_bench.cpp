// Times lte beside the plain PyTorch form of the same network, with the same weights and points in
// one run. The peer takes 0.3 ms a query on two cores.
//   lte_eager_bench [--queries 16384] [--json F]
#include <cstdio>
#include <string>
#include <vector>

#include <ATen/ATen.h>
#include <ATen/Parallel.h>
#include <ATen/core/grad_mode.h>
#include <CLI/CLI.hpp>

#include "bench/bench.h"
#include "infer/tool/tool_options.h"
#include "lte/base/file.h"
#include "lte/base/timer.h"
#include "lte/cli/cli.h"
#include "lte/nn/points/synthetic_room.h"
#include "lte/runtime/device.h"
#include "tests/bench/eager_network.h"

namespace lte::bench {
namespace {

struct Options {
  int64_t channels = 128, scene_points = 20'000, queries = 16'384;
  std::vector<int64_t> blocks = {1024, 8192};
  int repeats = 3;
  std::string precision = "fp32";  ///< of ours
};

/// Largest difference, over the largest value.
double difference(const at::Tensor& a, const at::Tensor& b) {
  return ((a - b).abs().max() / b.abs().max()).item<double>();
}

/// Runs `work` once, without a warm-up: the peer takes minutes.
BenchResult time_once(const std::string& name, int64_t n, const std::function<void()>& work) {
  const Timer timer;
  work();
  const double seconds = timer.seconds();
  return {name, n, seconds, seconds, {{"threads", at::get_num_threads()}}};
}

/// Adds ours and the peer's row, with the ratio of their times and the difference of their results.
void add_pair(std::vector<BenchResult>& rows, const char* name, int64_t n, int repeats,
              const std::string& precision, const std::function<at::Tensor()>& ours,
              const std::function<at::Tensor()>& eager) {
  at::Tensor a, b;
  rows.push_back(time_repeats(name, n, repeats, [&] { a = ours(); }));
  const double seconds = rows.back().seconds_min;
  rows.back().precision = precision;
  BenchResult peer = time_once(std::string(name) + ", eager", n, [&] { b = eager(); });
  peer.figures["times_slower"] = peer.seconds_min / seconds;
  peer.figures["max_relative_difference"] = difference(a, b);
  rows.push_back(peer);
}

std::vector<BenchResult> run(const Options& options) {
  const at::NoGradGuard no_grad;
  at::manual_seed(1);
  nn::ModelConfig config;
  config.channels = options.channels;
  nn::LightTransportModel model(config);
  model->eval();
  model->set_precision(infer::choose_precision(options.precision));
  const EagerNetwork eager(model);
  const nn::PointSet points = nn::synthetic_room(options.scene_points, 1);
  const nn::PointSet surface = nn::synthetic_room(options.queries, 2);
  const nn::QuerySet queries{surface.position, surface.normal, surface.albedo};
  const at::Tensor position =
      ((points.position - std::get<0>(points.position.min(0))) / config.scale).contiguous();
  const nn::EncoderPlan plan = nn::make_encoder_plan(position, config, false, 0);

  std::vector<BenchResult> rows;
  nn::Embedding embedding;
  add_pair(
      rows, "encode", options.scene_points, options.repeats, options.precision,
      [&] {
        embedding = model->encode(points);
        return embedding.features;
      },
      [&] { return eager.encode(points, plan); });
  const at::Tensor radiance = embedding.emission_scale.to(at::kFloat);
  for (const int64_t block : options.blocks) {
    add_pair(
        rows, ("decode, blocks of " + std::to_string(block)).c_str(), options.queries,
        options.repeats, options.precision, [&] { return model->decode(embedding, queries); },
        [&] { return eager.decode(embedding, queries, block).mul(radiance); });
  }
  return rows;
}

}  // namespace
}  // namespace lte::bench

int main(int argc, char** argv) {
  CLI::App app{"Times lte beside the plain PyTorch form of its network.", "lte_eager_bench"};
  lte::bench::Options options;
  lte::CommonOptions common;
  lte::add_common_options(app, &common);
  app.add_option("--channels", options.channels, "D")->check(CLI::PositiveNumber);
  app.add_option("--scene-points", options.scene_points, "M")->check(CLI::PositiveNumber);
  app.add_option("--queries", options.queries, "Query points")->check(CLI::PositiveNumber);
  app.add_option("--blocks", options.blocks, "Queries the peer takes at a time; several are tried")
      ->check(CLI::PositiveNumber);
  app.add_option("--repeats", options.repeats, "Timed runs of ours")->check(CLI::PositiveNumber);
  app.add_option("--precision", options.precision, "Of ours: fp32 or bf16; the peer's is fp32")
      ->check(CLI::IsMember({"fp32", "bf16"}));
  return lte::run_tool(app, argc, argv, [&] {
    lte::apply_common_options(common);
    lte::runtime::set_torch_threads(common.threads);
    const auto rows = lte::bench::run(options);
    std::fputs(lte::bench::bench_table(rows).c_str(), stdout);
    if (!common.json.empty()) lte::write_file(common.json, lte::bench::bench_json(rows));
  });
}
