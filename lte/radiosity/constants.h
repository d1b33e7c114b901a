// What the solver's versions for processors, GPUs and TorchScript must have alike.
#pragma once

#include <cstdint>

namespace lte::radiosity {

// Cells of so many spacings of the points. Of 0.6 to 1.1, and with kReach and kOwnCells, this
// agreed best with path-traced light in homes and boxes, by lamps and by daylight.
inline constexpr float kCellSpacings = 0.6f;
// Luminaires are near each other in cubes of so many spacings: those of the points there are, or of
// as many as this where there are more. A march for each luminaire of each point grows with the
// square of the points, and tells the network no more.
inline constexpr float kClusterSpacings = 0.9f;
inline constexpr double kFinestClusters = 8192;
/// Normals are alike that agree, axis by axis, on being above it, below −it or between.
inline constexpr float kMinAxisCosine = 0.5f;
// What weighs less is left out: emission and radiosity times these. A small lamp of many points
// weighs little by each of them.
inline constexpr float kMinDirect = 1e-9f, kMinTransfer = 2e-4f;
/// Of what senders stand for, the share that is reflected light; the other is area.
inline constexpr double kShareByLight = 0.5;

/// Cells of a grid at most, and what its cells grow by until that holds.
inline constexpr int64_t kMaxCells = int64_t{1} << 24;
inline constexpr float kCellGrowth = 1.26f;
/// A cell's side at least, of the longest extent.
inline constexpr float kMinCell = 1e-4f;

/// Cells between which a plane is closed: farther than holes are wide, nearer than doorways.
inline constexpr int32_t kReach = 4;
/// Cells by which a surfel may lie off the plane of another and still be of it.
inline constexpr float kFlat = 0.2f;
/// Cosine between the normals of two that lie in one plane.
inline constexpr float kMinNormalCosine = 0.95f;

/// Clearances are known up to this many cells.
inline constexpr int32_t kFarthest = 16;
/// Steps of a march, in cells: short enough that few marked cells are stepped over.
inline constexpr float kStep = 0.7f;
/// Cells by which an end may lie off a surfel's plane and still be on that surface.
inline constexpr float kOwnCells = 0.4f;
/// Cells around its middle in which a surfel blocks.
inline constexpr float kRadiusCells = 1;

}  // namespace lte::radiosity
