// Times of the operators at the sizes of the network in docs/model.md, with FLANN and nanoflann
// beside knn. ctest does not run it.
//   lte_ops_microbench --benchmark_filter=Knn        at::set_num_threads: OMP_NUM_THREADS
#include <cmath>

#include <ATen/ATen.h>
#include <ATen/core/grad_mode.h>
#include <benchmark/benchmark.h>
#if defined(LTE_HAS_FLANN)
#include <flann/flann.hpp>
#endif

#if defined(LTE_HAS_NANOFLANN)
#include "tests/bench/nanoflann_knn.h"
#endif
#include "lte/ops/curve_codes.h"
#include "lte/ops/farthest_point.h"
#include "lte/ops/gelu.h"
#include "lte/ops/knn.h"
#include "lte/ops/linear.h"
#include "lte/ops/lobe_radiance.h"
#include "lte/ops/neighbour_sums.h"
#include "lte/ops/patch_attention.h"
#include "lte/ops/query_decoder.h"
#include "lte/ops/spatial_order.h"
#include "lte/ops/submanifold_conv.h"
#include "lte/ops/surfel_rays.h"

namespace {

using namespace lte::ops;  // NOLINT: a file of its own

/// N points on the walls, floor and ceiling of a room of 10 x 3 x 8 m.
at::Tensor room(int64_t N) {
  at::manual_seed(1);
  at::Tensor p = at::rand({N, 3});
  const at::Tensor axis = at::randint(3, {N, 1});
  p.scatter_(1, axis, p.gather(1, axis).round());
  return (p * at::tensor({10.f, 3.f, 8.f})).contiguous();
}

/// Q points seen by a pinhole camera, row by row.
at::Tensor camera_hits(int64_t edge) {
  const at::Tensor line = (at::arange(edge) + 0.5f) / edge * 2 - 1;
  const auto grid = at::meshgrid({line, line}, "ij");
  const at::Tensor direction =
      at::stack({grid[1], -grid[0], at::ones_like(grid[0])}, 2).view({-1, 3});
  const at::Tensor origin = at::tensor({5.f, 1.5f, 0.5f}), extent = at::tensor({10.f, 3.f, 8.f});
  const at::Tensor wall = at::where(direction.gt(0), extent, at::zeros({3}));
  const at::Tensor t = std::get<0>(((wall - origin) / direction).min(1, true));
  return (origin + direction * t).contiguous();
}

void Knn(benchmark::State& state, const at::Tensor& queries, int64_t N) {
  const at::Tensor points = room(N);
  for (auto _ : state) benchmark::DoNotOptimize(knn(queries, points, 32));
}
BENCHMARK_CAPTURE(Knn, camera_262144_in_5000, camera_hits(512), 5000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(Knn, shuffled_262144_in_5000, room(262144), 5000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(Knn, scene_20000_in_20000, room(20000), 20000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

#if defined(LTE_HAS_FLANN)
void Flann(benchmark::State& state, const at::Tensor& queries, int64_t N) {
  const at::Tensor points = room(N);
  const auto Q = static_cast<size_t>(queries.size(0));
  at::Tensor index = at::empty({queries.size(0), 32}, at::kInt),
             distance = at::empty({queries.size(0), 32});
  flann::Matrix<float> data(points.data_ptr<float>(), static_cast<size_t>(N), 3);
  flann::Matrix<float> asked(queries.data_ptr<float>(), Q, 3),
      to(distance.data_ptr<float>(), Q, 32);
  flann::Matrix<int> ids(index.data_ptr<int>(), Q, 32);
  flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED);
  parameters.cores = 0;  // all
  for (auto _ : state) {
    flann::KDTreeSingleIndex<flann::L2_Simple<float>> tree(data);
    tree.buildIndex();
    tree.knnSearch(asked, ids, to, 32, parameters);
  }
}
BENCHMARK_CAPTURE(Flann, camera_262144_in_5000, camera_hits(512), 5000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(Flann, scene_20000_in_20000, room(20000), 20000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
#endif

#if defined(LTE_HAS_NANOFLANN)
void Nanoflann(benchmark::State& state, const at::Tensor& queries, int64_t N) {
  const at::Tensor points = room(N);
  const auto leaf_size = static_cast<size_t>(state.range(0));
  for (auto _ : state) lte::bench::nanoflann_knn(queries, points, 32, leaf_size);
}
BENCHMARK_CAPTURE(Nanoflann, camera_262144_in_5000, camera_hits(512), 5000)
    ->Arg(8)
    ->Arg(16)
    ->Arg(32)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(Nanoflann, shuffled_262144_in_5000, room(262144), 5000)
    ->Arg(8)
    ->Arg(16)
    ->Arg(32)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
#endif

void FarthestPoint(benchmark::State& state) {
  const at::Tensor points = room(state.range(0));
  for (auto _ : state)
    benchmark::DoNotOptimize(farthest_point_sampling(points, state.range(0) / 2));
}
BENCHMARK(FarthestPoint)->Arg(20000)->Arg(200000)->Unit(benchmark::kMillisecond)->UseRealTime();

void CurveCodes(benchmark::State& state) {
  const at::Tensor cells = at::randint(1 << 16, {262144, 3}, at::kInt);
  const auto curve = static_cast<Curve>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(curve_codes(cells, curve));
}
BENCHMARK(CurveCodes)->Arg(0)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

/// Cells of 5,000 points at 0.8 of their spacing, as the encoder makes them.
at::Tensor scene_cells() {
  const at::Tensor points = room(20000);
  const auto [index, distance] = farthest_point_sampling(points, 5000);
  const float grid = 0.8f * distance[4999].sqrt().item<float>();
  return (points.index_select(0, index) / grid).to(at::kInt).contiguous();
}

void ConvolutionPairs(benchmark::State& state) {
  const at::Tensor cells = scene_cells();
  for (auto _ : state) benchmark::DoNotOptimize(convolution_pairs(cells, state.range(0)));
}
BENCHMARK(ConvolutionPairs)->Arg(3)->Arg(5)->Unit(benchmark::kMillisecond)->UseRealTime();

void SubmanifoldConv(benchmark::State& state, bool backward) {
  const int64_t kernel = state.range(0), C = 128;
  const auto [pairs, begin] = convolution_pairs(scene_cells(), kernel);
  at::Tensor input = at::randn({5000, C}), weight = at::randn({kernel * kernel * kernel, C, C});
  input.requires_grad_(backward);
  weight.requires_grad_(backward);
  for (auto _ : state) {
    const at::Tensor out = submanifold_conv(input, weight, at::Tensor(), pairs, begin);
    if (backward) out.backward(out.detach());
  }
  state.counters["taps"] = static_cast<double>(pairs.size(1)) / 5000;
  const double flops = 2.0 * static_cast<double>(pairs.size(1) * C * C) * (backward ? 3 : 1);
  state.counters["flop"] = benchmark::Counter(flops, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK_CAPTURE(SubmanifoldConv, forward, false)
    ->Arg(3)
    ->Arg(5)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(SubmanifoldConv, with_backward, true)
    ->Arg(3)
    ->Arg(5)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// A layer of the decoder on one block of queries, C -> 4C with its activation: ours, and ATen's.
void Dense(benchmark::State& state, bool aten) {
  const at::NoGradGuard no_grad;
  const int64_t Q = 4096, C = state.range(0);
  const at::Tensor x = at::randn({Q, C}), weight = at::randn({4 * C, C}), bias = at::randn({4 * C});
  for (auto _ : state) {
    benchmark::DoNotOptimize(aten ? at::gelu(at::linear(x, weight, bias))
                                  : linear_gelu(x, weight, bias));
  }
  state.counters["flop"] = benchmark::Counter(2.0 * static_cast<double>(Q * C * 4 * C),
                                              benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK_CAPTURE(Dense, lte, false)
    ->Arg(64)
    ->Arg(128)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(Dense, aten, true)
    ->Arg(64)
    ->Arg(128)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// 48 lobes of 1,024 points in 64 directions: one operator, and one for each step.
void LobeRadiance(benchmark::State& state, bool fused) {
  const at::NoGradGuard no_grad;
  const int64_t Q = 1024, N = 64, K = 48;
  const at::Tensor own = at::randn({Q, 5 * K}), directions = at::randn({Q, N, 3}),
                   light = at::rand({Q, 3});
  const LobeWeights w{{at::randn({K, K}), at::randn({K})}, {at::randn({3, K}), at::randn({3})}};
  const auto steps = [&] {
    const at::Tensor lobes =
        at::baddbmm(own.narrow(1, 3 * K, K).unsqueeze(1), directions,
                    own.narrow(1, 0, 3 * K).reshape({Q, K, 3}).transpose(1, 2));
    const at::Tensor mixed = lte::ops::linear(lte::ops::gelu(lobes), w.mix.weight, w.mix.bias);
    const at::Tensor color = lte::ops::linear(
        lte::ops::gelu(mixed + own.narrow(1, 4 * K, K).unsqueeze(1)), w.color.weight, w.color.bias);
    return at::softplus(color) * light.unsqueeze(1);
  };
  for (auto _ : state)
    benchmark::DoNotOptimize(fused ? lobe_radiance_inference(own, directions, light, {}, w)
                                   : steps());
}
BENCHMARK_CAPTURE(LobeRadiance, one_operator, true)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(LobeRadiance, step_by_step, false)->Unit(benchmark::kMillisecond)->UseRealTime();

/// 65,536 rays from the walls of the room into it, among as many discs as the argument says.
void SeeSurfels(benchmark::State& state) {
  const int64_t M = state.range(0), Q = 1024, N = 64;
  const at::Tensor points = room(M), extent = at::tensor({10.f, 3.f, 8.f});
  const auto inwards = [&](const at::Tensor& p) {
    const at::Tensor normal = p.eq(0).to(at::kFloat) - p.eq(extent).to(at::kFloat);
    return normal / normal.norm(2, 1, true);
  };
  at::Tensor discs = at::rand({M, kSurfelColumns});
  discs.narrow(1, SurfelColumn::kPosition, 3).copy_(points);
  discs.narrow(1, SurfelColumn::kNormal, 3).copy_(inwards(points));
  // 268 m² of walls, and discs of 1.6 times the radius of the share of each.
  discs.select(1, SurfelColumn::kRadius)
      .fill_(1.6 * std::sqrt(268 / 3.14159 / static_cast<double>(M)));
  discs.select(1, SurfelColumn::kMetallic).zero_();
  const SurfelGrid grid = make_surfel_grid(discs);
  const at::Tensor from = room(Q);
  const at::Tensor ways = at::randn({Q, N, 3}), normal = inwards(from).unsqueeze(1);
  const at::Tensor unit = ways / ways.norm(2, 2, true);
  const at::Tensor above = unit - 2 * (unit * normal).sum(2, true).clamp_max(0) * normal;
  for (auto _ : state) benchmark::DoNotOptimize(see_surfels(from, above, grid));
  state.SetItemsProcessed(state.iterations() * Q * N);
}
BENCHMARK(SeeSurfels)->Arg(4096)->Arg(32768)->Unit(benchmark::kMillisecond)->UseRealTime();

void MatrixProduct(benchmark::State& state, bool aten) {  // what the machine can do
  const at::NoGradGuard no_grad;
  const at::Tensor a = at::randn({4096, 128}), b = at::randn({128, 128});
  for (auto _ : state) benchmark::DoNotOptimize(aten ? at::mm(a, b.t()) : lte::ops::linear(a, b));
  state.counters["flop"] =
      benchmark::Counter(2.0 * 4096 * 128 * 128, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK_CAPTURE(MatrixProduct, lte, false)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(MatrixProduct, aten, true)->Unit(benchmark::kMillisecond)->UseRealTime();

/// One patch of 1,024 points, three heads of 16 channels, as in the finest stage of lte, forth
/// and back.
enum class Attention : uint8_t { Aten, Single, Bf16 };

void TrainPatchAttention(benchmark::State& state, Attention by) {
  constexpr int64_t kPoints = 1024, kHeads = 3, kWidth = 16;
  const at::Tensor qkv = at::randn({kPoints, 3 * kHeads * kWidth}).requires_grad_(),
                   grad = at::randn({kPoints, kHeads * kWidth});
  for (auto _ : state) {
    at::Tensor out;
    if (by == Attention::Aten) {
      std::vector<at::Tensor> part = qkv.view({1, kPoints, 3, kHeads, kWidth}).unbind(2);
      for (at::Tensor& t : part) t = t.transpose(1, 2);
      out = at::scaled_dot_product_attention(part[0], part[1], part[2])
                .transpose(1, 2)
                .reshape({kPoints, kHeads * kWidth});
    } else {
      out = lte::ops::patch_attention(qkv, {}, {}, kHeads, 1, by == Attention::Bf16);
    }
    out.backward(grad);
    benchmark::DoNotOptimize(qkv.grad().data_ptr());
    qkv.mutable_grad().reset();
  }
}
BENCHMARK_CAPTURE(TrainPatchAttention, lte, Attention::Single)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(TrainPatchAttention, lte_bf16, Attention::Bf16)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(TrainPatchAttention, aten, Attention::Aten)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// The decoder of lte with weights that mean nothing.
DecoderWeights random_decoder(int64_t channels, bool bf16) {
  const auto leaf = [](const at::Tensor& t) { return t.clone().requires_grad_(); };
  const auto linear = [&](int64_t in, int64_t out, bool round) {
    LinearWeights w{leaf(at::randn({out, in}) / std::sqrt(in)), leaf(at::zeros({out}))};
    if (round) w.rounded = w.weight.detach().to(at::kBFloat16);
    return w;
  };
  const auto norm = [&] {
    return NormWeights{leaf(at::ones({channels})), leaf(at::zeros({channels}))};
  };
  const auto perceptron = [&](int64_t in, int64_t hidden, int64_t out) {
    return PerceptronWeights{linear(in, hidden, bf16), linear(hidden, out, bf16)};
  };
  DecoderWeights w{perceptron(6, channels, channels),
                   {linear(kNormalInputs, 64, false), linear(64, channels, bf16)},
                   {},
                   norm(),
                   perceptron(channels, channels, 3)};
  for (int64_t l = 0; l < 6; ++l) {
    w.layers.push_back({norm(), linear(channels, channels, bf16), linear(channels, channels, bf16),
                        norm(), perceptron(channels, 4 * channels, channels)});
  }
  return w;
}

/// 8,192 queries to 1,024 latents of 48 channels, forth and back.
void TrainQueryDecoder(benchmark::State& state, bool bf16) {
  constexpr int64_t kQueries = 8192, kLatents = 1024, kChannels = 48, kLayers = 6;
  const at::Tensor anchor = room(kLatents), points = room(kQueries),
                   position = points.index_select(0, spatial_order(points)),
                   normal = at::randn({kQueries, 3}), anchor_normal = at::randn({kLatents, 3});
  const QueryNeighbourhood near{position,
                                anchor,
                                std::get<0>(knn(position, anchor, 32)),
                                1.0,
                                4.0,
                                normal / normal.norm(2, 1, true),
                                anchor_normal / anchor_normal.norm(2, 1, true)};
  const at::Tensor keys = at::randn({kLayers, kLatents, kChannels}), values = at::randn_like(keys),
                   table = neighbour_table(keys, values).detach().requires_grad_(),
                   attributes = at::randn({kQueries, 6}), grad = at::randn({kQueries, 3});
  const DecoderWeights weights = random_decoder(kChannels, bf16);
  for (auto _ : state) {
    query_decoder(attributes, near, table, weights).backward(grad);
    benchmark::DoNotOptimize(table.grad().data_ptr());
    table.mutable_grad().reset();
  }
}
BENCHMARK_CAPTURE(TrainQueryDecoder, lte, false)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(TrainQueryDecoder, lte_bf16, true)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
