#include "experiments/guiding/shared_places.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"
#include "lte/base/random.h"

namespace lte::experiments {

SharedPlaces::SharedPlaces(float radius_m, float least_cosine)
    : radius_(radius_m), least_cosine_(least_cosine) {
  LTE_CHECK(radius_m > 0 && std::isfinite(radius_m), "a radius must be positive, got ", radius_m);
  LTE_CHECK(least_cosine >= -1 && least_cosine <= 1, "a cosine must lie in [-1, 1], got ",
            least_cosine);
}

size_t SharedPlaces::CellHash::operator()(const Cell& cell) const {
  uint64_t hash = 0;
  for (const int32_t at : cell) hash = hash_combine(hash, static_cast<uint32_t>(at));
  return static_cast<size_t>(hash);
}

int32_t SharedPlaces::column(float x) const {
  // Further out, where cells would not have numbers of their own, all share the last.
  return static_cast<int32_t>(std::clamp(std::floor(x / (2 * radius_)), -1e9f, 1e9f));
}

int32_t SharedPlaces::find(const Vec3& position, const Vec3& normal) const {
  // As cells are two radii wide, what is near lies in at most two along each axis.
  const Cell first{column(position.x - radius_), column(position.y - radius_),
                   column(position.z - radius_)};
  const Cell last{column(position.x + radius_), column(position.y + radius_),
                  column(position.z + radius_)};
  int32_t nearest = -1;
  float least = radius_ * radius_;
  const auto look = [&](int32_t place) {
    const auto at = static_cast<size_t>(place);
    const Vec3 apart = position_[at] - position;
    const float distance2 = dot(apart, apart);
    if (distance2 > least || dot(normal_[at], normal) < least_cosine_) return;
    if (distance2 == least && nearest >= 0 && nearest < place) return;
    least = distance2;
    nearest = place;
  };
  for (int32_t x = first[0]; x <= last[0]; ++x) {
    for (int32_t y = first[1]; y <= last[1]; ++y) {
      for (int32_t z = first[2]; z <= last[2]; ++z) {
        const auto found = cells_.find({x, y, z});
        if (found != cells_.end()) std::for_each(found->second.begin(), found->second.end(), look);
      }
    }
  }
  return nearest;
}

int32_t SharedPlaces::join(const Vec3& position, const Vec3& normal) {
  const int32_t near = find(position, normal);
  if (near >= 0) return near;
  const auto place = static_cast<int32_t>(position_.size());
  position_.push_back(position);
  normal_.push_back(normal);
  cells_[{column(position.x), column(position.y), column(position.z)}].push_back(place);
  return place;
}

}  // namespace lte::experiments
