// Surfaces of revolution, tubes, and the curves that they follow.
#include <algorithm>
#include <cmath>

#include "datagen/homes/mesh/mesh_parts.h"

namespace lte::datagen::homes {
namespace {

template <typename V>
V blend(const V& a, float wa, const V& b, float wb);
template <>
Vec3 blend(const Vec3& a, float wa, const Vec3& b, float wb) {
  return a * wa + b * wb;
}
template <>
Vec2 blend(const Vec2& a, float wa, const Vec2& b, float wb) {
  return {a.x * wa + b.x * wb, a.y * wa + b.y * wb};
}

template <typename V>
std::vector<V> catmull_rom(const std::vector<V>& points, int steps) {
  if (points.size() < 3 || steps < 2) return points;
  std::vector<V> out;
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const V &p0 = points[i > 0 ? i - 1 : 0], &p1 = points[i], &p2 = points[i + 1],
            &p3 = points[std::min(i + 2, points.size() - 1)];
    for (int k = 0; k < steps; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(steps), t2 = t * t, t3 = t2 * t;
      const V a = blend(p0, 0.5f * (-t3 + 2 * t2 - t), p1, 0.5f * (3 * t3 - 5 * t2 + 2));
      const V b = blend(p2, 0.5f * (-3 * t3 + 4 * t2 + t), p3, 0.5f * (t3 - t2));
      out.push_back(blend(a, 1, b, 1));
    }
  }
  out.push_back(points.back());
  return out;
}

float distance(const Vec2& a, const Vec2& b) { return std::hypot(a.x - b.x, a.y - b.y); }

}  // namespace

std::vector<Vec2> smooth(const std::vector<Vec2>& points, int steps) {
  std::vector<Vec2> out = catmull_rom(points, steps);
  if (out.size() == points.size()) return out;
  for (size_t i = 0; i < out.size(); ++i) {  // no overshoot, so feet stay on the floor
    const size_t span = i / static_cast<size_t>(steps);
    const Vec2 &a = points[span], &b = points[std::min(span + 1, points.size() - 1)];
    out[i] = {std::clamp(out[i].x, std::min(a.x, b.x), std::max(a.x, b.x)),
              std::clamp(out[i].y, std::min(a.y, b.y), std::max(a.y, b.y))};
  }
  return out;
}

std::vector<Vec3> smooth(const std::vector<Vec3>& points, int steps) {
  return catmull_rom(points, steps);
}

Mesh lathe(const std::vector<Vec2>& profile, int turn, bool ring) {
  Mesh mesh;
  std::vector<Vec2> rows = profile;
  if (ring) rows.push_back(profile.front());
  float along = 0, widest = 0;
  for (const Vec2& p : rows) widest = std::max(widest, p.x);
  for (size_t j = 0; j < rows.size(); ++j) {
    if (j > 0) along += distance(rows[j - 1], rows[j]);
    for (int i = 0; i <= turn; ++i) {
      const double phi = 2 * M_PI * (i % turn) / turn;
      mesh.positions.push_back({rows[j].x * static_cast<float>(std::cos(phi)), rows[j].y,
                                rows[j].x * static_cast<float>(std::sin(phi))});
      mesh.uvs[0].push_back(
          {2 * kPi * widest * static_cast<float>(i) / static_cast<float>(turn), along});
    }
  }
  const auto stride = static_cast<uint32_t>(turn + 1);
  for (uint32_t j = 0; j + 1 < rows.size(); ++j) {
    for (uint32_t i = 0; i < static_cast<uint32_t>(turn); ++i) {
      const uint32_t a = j * stride + i, b = a + 1, c = b + stride, d = a + stride;
      if (rows[j].x > 0) mesh.triangles.push_back({a, c, b});
      if (rows[j + 1].x > 0) mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

Mesh sphere(float radius, int turn) {
  std::vector<Vec2> half{{0, -radius}};
  const int rows = turn / 2;
  for (int i = 1; i < rows; ++i) {
    const float t = kPi * (static_cast<float>(i) / static_cast<float>(rows) - 0.5f);
    half.push_back({radius * std::cos(t), radius * std::sin(t)});
  }
  half.push_back({0, radius});
  return lathe(half, turn);
}

Mesh tube(const std::vector<Vec3>& path, float radius, int turn) {
  Mesh mesh;
  Vec3 side, other;
  make_frame(normalize(path[1] - path[0]), &side, &other);
  float along = 0;
  const size_t n = path.size();
  for (size_t j = 0; j < n; ++j) {
    const Vec3 forward = normalize(path[std::min(j + 1, n - 1)] - path[j > 0 ? j - 1 : 0]);
    side = normalize(side - forward * dot(side, forward));  // carried along without twist
    other = cross(forward, side);
    if (j > 0) along += length(path[j] - path[j - 1]);
    for (int i = 0; i <= turn; ++i) {
      const double phi = 2 * M_PI * (i % turn) / turn;
      mesh.positions.push_back(path[j] + side * (radius * static_cast<float>(std::cos(phi))) +
                               other * (radius * static_cast<float>(std::sin(phi))));
      mesh.uvs[0].push_back(
          {along, 2 * kPi * radius * static_cast<float>(i) / static_cast<float>(turn)});
    }
  }
  const auto stride = static_cast<uint32_t>(turn + 1);
  for (uint32_t j = 0; j + 1 < n; ++j) {
    for (uint32_t i = 0; i + 1 < stride; ++i) {
      const uint32_t a = j * stride + i, b = a + 1, c = b + stride, d = a + stride;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  for (const bool end : {false, true}) {
    const auto centre = static_cast<uint32_t>(mesh.positions.size());
    const uint32_t first = end ? static_cast<uint32_t>(n - 1) * stride : 0;
    mesh.positions.push_back(end ? path.back() : path.front());
    mesh.uvs[0].push_back(mesh.uvs[0][first]);
    for (uint32_t i = first; i + 1 < first + stride; ++i) {
      if (end) {
        mesh.triangles.push_back({centre, i, i + 1});
      } else {
        mesh.triangles.push_back({centre, i + 1, i});
      }
    }
  }
  return mesh;
}

}  // namespace lte::datagen::homes
