#include "lte/nn/surfel_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lte::nn {
namespace {

constexpr int kMostCells = 128;  ///< along an axis
constexpr int kBounces = 2;
/// Reflections at the first metal of a ray; one at those behind it.
constexpr int kReflections = 4;
/// Distances in radii: nearer than the first, a disc is the ray's own surface; discs that lie
/// behind the nearest by less than the second are one surface with it.
constexpr float kOwn = 0.1f, kLayer = 0.5f;
/// The variance of a disc's weight, in squares of its radius.
constexpr float kSpread = 0.35f;
/// A back that sends out less than this share of the front's light is the inside of a body: rays
/// come to it through gaps between discs only.
constexpr float kInside = 0.1f;

bool has_back(const Surfel& surfel) {
  return luminance(surfel.back) > kInside * luminance(surfel.front);
}

struct Meeting {
  float distance, weight;
  int32_t surfel;
  bool front;
};

/// The half vector of GGX at `u` of its cumulative distribution.
Vec3 half_vector(const Vec3& normal, float roughness, float u, float turn) {
  const float alpha = roughness * roughness;
  const float tangent = alpha * std::sqrt(u / (1 - u));
  const float cosine = 1 / std::sqrt(1 + tangent * tangent), sine = tangent * cosine;
  Vec3 x, y;
  make_frame(normal, &x, &y);
  return normal * cosine + (x * std::cos(turn) + y * std::sin(turn)) * sine;
}

/// Where a ray goes on, as from a mirror with the normal `about`.
Vec3 mirrored(const Vec3& direction, const Vec3& about) {
  return direction - about * (2 * dot(direction, about));
}

}  // namespace

struct SurfelGrid::Layer {
  Vec3 place, normal;
  Rgb sent, emission, metal;
  float distance = 0, metallic = 0, roughness = 0, radius = 0;
};

SurfelGrid::SurfelGrid(std::vector<Surfel> surfels, bool total)
    : surfels_(std::move(surfels)), total_(total) {
  Bounds bounds;
  double radius = 0, area = 0, sent[3] = {0, 0, 0};
  for (const Surfel& s : surfels_) {
    bounds.extend(s.position - Vec3{s.radius, s.radius, s.radius});
    bounds.extend(s.position + Vec3{s.radius, s.radius, s.radius});
    radius += s.radius;
    area += s.radius * s.radius;
    for (int c = 0; c < 3; ++c) sent[c] += s.radius * s.radius * s.front[c];
  }
  if (surfels_.empty()) {
    first_ = {0, 0};
    return;
  }
  for (int c = 0; c < 3; ++c) ambient_[c] = static_cast<float>(sent[c] / std::max(area, 1e-30));
  low_ = bounds.low;
  const Vec3 extent = bounds.extent();
  cell_ = std::max({2 * static_cast<float>(radius / static_cast<double>(surfels_.size())),
                    max_component(extent) / kMostCells, 1e-6f});
  for (int axis = 0; axis < 3; ++axis)
    size_[axis] = std::clamp(static_cast<int>(extent[axis] / cell_) + 1, 1, kMostCells + 1);
  fill_cells();
}

void SurfelGrid::fill_cells() {
  const auto visit = [this](const auto& each) {
    for (size_t i = 0; i < surfels_.size(); ++i) {
      const Surfel& s = surfels_[i];
      int from[3], to[3];
      for (int axis = 0; axis < 3; ++axis) {
        const float reach =
            s.radius * std::sqrt(std::max(0.0f, 1 - s.normal[axis] * s.normal[axis]));
        const auto cell = [&](float at) {
          return std::clamp(static_cast<int>((at - low_[axis]) / cell_), 0, size_[axis] - 1);
        };
        // A little more, so that rounding loses no place of the disc.
        from[axis] = cell(s.position[axis] - reach - 1e-3f * cell_);
        to[axis] = cell(s.position[axis] + reach + 1e-3f * cell_);
      }
      for (int z = from[2]; z <= to[2]; ++z)
        for (int y = from[1]; y <= to[1]; ++y)
          for (int x = from[0]; x <= to[0]; ++x)
            each(static_cast<size_t>((z * size_[1] + y) * size_[0] + x), static_cast<int32_t>(i));
    }
  };
  const size_t cells =
      static_cast<size_t>(size_[0]) * static_cast<size_t>(size_[1]) * static_cast<size_t>(size_[2]);
  first_.assign(cells + 1, 0);
  visit([this](size_t cell, int32_t) { ++first_[cell + 1]; });
  for (size_t cell = 0; cell < cells; ++cell) first_[cell + 1] += first_[cell];
  member_.resize(static_cast<size_t>(first_.back()));
  std::vector<int32_t> next(first_.begin(), first_.end() - 1);
  visit([&](size_t cell, int32_t i) { member_[static_cast<size_t>(next[cell]++)] = i; });
}

bool SurfelGrid::meet(const Vec3& origin, const Vec3& direction, Layer* layer) const {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  // The ray in the grid: the distances of the next border along each axis (Amanatides and Woo).
  float enter = 0, leave = kFar;
  for (int axis = 0; axis < 3; ++axis) {
    const float inverse = 1 / direction[axis];
    const float a = (low_[axis] - origin[axis]) * inverse,
                b = (low_[axis] + static_cast<float>(size_[axis]) * cell_ - origin[axis]) * inverse;
    if (std::isnan(a) || std::isnan(b)) continue;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (!(enter < leave)) return false;
  const Vec3 start = origin + direction * enter - low_;
  int at[3], step[3];
  float border[3], width[3];
  for (int axis = 0; axis < 3; ++axis) {
    at[axis] = std::clamp(static_cast<int>(start[axis] / cell_), 0, size_[axis] - 1);
    const float d = direction[axis];
    step[axis] = d > 0 ? 1 : -1;
    width[axis] = d != 0 ? cell_ / std::abs(d) : kFar;
    const float next = low_[axis] + static_cast<float>(at[axis] + (d > 0 ? 1 : 0)) * cell_;
    border[axis] = d != 0 ? (next - origin[axis]) / d : kFar;
  }
  constexpr size_t kMostMeetings = 24;
  std::array<Meeting, kMostMeetings> met;
  size_t count = 0;
  float limit = kFar, begin = -kFar;
  while (begin <= limit) {
    const int axis =
        border[0] < border[1] ? (border[0] < border[2] ? 0 : 2) : (border[1] < border[2] ? 1 : 2);
    const float end = border[axis];
    const auto cell = static_cast<size_t>((at[2] * size_[1] + at[1]) * size_[0] + at[0]);
    for (int32_t k = first_[cell]; k < first_[cell + 1]; ++k) {
      const int32_t i = member_[static_cast<size_t>(k)];
      const Surfel& s = surfels_[static_cast<size_t>(i)];
      const float toward = dot(direction, s.normal);
      const Vec3 offset = s.position - origin;
      const float distance = dot(offset, s.normal) / toward;
      // A disc lies in several cells: it counts in that where the ray meets it.
      if (!(distance > kOwn * s.radius) || distance < begin || distance >= end || distance > limit)
        continue;
      const Vec3 away = direction * distance - offset;
      const float square = dot(away, away) / (s.radius * s.radius);
      if (square >= 1 || (toward > 0 && !has_back(s))) continue;
      if (count < kMostMeetings)
        met[count++] = {distance, std::exp(-square / kSpread), i, toward < 0};
      limit = std::min(limit, distance + kLayer * s.radius);
    }
    begin = end;
    at[axis] += step[axis];
    if (at[axis] < 0 || at[axis] >= size_[axis]) break;
    border[axis] += width[axis];
  }
  if (count == 0) return false;
  float total = 0;
  *layer = {};
  for (size_t i = 0; i < count; ++i) {
    if (met[i].distance > limit) continue;
    const Surfel& s = surfels_[static_cast<size_t>(met[i].surfel)];
    const float w = met[i].weight;
    total += w;
    layer->distance += w * met[i].distance;
    layer->normal += s.normal * (met[i].front ? w : -w);
    layer->sent += (met[i].front ? s.front : s.back) * w;
    layer->metal += s.metal * w;
    layer->metallic += w * s.metallic;
    layer->roughness += w * s.roughness;
    layer->radius += w * s.radius;
    if (met[i].front) layer->emission += s.emission * w;
  }
  const float share = 1 / total;
  layer->distance *= share;
  layer->normal = normalize(layer->normal);
  layer->sent *= share;
  layer->emission *= share;
  layer->metal *= share;
  layer->metallic *= share;
  layer->roughness *= share;
  layer->radius *= share;
  layer->place = origin + direction * layer->distance;
  return true;
}

Rgb SurfelGrid::reflected(const Layer& layer, const Vec3& direction, int bounce) const {
  const int count = bounce == 0 ? kReflections : 1;
  const Vec3 start = layer.place + layer.normal * (kOwn * layer.radius);
  Rgb sum;
  for (int i = 0; i < count; ++i) {
    constexpr float kGoldenAngle = 2.3999632f;
    const auto number = static_cast<float>(i);
    const float u = (number + 0.5f) / static_cast<float>(kReflections);
    Vec3 way = mirrored(direction, half_vector(layer.normal, layer.roughness, count == 1 ? 0 : u,
                                               number * kGoldenAngle));
    if (dot(way, layer.normal) <= 0) way = mirrored(direction, layer.normal);
    const Sight sight = look(start, way, bounce + 1);
    sum += sight.hit ? sight.radiance : ambient_;
  }
  return layer.metal * sum * (1 / static_cast<float>(count));
}

Sight SurfelGrid::look(const Vec3& origin, const Vec3& direction, int bounce) const {
  constexpr float kLeastMetal = 0.02f;
  Layer layer;
  if (!meet(origin, direction, &layer)) return {};
  Sight sight{layer.sent, layer.distance, layer.metallic, -dot(direction, layer.normal), true};
  if (total_ || bounce > 0) sight.radiance += layer.emission;
  if (layer.metallic > kLeastMetal)
    sight.radiance +=
        bounce < kBounces ? reflected(layer, direction, bounce) : layer.metal * ambient_;
  return sight;
}

}  // namespace lte::nn
