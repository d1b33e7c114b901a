// Scene points: the samples of a scene's surfaces that a network reads.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/pathtrace/reach/reach_memory.h"
#include "lte/scene/sampler.h"

namespace lte::embed {

/// Raised by every change after which the same seed draws other points, or other light is estimated
/// on them: of embeddings that are kept.
inline constexpr int kScenePointsVersion = 3;

/// Draws the points that describe a scene to the network, as every tool does.
/// @param prune   draw them only where light reaches
/// @param counts  what was pruned; may be null
/// @param recall  what is known of where light reaches
/// @param culled  light groups that count as dark where points are pruned: no point is theirs, and
///                none stands where they alone shine
scene::SurfaceSamples sample_scene_points(const pathtrace::Bvh& bvh, int64_t count, bool prune,
                                          uint64_t seed, pathtrace::PruneCounts* counts,
                                          const pathtrace::ReachRecall& recall = {},
                                          const std::vector<int>& culled = {});

}  // namespace lte::embed
