// lte_bench ops, encoder and decoder: what needs neither a scene nor Embree.
#include <ATen/ATen.h>
#include <ATen/core/grad_mode.h>

#include "bench/bench.h"
#include "infer/tool/memory.h"
#include "infer/tool/tool_options.h"
#include "lte/base/process_memory.h"
#include "lte/nn/cost.h"
#include "lte/nn/device.h"
#include "lte/nn/encoder/encoder_plan.h"
#include "lte/nn/model.h"
#include "lte/nn/points/synthetic_room.h"
#include "lte/ops/curve_codes.h"
#include "lte/ops/farthest_point.h"
#include "lte/ops/knn.h"
#include "lte/ops/neighbour_sums.h"
#include "lte/ops/submanifold_conv.h"
#include "lte/runtime/torch_parts.h"

namespace lte::bench {

using namespace infer;

namespace {

at::Tensor cells_of(const at::Tensor& position, double spacing) {
  const at::Tensor low = std::get<0>(position.min(0));
  return ((position - low) / spacing).floor().to(at::kInt).contiguous();
}

c10::Device device_of(const BenchOptions& options) {
  return options.device == "cpu" ? c10::Device(c10::kCPU)
                                 : nn::choose_device(options.device, 0, "--device");
}

nn::LightTransportModel untrained_model(c10::Device device, int64_t channels,
                                        nn::Precision precision, nn::ModelConfig config = {}) {
  config.channels = channels;
  nn::LightTransportModel model(config);
  model->to(device);
  model->eval();
  model->set_precision(precision);
  return model;
}

/// A network of random weights where and how a command wants it.
struct Setup {
  c10::Device device;
  nn::Precision precision;
  nn::LightTransportModel model;

  explicit Setup(const BenchOptions& options)
      : device(device_of(options)),
        precision(choose_precision(options.precision, runtime::device_of(device))),
        model(untrained_model(device, options.channels, precision)) {}
};

}  // namespace

std::vector<BenchResult> bench_ops(const BenchOptions& options) {
  const at::NoGradGuard no_grad;
  const c10::Device device = device_of(options);
  std::vector<BenchResult> results;
  const double gemm_gflops = measure_gemm_gflops(device);
  const auto run = [&](const std::string& name, int64_t n, const std::function<void()>& work) {
    results.push_back(time_repeats(name, n, options.repeats, device, work));
    results.back().figures["gemm_gflops_measured"] = gemm_gflops;
  };
  const int64_t M = options.scene_points, m = std::max<int64_t>(1, M / 4), Q = options.queries,
                D = options.channels;
  const at::Tensor points = nn::synthetic_room(M, 1).to(device).position;
  const at::Tensor latents = points.slice(0, 0, m).contiguous();
  const at::Tensor queries = nn::synthetic_room(Q, 2).to(device).position;
  const at::Tensor cells = cells_of(latents, 0.15);

  run("farthest_point_sampling M -> M/2", M, [&] { ops::farthest_point_sampling(points, M / 2); });
  run("knn M in M, k = 32", M, [&] { ops::knn(points, points, 32); });
  run("knn queries in M/4, k = 32", Q, [&] { ops::knn(queries, latents, 32); });
  run("curve_codes hilbert", m, [&] { ops::curve_codes(cells, ops::Curve::Hilbert); });
  run("convolution_pairs 3x3x3", m, [&] { ops::convolution_pairs(cells, 3); });

  const auto [pairs, begin] = ops::convolution_pairs(cells, 3);
  const at::Tensor input = at::rand({m, D}, device), weight = at::rand({27, D, D}, device);
  run("submanifold_conv 3x3x3 D -> D", m,
      [&] { ops::submanifold_conv(input, weight, {}, pairs, begin); });
  add_limit(results.back(), 2 * static_cast<double>(pairs.size(1) * D * D), gemm_gflops);

  const int64_t layers = 6, hidden_width = 64, block = std::min<int64_t>(Q, 8192);
  const at::Tensor index =
      std::get<0>(ops::knn(queries.slice(0, 0, block).contiguous(), latents, 32));
  const at::Tensor table =
      ops::neighbour_table(at::rand({layers, m, D}, device), at::rand({layers, m, D}, device));
  const at::Tensor hidden = at::rand({block, index.size(1), hidden_width}, device);
  const at::Tensor gamma = at::rand({D, hidden_width}, device), bias = at::rand({D}, device);
  run("neighbour_sums_inference 6 layers", block,
      [&] { ops::neighbour_sums_inference(table, hidden, gamma, bias, index); });
  add_limit(results.back(),
            2 * static_cast<double>(index.numel() * D * (hidden_width + 2 * layers)), gemm_gflops);
  return results;
}

namespace {

/// What encoder and decoder report of a network besides times.
void add_network_figures(BenchResult& result, const BenchOptions& options, c10::Device device,
                         double above_mb, double flops, nn::Precision precision) {
  result.precision = options.precision;
  result.figures["channels"] = static_cast<double>(options.channels);
  if (device.is_cpu()) result.figures["rss_above_model_mb"] = above_mb;
  add_limit(result, flops, measure_gemm_gflops(device, precision));
}

BenchResult time_encoder(const BenchOptions& options, c10::Device device,
                         nn::LightTransportModel& model, nn::Precision precision) {
  const nn::PointSet points = nn::synthetic_room(options.scene_points, 1).to(device);
  reset_peak_rss();
  const double before_mb = current_rss_mb();
  BenchResult result = time_repeats("encode", options.scene_points, options.repeats, device,
                                    [&] { model->encode(points); });
  const double above_mb = peak_rss_mb() - before_mb;
  const at::Tensor position =
      (points.position - std::get<0>(points.position.min(0))).div(model->config().scale);
  const nn::EncoderPlan plan =
      nn::make_encoder_plan(position.contiguous(), model->config(), false, 0);
  add_network_figures(result, options, device, above_mb,
                      nn::encode_flops(model->config(), plan, options.scene_points), precision);
  return result;
}

BenchResult time_decoder(const BenchOptions& options, c10::Device device,
                         nn::LightTransportModel& model, nn::Precision precision) {
  const nn::Embedding embedding =
      model->encode(nn::synthetic_room(options.scene_points, 1).to(device));
  const nn::PointSet surface = nn::synthetic_room(options.queries, 2).to(device);
  const nn::QuerySet queries{surface.position, surface.normal, surface.albedo};
  const int64_t block =
      MemoryLimit(options.max_memory_mb).query_block(model->config(), options.queries, kQueryBlock);
  reset_peak_rss();
  const double before_mb = current_rss_mb();
  BenchResult result = time_repeats("decode", options.queries, options.repeats, device, [&] {
    model->decode(embedding, queries, {true, block});
  });
  const double above_mb = peak_rss_mb() - before_mb;
  const double flops = static_cast<double>(options.queries) *
                       nn::decode_flops(model->config(), embedding.position.size(0));
  add_network_figures(result, options, device, above_mb, flops, precision);
  return result;
}

/// A network with a radiance decoder that casts rays, asked for one direction a query.
BenchResult time_radiance(const BenchOptions& options, c10::Device device,
                          nn::Precision precision) {
  nn::ModelConfig config;
  config.light_input = nn::LightInput::Radiosity;
  config.radiance_lobes = 48;
  nn::LightTransportModel model = untrained_model(device, options.channels, precision, config);
  const nn::Embedding embedding =
      model->encode(nn::synthetic_room(options.scene_points, 1).to(device));
  const nn::PointSet surface = nn::synthetic_room(options.queries, 2).to(device);
  const nn::QuerySet queries{surface.position, surface.normal, surface.albedo};
  const at::Tensor directions = surface.normal.unsqueeze(1).contiguous();
  const int64_t block =
      MemoryLimit(options.max_memory_mb).query_block(model->config(), options.queries, kQueryBlock);
  BenchResult result =
      time_repeats("decode radiance", options.queries, options.repeats, device, [&] {
        model->decode_radiance(embedding, queries, directions, {false, block});
      });
  result.precision = options.precision;
  result.figures["channels"] = static_cast<double>(options.channels);
  return result;
}

}  // namespace

std::vector<BenchResult> bench_encoder(const BenchOptions& options) {
  const at::NoGradGuard no_grad;
  Setup setup(options);
  const int64_t M = options.scene_points;
  MemoryLimit(options.max_memory_mb).check_encoding(setup.model->config(), M);
  return {runtime::explain_out_of_memory(
      {concat("encoding ", M, " scene points"), encode_mb(setup.model->config(), M),
       "take fewer (--scene-points), or fewer --channels"},
      [&] { return time_encoder(options, setup.device, setup.model, setup.precision); })};
}

std::vector<BenchResult> bench_decoder(const BenchOptions& options) {
  const at::NoGradGuard no_grad;
  Setup setup(options);
  const int64_t Q = options.queries;
  std::vector<BenchResult> results;
  runtime::explain_out_of_memory(
      {concat("decoding ", Q, " queries"), decode_mb(setup.model->config(), Q, kQueryBlock),
       "ask for fewer (--queries), or decode fewer at a time (--max-memory)"},
      [&] {
        results.push_back(time_decoder(options, setup.device, setup.model, setup.precision));
        results.push_back(time_radiance(options, setup.device, setup.precision));
      });
  return results;
}

}  // namespace lte::bench
