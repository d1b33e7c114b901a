// Irradiance at points that a CSV file lists: the path tracer's word, for checks by other programs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::datagen {

struct ProbePoints {
  std::vector<std::string> lines;  ///< as read, one a point, to be repeated in the output
  std::vector<Vec3> position, normal;
};

/// Reads `px,py,pz,nx,ny,nz`, world space; normals are brought to unit length.
/// @throws lte::Error naming file, line and column of what is not a finite number, missing, or a
/// zero normal.
ProbePoints read_probe_points(const std::filesystem::path& path);

struct ProbeOptions {
  int64_t rays = 1024;  ///< paths a point, or their cap under a target
  int max_depth = 5;
  double target_error =
      0;  ///< relative standard error of total irradiance; 0 for a fixed number of rays
  uint64_t seed = 1;
};

struct ProbeResult {
  std::vector<Rgb> total, direct, standard_error;
  std::vector<int64_t> rays;  ///< behind each estimate
  int64_t missed = 0;         ///< points above the target when the cap was reached
};

/// With a target, a pilot decides how many fresh paths the estimate is made of
/// (lte/pathtrace/adaptive.h, ErrorScale::OwnTotal): choosing the count from the same samples would
/// bias it. Standard errors are from the spread of independently scrambled point sets,
/// stratification included.
/// @throws lte::Error if options are out of range.
ProbeResult probe(const scene::Scene& scene, const ProbePoints& points,
                  const ProbeOptions& options);

/// The input columns, then total_r,g,b, direct_r,g,b, stderr_r,g,b, rays. Atomic.
void write_probe_result(const std::filesystem::path& path, const ProbePoints& points,
                        const ProbeResult& result);

}  // namespace lte::datagen
