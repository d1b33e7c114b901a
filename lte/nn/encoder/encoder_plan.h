// All integer metadata of one scene, made once before the network runs: which points survive
// farthest point sampling, whose neighbours are whose, grid cells, curve orders, pooling clusters
// and convolution pairs. With it the network itself is a fixed sequence of tensor operations
// without a host synchronization.
//
// Several scenes may share a plan, and so one pass of the network: their points follow one another,
// and their cells lie too far apart for any to be a neighbour of another scene's.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/nn/config.h"
#include "lte/tensor/tensor.h"

namespace lte::nn {

/// How a stage's points are cut into attention patches along one curve. With at most `patch_size`
/// points there is a single patch, attention does not depend on order, and both tensors stay
/// undefined.
struct PatchMap {
  at::Tensor gather;   ///< [patches * patch_size] int64: the point in each slot, padding included
  at::Tensor inverse;  ///< [n] int64: the slot of each point
};

/// The points of one scene among a stage's.
struct SceneRows {
  int64_t begin = 0, count = 0;
  std::vector<PatchMap> patches;  ///< one a curve in use; block i takes patches[i mod size]
};

/// One resolution of PTV3.
struct StagePlan {
  at::Tensor cells;  ///< [n, 3] int32 grid cells
  /// ops::convolution_pairs() of the blocks' kernel, which all blocks of the stage share.
  at::Tensor pairs, tap_begin;
  /// [n, head_width / 2] float32 of the angles that turn queries and keys (lte/ops/rotary.h);
  /// undefined for models without rotary positions.
  at::Tensor cosine, sine;
  std::vector<SceneRows> scenes;
  at::Tensor scene;    ///< [n] int64, the scene of each point; undefined for one scene
  at::Tensor cluster;  ///< [points of the finer stage] int64 in [0, n); undefined for stage 0

  int64_t points() const { return cells.size(0); }
};

struct EncoderPlan {
  /// [m1] int64, m1 = ceil(M/2): the points that stay after the first halving.
  at::Tensor first_picks;
  /// [m] int64 among the m1, m = ceil(m1/2): those that stay after the second. Of one scene the
  /// first m of them.
  at::Tensor second_picks;
  at::Tensor first_neighbours;   ///< [m1, min(k, M)] int64, among all M
  at::Tensor second_neighbours;  ///< [m, min(k, m1)] int64, among the m1
  at::Tensor position;           ///< [m, 3] float32, network space
  std::vector<double> spacing;   ///< of each scene's points, network space, > 0
  std::vector<double> grid;      ///< edge of each scene's cells, network space
  at::Tensor stem_pairs, stem_tap_begin;
  std::vector<StagePlan> stages;
};

/// @param position    [M, 3] float32, network space, non-negative, M >= 1
/// @param shuffle     draws the order of each stage's curves from `order_seed`, as training does,
///                    instead of taking the fixed one
EncoderPlan make_encoder_plan(const at::Tensor& position, const ModelConfig& config, bool shuffle,
                              uint64_t order_seed);

/// A plan of several scenes, at most kMaxScenes, with an order_seed for each.
/// @throws lte::Error if a scene has more than kSceneCells cells along an axis, or fewer points
///         than the configuration has neighbours
EncoderPlan make_encoder_plan(const std::vector<at::Tensor>& positions, const ModelConfig& config,
                              bool shuffle, const std::vector<uint64_t>& order_seeds);

/// Cells of `position` (network space, non-negative) on a grid of edge `*grid`, which grows where
/// 16 bits an axis would not do.
at::Tensor grid_cells(const at::Tensor& position, double* grid);

/// Slots of the points of `order` ([n] int64, n > patch_size) in patches of equal size. The empty
/// slots of the last patch repeat the same slots of the one before, so that its points see real
/// neighbours and attention needs no mask.
PatchMap make_patch_map(const at::Tensor& order, int64_t patch_size);

/// Stage 0 has the cells given; each further stage halves the grid. Public for tests.
///
/// @param cells  those of scene s in the s-th run of kSceneCells along x
std::vector<StagePlan> make_stages(const at::Tensor& cells, const ModelConfig& config, bool shuffle,
                                   const std::vector<uint64_t>& order_seeds);

}  // namespace lte::nn
