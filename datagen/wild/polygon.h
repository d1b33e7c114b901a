// Convex polygons in plan: (x, z) of the world as (x, y).
#pragma once

#include <vector>

#include "lte/base/math.h"

namespace lte::datagen::wild {

inline Vec2 operator+(const Vec2& a, const Vec2& b) { return {a.x + b.x, a.y + b.y}; }
inline Vec2 operator-(const Vec2& a, const Vec2& b) { return {a.x - b.x, a.y - b.y}; }
inline Vec2 operator*(const Vec2& a, float s) { return {a.x * s, a.y * s}; }
inline float dot(const Vec2& a, const Vec2& b) { return a.x * b.x + a.y * b.y; }
inline float length(const Vec2& a) { return std::hypot(a.x, a.y); }
/// A quarter turn to the left: from the direction of an edge to the inside.
inline Vec2 left_of(const Vec2& a) { return {-a.y, a.x}; }
inline Vec3 in_space(const Vec2& p, float y) { return {p.x, y, p.y}; }

/// Counter-clockwise in (x, z), so that the inside lies to the left of every edge.
using Polygon = std::vector<Vec2>;

/// Edge i, from corner i to the next.
struct Edge {
  Vec2 from, to, along, inward;  ///< `along` and `inward` are unit
  float length = 0;

  Vec2 at(float u) const { return from + along * u; }
};
Edge edge_of(const Polygon& polygon, size_t index);

float area_of(const Polygon& polygon);
/// Mean of the corners.
Vec2 centre_of(const Polygon& polygon);
/// Whether `p` is inside and at least `margin` metres from every edge.
bool inside(const Polygon& polygon, const Vec2& p, float margin);
/// Whether a line separates the two with `gap` metres between; a negative gap allows an overlap.
bool apart(const Polygon& a, const Polygon& b, float gap);
/// The part with dot(p, along) in [low, high]; fewer than three corners if there is none.
Polygon band(const Polygon& polygon, const Vec2& along, float low, float high);

Polygon rectangle(float width, float depth);
/// Its first edge runs from the origin along x.
Polygon regular(int corners, float radius);

}  // namespace lte::datagen::wild
