#include "lte/gi/bright_places.h"

#include <algorithm>
#include <cmath>

#include "lte/pathtrace/hemisphere.h"
#include "lte/pathtrace/materials/lambert.h"

namespace lte::gi {
namespace {

// All chosen in wild rooms, at 2 to 64 rays a point. Bright is what sends out more than this many
// times the mean of lit surfaces: of it the brightest, up to this share of their area.
constexpr float kBright = 3;
constexpr double kSmall = 0.1;
constexpr size_t kMaxPlaces = 64;
// Shares of a point's rays. The cosine keeps most of them: places may be hidden, and all other
// surfaces shine, too.
constexpr float kMinShare = 0.02f, kMaxShare = 0.35f;
// A place's reach in edges of the record that it begins with, and the least cosine of its normals.
constexpr float kReach = 3, kSameSide = 0.8f;
// Radius of a place over that of a disc of its area: what records stand for are no discs.
constexpr float kWide = 1.3f;

float gray(const Rgb& light) { return light.x + light.y + light.z; }

}  // namespace

BrightPlaces::BrightPlaces(const CacheRecords& records, std::span<const Rgb> irradiance) {
  std::vector<float> radiance(irradiance.size());
  double lit = 0, power = 0;
  for (size_t i = 0; i < radiance.size(); ++i) {
    radiance[i] = gray(irradiance[i] * records.albedo[i]) / kPi;
    if (!(radiance[i] > 0)) continue;
    lit += double{records.area[i]};
    power += double{records.area[i]} * double{radiance[i]};
  }
  if (!(power > 0)) return;
  const float bright = kBright * static_cast<float>(power / lit);
  std::vector<uint32_t> left;
  for (uint32_t i = 0; i < radiance.size(); ++i) {
    if (radiance[i] > bright) left.push_back(i);
  }
  std::stable_sort(left.begin(), left.end(),
                   [&](uint32_t a, uint32_t b) { return radiance[a] > radiance[b]; });
  double area = 0;
  const auto end = std::find_if(left.begin(), left.end(), [&](uint32_t i) {
    area += double{records.area[i]};
    return area > kSmall * lit;
  });
  left.erase(end, left.end());
  while (!left.empty()) power -= double{join_neighbors(records, radiance, &left)};
  std::stable_sort(places_.begin(), places_.end(),
                   [](const Place& a, const Place& b) { return a.intensity > b.intensity; });
  if (places_.size() > kMaxPlaces) places_.resize(kMaxPlaces);
  elsewhere_ = kPi * static_cast<float>(std::max(power, 0.0) / lit);
}

/// Makes one place of the first record and those of its side that are near, and leaves the others.
/// @return  the place's intensity
float BrightPlaces::join_neighbors(const CacheRecords& records, const std::vector<float>& radiance,
                                   std::vector<uint32_t>* left) {
  const uint32_t first = left->front();
  const float reach2 = kReach * kReach * records.area[first];
  Place place;
  float area = 0;
  std::erase_if(*left, [&](uint32_t i) {
    const Vec3 to = records.position[i] - records.position[first];
    if (dot(to, to) > reach2 || dot(records.normal[i], records.normal[first]) < kSameSide)
      return false;
    const float intensity = radiance[i] * records.area[i];
    area += records.area[i];
    place.intensity += intensity;
    place.position += to * intensity;
    place.normal += records.normal[i] * intensity;
    return true;
  });
  place.position = records.position[first] + place.position * (1 / place.intensity);
  place.normal = normalize(place.normal);
  place.radius2 = area * kWide * kWide / kPi;
  places_.push_back(place);
  return place.intensity;
}

Aim BrightPlaces::aim(const Vec3& position, const Vec3& normal) const {
  Aim out;
  float sum = 0;
  for (const Place& place : places_) {
    const Vec3 to = place.position - position;
    const float distance2 = dot(to, to);
    if (!(distance2 > 0)) continue;
    const float distance = std::sqrt(distance2);
    const float leaves = -dot(place.normal, to) / distance;
    // A disc whose middle is below the horizon may reach above it.
    const float wide = std::min(std::sqrt(place.radius2) / distance, 1.0f);
    const float arrives = std::min(dot(normal, to) / distance + 0.5f * wide, 1.0f);
    if (!(leaves > 0) || !(arrives > 0)) continue;
    const float light = place.intensity * leaves * arrives / std::max(distance2, place.radius2);
    sum += light;
    const Aim::Cone cone{to * (1 / distance), distance / std::sqrt(distance2 + place.radius2),
                         light};
    if (out.count_ < Aim::kMax) {
      out.cones_[static_cast<size_t>(out.count_++)] = cone;
      continue;
    }
    const auto least = std::min_element(
        out.cones_.begin(), out.cones_.end(),
        [](const Aim::Cone& a, const Aim::Cone& b) { return a.weight < b.weight; });
    if (light > least->weight) *least = cone;
  }
  const float share = sum / (sum + elsewhere_);
  if (!(share >= kMinShare)) return {};
  out.share_ = std::min(share, kMaxShare);
  float kept = 0;
  for (int k = 0; k < out.count_; ++k) kept += out.cones_[static_cast<size_t>(k)].weight;
  for (int k = 0; k < out.count_; ++k)
    out.cones_[static_cast<size_t>(k)].weight *= out.share_ / kept;
  return out;
}

Vec3 Aim::sample(const Vec3& normal, const Vec2& u) const {
  float x = u.x, pdf = 0;
  if (x >= share_) {
    return pathtrace::sample_lambert(
        normal, {std::min((x - share_) / (1 - share_), 1 - 0x1p-24f), u.y}, &pdf);
  }
  int k = 0;
  while (k + 1 < count_ && x >= cones_[static_cast<size_t>(k)].weight)
    x -= cones_[static_cast<size_t>(k++)].weight;
  const Cone& cone = cones_[static_cast<size_t>(k)];
  const float z = 1 - std::min(x / cone.weight, 1.0f) * (1 - cone.least_cosine);
  const float r = std::sqrt(std::max(0.0f, 1 - z * z));
  const Vec2 around = pathtrace::unit_circle(u.y);
  Vec3 tangent, bitangent;
  make_frame(cone.axis, &tangent, &bitangent);
  return normalize(cone.axis * z + tangent * (r * around.x) + bitangent * (r * around.y));
}

float Aim::pdf(float cosine, const Vec3& direction) const {
  float sum = (1 - share_) * pathtrace::lambert_pdf(cosine);
  for (int k = 0; k < count_; ++k) {
    const Cone& cone = cones_[static_cast<size_t>(k)];
    if (dot(cone.axis, direction) >= cone.least_cosine)
      sum += cone.weight / (2 * kPi * (1 - cone.least_cosine));
  }
  return sum;
}

}  // namespace lte::gi
