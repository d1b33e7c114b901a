#include "lte/nn/encoder_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include <ATen/ATen.h>

#include "lte/base/random.h"
#include "lte/nn/constants.h"
#include "lte/ops/curve_codes.h"
#include "lte/ops/farthest_point.h"
#include "lte/ops/knn.h"
#include "lte/ops/submanifold_conv.h"

namespace lte::nn {
namespace {

/// The insertion distance of the last pick, or the last usable one before it: coincident points
/// come last, at distance 0, and the first pick has no distance. The whole scale if there is none.
double spacing_of(const at::Tensor& distance2, int64_t count) {
  const at::Tensor host = distance2.narrow(0, 0, count).to(at::kCPU, at::kDouble);
  const auto* d2 = host.const_data_ptr<double>();
  for (int64_t i = count - 1; i >= 1; --i) {
    if (d2[i] > 0) return std::max(std::sqrt(d2[i]), kLeastSpacing);
  }
  return 1;
}

/// The curves in the order in which a stage's blocks take them.
std::array<int64_t, kCurves> curve_rows(bool shuffle, uint64_t seed, int64_t stage) {
  std::array<int64_t, kCurves> rows = {0, 1, 2, 3};
  if (!shuffle) return rows;
  Rng rng(seed, static_cast<uint64_t>(stage));
  for (int64_t i = kCurves - 1; i > 0; --i) {
    std::swap(rows[i], rows[rng.below(static_cast<uint64_t>(i) + 1)]);
  }
  return rows;
}

/// Blocks of a stage on the way down or up, whichever are more.
int64_t deepest(const ModelConfig& config, size_t stage) {
  const int64_t down = config.encoder_depths[stage];
  return stage < config.decoder_depths.size() ? std::max(down, config.decoder_depths[stage]) : down;
}

/// Merges the points whose cells share the next coarser cell. Clusters are numbered along the Z
/// curve.
///
/// A Z code without its last three bits is the code of the coarser cell. So after a sort by it the
/// members of a cluster are a run, the runs come in the order of the curve, and the coarser cell is
/// that of any member, shifted. The sort is stable: the member taken is the lowest row, and the
/// same on every device.
StagePlan pool(const at::Tensor& cells, int64_t bits) {
  const at::Tensor code = ops::curve_codes(cells, ops::Curve::Z, bits).bitwise_right_shift(3);
  const auto [sorted, order] = at::sort(code, /*stable=*/true, /*dim=*/0, /*descending=*/false);
  const auto [unique, inverse, counts] =
      at::unique_consecutive(sorted, /*return_inverse=*/true, /*return_counts=*/true);
  StagePlan coarse;
  coarse.cluster = at::empty_like(inverse).scatter_(0, order, inverse);  // back from sorted rows
  const at::Tensor first = order.index_select(0, counts.cumsum(0) - counts);
  coarse.cells = cells.index_select(0, first).bitwise_right_shift(1).contiguous();
  return coarse;
}

/// Cosines and sines of the angles of `cells`, each [n, pairs]: as many pairs for each axis as fit,
/// x first; what is left does not turn.
std::tuple<at::Tensor, at::Tensor> rotary_angles(const at::Tensor& cells, int64_t pairs) {
  const int64_t of_axis = pairs / 3;
  const at::Tensor turn =
      at::pow(2.0, at::arange(of_axis, cells.options().dtype(at::kDouble))).mul(kRotaryTurn);
  // In double: a cell's number times the fastest angle has no digits to spare in float.
  const at::Tensor angle = cells.to(at::kDouble).unsqueeze(2).mul(turn).flatten(1);
  const at::Tensor all = at::constant_pad_nd(angle, {0, pairs - 3 * of_axis});
  return {all.cos().to(at::kFloat), all.sin().to(at::kFloat)};
}

}  // namespace

at::Tensor grid_cells(const at::Tensor& position, double* grid) {
  constexpr double kCells = double{1 << ops::kCurveBits};
  const double extent = position.max().item<double>();
  *grid = std::max(*grid, extent / (kCells - 1));
  // In double, so that a CPU and a GPU round alike.
  return position.to(at::kDouble).div(*grid).floor().clamp(0, kCells - 1).to(at::kInt).contiguous();
}

PatchMap make_patch_map(const at::Tensor& order, int64_t patch_size) {
  const int64_t n = order.size(0);
  const int64_t padded = (n + patch_size - 1) / patch_size * patch_size;
  PatchMap map;
  map.inverse = at::empty_like(order).scatter_(0, order, at::arange(n, order.options()));
  map.gather = at::cat({order, order.slice(0, n - patch_size, padded - patch_size)});
  return map;
}

std::vector<StagePlan> make_stages(const at::Tensor& cells, const ModelConfig& config, bool shuffle,
                                   uint64_t order_seed) {
  std::vector<StagePlan> stages;
  for (size_t s = 0; s < config.encoder_depths.size(); ++s) {
    const int64_t bits = ops::kCurveBits - static_cast<int64_t>(s);
    StagePlan stage;
    if (s == 0) {
      stage.cells = cells;
    } else {
      stage = pool(stages.back().cells, bits + 1);
    }
    std::tie(stage.pairs, stage.tap_begin) = ops::convolution_pairs(stage.cells, kBlockKernel);
    if (config.rotates_attention()) {
      std::tie(stage.cosine, stage.sine) = rotary_angles(stage.cells, config.head_width / 2);
    }
    if (stage.points() <= config.patch_size) {
      stage.patches.resize(1);
    } else {
      const auto rows = curve_rows(shuffle, order_seed, static_cast<int64_t>(s));
      for (int64_t i = 0; i < std::min(kCurves, deepest(config, s)); ++i) {
        const auto curve = static_cast<ops::Curve>(rows[static_cast<size_t>(i)]);
        const at::Tensor code = ops::curve_codes(stage.cells, curve, bits);
        const at::Tensor order =
            std::get<1>(at::sort(code, /*stable=*/true, /*dim=*/0, /*descending=*/false));
        stage.patches.push_back(make_patch_map(order, config.patch_size));
      }
    }
    stages.push_back(std::move(stage));
  }
  return stages;
}

EncoderPlan make_encoder_plan(const at::Tensor& position, const ModelConfig& config, bool shuffle,
                              uint64_t order_seed) {
  const int64_t M = position.size(0);
  const int64_t m1 = (M + 1) / 2, m = (m1 + 1) / 2;
  EncoderPlan plan;
  at::Tensor distance2;
  std::tie(plan.first_picks, distance2) = ops::farthest_point_sampling(position, m1);
  const at::Tensor halved = position.index_select(0, plan.first_picks);
  plan.position = halved.narrow(0, 0, m).contiguous();  // nested: a run of m picks begins the same
  plan.first_neighbours = std::get<0>(ops::knn(halved, position, config.nne_neighbours));
  plan.second_neighbours = std::get<0>(ops::knn(plan.position, halved, config.nne_neighbours));
  plan.spacing = spacing_of(distance2, m);
  plan.grid = config.grid_per_spacing * plan.spacing;
  const at::Tensor cells = grid_cells(plan.position, &plan.grid);
  plan.stages = make_stages(cells, config, shuffle, order_seed);
  const int64_t kernel = config.stem_kernel();
  if (kernel == kBlockKernel) {
    plan.stem_pairs = plan.stages[0].pairs;
    plan.stem_tap_begin = plan.stages[0].tap_begin;
  } else if (kernel > 0) {
    std::tie(plan.stem_pairs, plan.stem_tap_begin) = ops::convolution_pairs(cells, kernel);
  }
  return plan;
}

}  // namespace lte::nn
