#include "lte/nn/encoder/encoder_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/nn/constants.h"
#include "lte/ops/curve_codes.h"
#include "lte/ops/farthest_point.h"
#include "lte/ops/knn.h"
#include "lte/ops/submanifold_conv.h"
#include "lte/tensor/functions.h"

namespace lte::nn {
namespace {

/// The insertion distance of the last pick, or the last usable one before it: coincident points
/// come last, at distance 0, and the first pick has no distance. The whole scale if there is none.
double spacing_of(const at::Tensor& distance2, int64_t count) {
  const at::Tensor host = distance2.narrow(0, 0, count).to(at::kCPU, at::kDouble);
  const auto* d2 = host.const_data_ptr<double>();
  for (int64_t i = count - 1; i >= 1; --i) {
    if (d2[i] > 0) return std::max(std::sqrt(d2[i]), kMinSpacing);
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

/// The runs of rows that are the scenes'. Scene s has the cells from s · kSceneCells along x on,
/// and pooling numbers clusters along the Z curve, whose foremost bit is that of x: so scenes stay
/// in their order.
std::vector<SceneRows> rows_of_scenes(const at::Tensor& cells, int64_t stage, size_t scenes) {
  if (scenes == 1) return {{0, cells.size(0), {}}};
  const at::Tensor counts =
      at::bincount(cells.select(1, 0).div(kSceneCells >> stage, "floor").to(at::kLong), {},
                   static_cast<int64_t>(scenes))
          .to(at::kCPU);
  std::vector<SceneRows> rows;
  int64_t begin = 0;
  for (size_t i = 0; i < scenes; ++i) {
    const auto count = counts.const_data_ptr<int64_t>()[i];
    rows.push_back({begin, count, {}});
    begin += count;
  }
  return rows;
}

at::Tensor scene_numbers(const StagePlan& stage) {
  std::vector<int64_t> counts;
  for (const SceneRows& rows : stage.scenes) counts.push_back(rows.count);
  return at::repeat_interleave(at::tensor(counts, stage.cells.options().dtype(at::kLong)));
}

/// Patches of a scene along each of the curves that `blocks` blocks take turns with.
std::vector<PatchMap> patches_of(const at::Tensor& cells, const ModelConfig& config, int64_t bits,
                                 const std::array<int64_t, kCurves>& curves, int64_t blocks) {
  std::vector<PatchMap> patches;
  if (cells.size(0) <= config.patch_size) {
    patches.resize(1);
    return patches;
  }
  for (int64_t i = 0; i < std::min(kCurves, blocks); ++i) {
    const auto curve = static_cast<ops::Curve>(curves[static_cast<size_t>(i)]);
    const at::Tensor code = ops::curve_codes(cells.contiguous(), curve, bits);
    const at::Tensor order =
        std::get<1>(at::sort(code, /*stable=*/true, /*dim=*/0, /*descending=*/false));
    patches.push_back(make_patch_map(order, config.patch_size));
  }
  return patches;
}

/// What of a plan is one scene's own, before stages are made of all cells.
struct ScenePart {
  at::Tensor first_picks, first_neighbours, second_neighbours, position, cells;
  double spacing = 1, grid = 1;
};

/// Points that are left of n after one halving.
int64_t half_of(int64_t n) { return (n + 1) / 2; }

/// @param picks, distance2  of half of the points by farthest point sampling
ScenePart make_part(const at::Tensor& position, const at::Tensor& picks,
                    const at::Tensor& distance2, const ModelConfig& config) {
  const int64_t m = half_of(picks.size(0));
  ScenePart part;
  part.first_picks = picks;
  const at::Tensor halved = position.index_select(0, part.first_picks);
  part.position = halved.narrow(0, 0, m).contiguous();  // nested: a run of m picks begins the same
  part.first_neighbours = std::get<0>(ops::knn(halved, position, config.nne_neighbours));
  part.second_neighbours = std::get<0>(ops::knn(part.position, halved, config.nne_neighbours));
  part.spacing = spacing_of(distance2, m);
  part.grid = config.grid_per_spacing() * part.spacing;
  part.cells = grid_cells(part.position, &part.grid);
  return part;
}

/// Moves the cells of scene `index` into their run along x.
at::Tensor apart(const at::Tensor& cells, int64_t index) {
  LTE_CHECK(cells.max().item<int64_t>() < kSceneCells, "scene ", index,
            " of a pass over several is too fine: it has more than ", kSceneCells,
            " cells along an axis; take one scene a pass");
  const at::Tensor shift =
      at::tensor({index * kSceneCells, int64_t{0}, int64_t{0}}, cells.options());
  return cells.add(shift);
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
                                   const std::vector<uint64_t>& order_seeds) {
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
    stage.scenes = rows_of_scenes(stage.cells, static_cast<int64_t>(s), order_seeds.size());
    if (order_seeds.size() > 1) stage.scene = scene_numbers(stage);
    for (size_t i = 0; i < order_seeds.size(); ++i) {
      SceneRows& rows = stage.scenes[i];
      // Where the scene would lie by itself, so that its curves are the same in any company.
      const auto run = static_cast<int64_t>(i) * (kSceneCells >> s);
      const at::Tensor own = stage.cells.narrow(0, rows.begin, rows.count) -
                             at::tensor({run, int64_t{0}, int64_t{0}}, stage.cells.options());
      const auto curves = curve_rows(shuffle, order_seeds[i], static_cast<int64_t>(s));
      rows.patches = patches_of(own, config, bits, curves, deepest(config, s));
    }
    stages.push_back(std::move(stage));
  }
  return stages;
}

EncoderPlan make_encoder_plan(const at::Tensor& position, const ModelConfig& config, bool shuffle,
                              uint64_t order_seed) {
  return make_encoder_plan(std::vector{position}, config, shuffle, std::vector{order_seed});
}

EncoderPlan make_encoder_plan(const std::vector<at::Tensor>& positions, const ModelConfig& config,
                              bool shuffle, const std::vector<uint64_t>& order_seeds) {
  LTE_CHECK(!positions.empty() && positions.size() == order_seeds.size() &&
                static_cast<int64_t>(positions.size()) <= kMaxScenes,
            "a plan of ", positions.size(), " scenes with ", order_seeds.size(),
            " seeds; expected 1 to ", kMaxScenes, " and as many");
  const bool several = positions.size() > 1;
  EncoderPlan plan;
  std::vector<at::Tensor> first_picks, second_picks, first_neighbours, second_neighbours, places,
      cells;
  std::vector<int64_t> halves;
  for (const at::Tensor& position : positions) halves.push_back(half_of(position.size(0)));
  const auto [picks, distances] = ops::farthest_point_sampling_of_sets(positions, halves);
  int64_t points = 0, halved = 0;  // of the scenes so far
  for (size_t i = 0; i < positions.size(); ++i) {
    const ScenePart part = make_part(positions[i], picks[i], distances[i], config);
    const int64_t m1 = part.first_picks.size(0), m = part.position.size(0);
    LTE_CHECK(!several || (m1 >= config.nne_neighbours && m >= config.query_neighbours), "scene ",
              i, " of a pass over several has ", positions[i].size(0),
              " points, too few for as many neighbours as the others have; take one scene a pass");
    first_picks.push_back(part.first_picks + points);
    first_neighbours.push_back(part.first_neighbours + points);
    second_picks.push_back(at::arange(halved, halved + m, part.first_picks.options()));
    second_neighbours.push_back(part.second_neighbours + halved);
    places.push_back(part.position);
    cells.push_back(several ? apart(part.cells, static_cast<int64_t>(i)) : part.cells);
    plan.spacing.push_back(part.spacing);
    plan.grid.push_back(part.grid);
    points += positions[i].size(0);
    halved += m1;
  }
  plan.first_picks = at::cat(first_picks);
  plan.second_picks = at::cat(second_picks);
  plan.first_neighbours = at::cat(first_neighbours);
  plan.second_neighbours = at::cat(second_neighbours);
  plan.position = at::cat(places);
  const at::Tensor all = at::cat(cells);
  plan.stages = make_stages(all, config, shuffle, order_seeds);
  const int64_t kernel = config.stem_kernel();
  if (kernel == kBlockKernel) {
    plan.stem_pairs = plan.stages[0].pairs;
    plan.stem_tap_begin = plan.stages[0].tap_begin;
  } else {
    std::tie(plan.stem_pairs, plan.stem_tap_begin) = ops::convolution_pairs(all, kernel);
  }
  return plan;
}

}  // namespace lte::nn
