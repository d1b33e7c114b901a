#include "datagen/wild/polygon.h"

#include <algorithm>

namespace lte::datagen::wild {
namespace {

/// The part with dot(p, normal) <= at.
Polygon half(const Polygon& polygon, const Vec2& normal, float at) {
  Polygon out;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const float a = dot(p, normal) - at, b = dot(q, normal) - at;
    if (a <= 0) out.push_back(p);
    if ((a < 0 && b > 0) || (a > 0 && b < 0)) out.push_back(p + (q - p) * (a / (a - b)));
  }
  return out;
}

bool separated(const Polygon& a, const Polygon& b, float gap) {
  for (size_t i = 0; i < a.size(); ++i) {
    const Edge edge = edge_of(a, i);
    float nearest = INFINITY;
    for (const Vec2& p : b) nearest = std::min(nearest, -dot(p - edge.from, edge.inward));
    if (nearest >= gap) return true;
  }
  return false;
}

}  // namespace

Edge edge_of(const Polygon& polygon, size_t index) {
  Edge edge;
  edge.from = polygon[index];
  edge.to = polygon[(index + 1) % polygon.size()];
  edge.length = length(edge.to - edge.from);
  edge.along = (edge.to - edge.from) * (1 / edge.length);
  edge.inward = left_of(edge.along);
  return edge;
}

float area_of(const Polygon& polygon) {
  float sum = 0;
  for (size_t i = 0; i < polygon.size(); ++i)
    sum += dot(polygon[i], left_of(polygon[(i + 1) % polygon.size()]) * -1.0f);
  return 0.5f * sum;
}

Vec2 centre_of(const Polygon& polygon) {
  Vec2 sum;
  for (const Vec2& p : polygon) sum = sum + p;
  return sum * (1 / static_cast<float>(polygon.size()));
}

bool inside(const Polygon& polygon, const Vec2& p, float margin) {
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Edge edge = edge_of(polygon, i);
    if (dot(p - edge.from, edge.inward) < margin) return false;
  }
  return true;
}

bool apart(const Polygon& a, const Polygon& b, float gap) {
  return separated(a, b, gap) || separated(b, a, gap);
}

Polygon band(const Polygon& polygon, const Vec2& along, float low, float high) {
  return half(half(polygon, along, high), along * -1.0f, -low);
}

Polygon rectangle(float width, float depth) {
  return {{0, 0}, {width, 0}, {width, depth}, {0, depth}};
}

Polygon regular(int corners, float radius) {
  const float step = 2 * kPi / static_cast<float>(corners), first = -kPi / 2 - step / 2;
  Polygon out;
  for (int i = 0; i < corners; ++i) {
    const float a = first + step * static_cast<float>(i);
    out.push_back({radius * std::cos(a), radius * std::sin(a)});
  }
  const Vec2 origin = out[0];
  for (Vec2& p : out) p = p - origin;
  return out;
}

}  // namespace lte::datagen::wild
