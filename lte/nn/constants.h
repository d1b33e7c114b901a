// Numbers of the network's equations (docs/model.md) that no configuration changes, each written
// once. The TorchScript export fills its text from here. Weights were trained under these numbers:
// with others, the models that exist mean something else.
#pragma once

#include <cstdint>

#include "lte/ops/prior_columns.h"

namespace lte::nn {

/// Network-space positions of a room span a few tenths; normals and albedos span one. This factor
/// puts them on a par for the MLPs.
inline constexpr double kPositionGain = 4;

/// Queries are meant to lie in the scene. The query MLP does not see how much farther out than
/// this a query is, in network space.
inline constexpr double kPositionLimit = 4;

/// Offsets to neighbours beyond this many spacings say "far" and no more, so that a query far
/// outside the scene stays finite.
inline constexpr double kOffsetLimit = 64;

/// Scene points fit where every network-space coordinate is at most this: 1 but for rounding.
inline constexpr double kLargestPosition = 1.001;

/// The least spacing of the latents in network space. Below it (16 µm at s = 16 m) relative
/// positions are noise of float32 coordinates.
inline constexpr double kMinSpacing = 1e-6;

/// ε of every LayerNorm, LibTorch's default. The fused operators of lte/ops assume it too.
inline constexpr double kNormEpsilon = 1e-5;

/// Every GELU is x Φ(x) with the error function, which ATen calls this, and no approximation.
inline constexpr const char* kGeluForm = "none";

/// Edge in cells of the convolutions of transformer blocks; the stem's is
/// ModelConfig::stem_kernel().
inline constexpr int64_t kBlockKernel = 3;

/// h, the hidden width of γ, and the hidden width of the query decoder's MLPs in units of D.
inline constexpr int64_t kGammaHidden = 64, kFfnRatio = 4;

/// Rotary positions: the i-th of an axis's angles is kRotaryTurn 2^i a cell of the stage, so that
/// the slowest goes round once in 40 cells.
inline constexpr double kRotaryTurn = 0.157;

/// The most scenes of one pass, and the cells along an axis that each may have if there are
/// several: together they fill the range of the curves.
inline constexpr int64_t kMaxScenes = 16, kSceneCells = 4096;

/// Space-filling curves that the blocks of a stage take turns with: Z and Hilbert, each also with x
/// and y exchanged.
inline constexpr int64_t kCurves = 4;

// The light prior (light_prior.h). Found on homes by search: more neighbours blur, fewer let noise
// through.

inline constexpr int64_t kPriorNeighbours = 32;

/// Falloff with distance, falloff with height above the query's plane, least weight, and least mean
/// squared distance.
inline constexpr ops::PriorWeights kPriorWeights = {1.5F, 256, 1e-3F, 1e-16F};

/// Length of the normal of a surface's back. The normals' product is raised to the fourth power, so
/// a back counts for a tenth of a front. Most surfaces are those of closed bodies, whose backs are
/// dark: a query on one face of a board, which is thinner than the points are apart, must not read
/// the inside of the other. Behind a curtain, where nothing but backs faces the query, they still
/// outweigh the least weight thirty times.
inline constexpr double kPriorBack = 0.5623413251903491;

/// This share of the mean irradiance is added everywhere, so that a factor can lift what the prior
/// calls dark.
inline constexpr double kPriorFloor = 0.02;

/// What is added to the mean that the spread of the estimates is divided by, so that darkness has
/// none; and log(Σ w) / log and (log(d̄²) + log_shift) / log are of order one.
inline constexpr ops::PriorScales kPriorScales = {1e-3, 4, 8};

}  // namespace lte::nn
