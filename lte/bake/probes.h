// Irradiance probes: the light around points of a grid, for what moves through a baked scene.
//
// Spherical harmonics are real and orthonormal, in the order Y00, Y1-1 (y), Y10 (z), Y11 (x), Y2-2
// (xy), Y2-1 (yz), Y20 (3z² − 1), Y21 (xz), Y22 (x² − y²); a coefficient is ∫ L Y dω. The sides of
// an ambient cube are −x, +x, −y, +y, −z, +z.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::bake {

inline constexpr int kShCoefficients = 9, kCubeSides = 6;

/// Cells of a box, with a probe in the middle of each.
struct ProbeGrid {
  std::array<int, 3> counts{1, 1, 1};
  Bounds bounds;

  int64_t size() const { return int64_t{counts[0]} * counts[1] * counts[2]; }
  /// x runs fastest, then y.
  Vec3 position(int64_t probe) const;
};

/// The grid over a scene. "auto" cuts its longest side into 16, and the others alike.
/// @param text  of --probes: "auto" or NXxNYxNZ
/// @throws lte::Error naming --probes unless each number is 1 to 256.
ProbeGrid parse_probe_grid(const std::string& text, const Bounds& scene);

struct ProbeOptions {
  int rays = 1024;  ///< paths a probe, and as many light samples
  int max_depth = 5;
  bool direct = true;  ///< light that no surface has reflected counts too
  uint64_t seed = 0;
  /// Told of probes as they are done, by the threads that did them. May be empty.
  std::function<void(int64_t count)> done = {};
};

struct Probe {
  std::array<Rgb, kShCoefficients> radiance;  ///< coefficients of L, W sr^-1 m^-2
  std::array<Rgb, kCubeSides> irradiance;     ///< E on each side, W/m²
  /// Means over directions of the distance to what they meet and of its square, metres: each
  /// direction counts for a side by the square of its component. What meets nothing counts as the
  /// diagonal of the scene.
  std::array<float, kCubeSides> distance{}, distance2{};
  float back_faces = 0;  ///< share of directions that meet the back of a one-sided surface
  bool valid = true;     ///< not in a wall: back_faces is below kMaxBackFaces
};

struct ProbeVolume {
  ProbeGrid grid;
  std::vector<Probe> probes;  ///< [grid.size()]
  int64_t invalid = 0;
};

/// From this share on a probe stands in a wall, or outside the room.
inline constexpr float kMaxBackFaces = 0.25f;

/// Traces paths from every probe, in parallel; light of the first hit is weighed against light
/// samples by the balance heuristic. Light of invalid probes is the mean of their nearest valid
/// neighbors', so that interpolation carries no darkness out of walls. The result depends on the
/// seed alone, not on threads.
/// @throws lte::Error if all probes are invalid, or an option is out of range.
ProbeVolume bake_probes(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                        const ProbeGrid& grid, const ProbeOptions& options);

/// The nine basis functions in a unit direction.
std::array<float, kShCoefficients> sh_basis(const Vec3& direction);

/// E on a surface of unit normal by the probe's harmonics (Ramamoorthi and Hanrahan 2001); not
/// below 0.
Rgb sh_irradiance(const Probe& probe, const Vec3& normal);

}  // namespace lte::bake
