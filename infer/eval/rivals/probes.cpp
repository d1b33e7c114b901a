#include "infer/eval/rivals/probes.h"

#include <algorithm>
#include <array>
#include <limits>

#include "infer/eval/rivals/blur.h"
#include "lte/base/check.h"
#include "lte/base/parallel.h"

namespace lte::infer {
namespace {

constexpr size_t kNeighbours = 8;
constexpr int64_t kGrain = 64;
constexpr float kSoftening = 1e-3f;  // of the extent
constexpr float kFar = std::numeric_limits<float>::max();

struct Neighbour {
  float distance2 = kFar;
  size_t index = 0;
};

}  // namespace

ProbeField::ProbeField(const QueryPoints& points, std::span<const Rgb> irradiance, int64_t count) {
  LTE_CHECK(irradiance.size() == points.position.size(), "probes: ", irradiance.size(),
            " values for ", points.position.size(), " points");
  Bounds bounds;
  for (const int64_t picked : spread(points.size(), count)) {
    const auto i = static_cast<size_t>(picked);
    position_.push_back(points.position[i]);
    normal_.push_back(points.normal[i]);
    irradiance_.push_back(irradiance[i]);
    bounds.extend(points.position[i]);
  }
  if (position_.empty()) return;
  const float softening = kSoftening * max_component(bounds.extent());
  softening2_ = std::max(softening * softening, std::numeric_limits<float>::min());
}

Rgb ProbeField::at(const Vec3& position, const Vec3& normal) const {
  std::array<Neighbour, kNeighbours> best{};  // ascending
  Neighbour nearest;
  for (size_t k = 0; k < position_.size(); ++k) {
    const Vec3 offset = position - position_[k];
    const float distance2 = dot(offset, offset);
    if (distance2 == 0) continue;
    if (distance2 < nearest.distance2) nearest = {distance2, k};
    if (distance2 >= best.back().distance2 || dot(normal, normal_[k]) <= 0) continue;
    size_t place = kNeighbours - 1;
    for (; place > 0 && best[place - 1].distance2 > distance2; --place)
      best[place] = best[place - 1];
    best[place] = {distance2, k};
  }
  Rgb sum;
  float weights = 0;
  for (const Neighbour& neighbour : best) {
    if (neighbour.distance2 == kFar) break;
    const float weight =
        dot(normal, normal_[neighbour.index]) / (neighbour.distance2 + softening2_);
    sum += weight * irradiance_[neighbour.index];
    weights += weight;
  }
  if (weights > 0) return sum / weights;
  return nearest.distance2 < kFar ? irradiance_[nearest.index] : Rgb{};
}

std::vector<Rgb> ProbeField::interpolate(const QueryPoints& queries) const {
  std::vector<Rgb> out(queries.position.size());
  parallel_for(queries.size(), kGrain, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i)
      out[i] = at(queries.position[i], queries.normal[i]);
  });
  return out;
}

}  // namespace lte::infer
