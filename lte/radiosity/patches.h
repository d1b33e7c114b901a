// Surface elements as a solver asks for them: all at once, from one point.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/base/math.h"

namespace lte::radiosity {

/// Light from a patch to a point, as Patches::transfer_to() tells it.
struct Transfers {
  static constexpr int32_t kFromBack = 1;  ///< it leaves the side that faces away from the normal
  static constexpr int32_t kToBack = 2;    ///< it arrives at the side that faces away
  std::vector<float> weight;               ///< irradiance there over radiance here
  std::vector<int32_t> sides;
};

/// A place on a surface.
struct Place {
  Vec3 position, normal;  ///< unit normal
};

class Patches {
 public:
  /// @param normal  unit vector
  /// @param area    m²
  void add(const Vec3& position, const Vec3& normal, float area);

  size_t size() const { return area_.size(); }
  Place place(size_t k) const { return {{x_[k], y_[k], z_[k]}, {nx_[k], ny_[k], nz_[k]}}; }

  /// What a point receives from each patch if nothing is between them: weights
  /// cos cos′ A / (d² + A/π), π times the form factor of a disc of area A, exact where it is seen
  /// head-on. They stay finite where the two touch.
  void transfer_to(const Place& point, Transfers* transfers) const;

 private:
  std::vector<float> x_, y_, z_, nx_, ny_, nz_, area_;
};

}  // namespace lte::radiosity
