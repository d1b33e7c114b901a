// Irradiance interpolated between probes: what a renderer without a network could do with the time
// that the network's encoding takes.
#pragma once

#include <cstdint>
#include <vector>

#include "infer/light/points.h"

namespace lte::infer {

/// Irradiance at some surface points, interpolated between them.
///
/// The value at p with normal n is Σ w_k E_k / Σ w_k over the 8 nearest probes that face the same
/// way (n·n_k > 0), with w_k = n·n_k / (|p − p_k|² + δ²) and δ a thousandth of the probes' extent.
/// Where no probe faces the same way, it is the nearest one's. A probe at p itself is left out: at
/// baked points it would be the reference.
class ProbeField {
 public:
  /// Takes at most `count` of the points, evenly spread over them.
  /// @param irradiance  one entry a point
  ProbeField(const QueryPoints& points, std::span<const Rgb> irradiance, int64_t count);

  /// Zero without any probe.
  std::vector<Rgb> interpolate(const QueryPoints& queries) const;

  int64_t size() const { return static_cast<int64_t>(position_.size()); }

 private:
  Rgb at(const Vec3& position, const Vec3& normal) const;

  std::vector<Vec3> position_, normal_;
  std::vector<Rgb> irradiance_;
  float softening2_ = 0;  ///< δ², m²
};

}  // namespace lte::infer
