// Path-traced irradiance at points that a CSV file lists, for checks by other programs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::datagen {

struct ProbePoints {
  std::vector<std::string> lines;  ///< as read, one a point; the output repeats them
  std::vector<Vec3> position, normal;
};

/// Reads `px,py,pz,nx,ny,nz` in world space and brings normals to unit length.
/// @throws lte::Error naming file, line and column of a number that is missing or not finite, or of
///         a zero normal.
ProbePoints read_probe_points(const std::filesystem::path& path);

struct ProbeOptions {
  int64_t rays = 1024;  ///< paths a point, or their cap under a target
  int max_depth = 5;
  double target_error = 0;  ///< relative standard error of total irradiance; 0: `rays` a point
  uint64_t seed = 1;
};

struct ProbeResult {
  std::vector<Rgb> total, direct, standard_error;
  std::vector<int64_t> rays;  ///< number behind each estimate
  int64_t missed = 0;         ///< number of points above the target when the cap was reached
};

/// Estimates irradiance at each point. With a target, a pilot decides how many fresh paths the
/// estimate is made of (lte/pathtrace/adaptive.h, ErrorScale::OwnTotal): to choose the count from
/// the same samples would bias it. Standard errors come from the spread of independently scrambled
/// point sets, so they include the gain of stratification.
/// @throws lte::Error if options are out of range.
ProbeResult probe(const scene::Scene& scene, const ProbePoints& points,
                  const ProbeOptions& options);

/// Writes the input columns, then total_r,g,b, direct_r,g,b, stderr_r,g,b and rays. Atomic.
void write_probe_result(const std::filesystem::path& path, const ProbePoints& points,
                        const ProbeResult& result);

}  // namespace lte::datagen
