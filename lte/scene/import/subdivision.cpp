#include "lte/scene/import/subdivision.h"

#include <algorithm>

#include "lte/base/check.h"

namespace lte::scene {
namespace {

constexpr uint32_t kUnset = 0xffffffff;

struct Point {
  double x = 0, y = 0, z = 0;
  Point& operator+=(const Point& b) { return *this = {x + b.x, y + b.y, z + b.z}; }
};
Point operator*(double s, const Point& p) { return {s * p.x, s * p.y, s * p.z}; }
Point operator+(Point a, const Point& b) { return a += b; }

/// An edge with the corners across it; one of them is kUnset on a boundary.
struct Edge {
  uint32_t a, b;  ///< a < b
  std::array<uint32_t, 2> across{kUnset, kUnset};
  bool is_boundary() const { return across[1] == kUnset; }
};

class Level {
 public:
  Level(std::vector<Point> points, std::vector<std::array<uint32_t, 3>> triangles,
        const std::string& where)
      : points_(std::move(points)), triangles_(std::move(triangles)) {
    find_edges(where);
    sum_rings(where);
  }

  /// Four triangles for each, and the rules for old (even) and new (odd) vertices.
  Level refined(const std::string& where) const {
    std::vector<Point> points(points_.size() + edges_.size());
    for (size_t i = 0; i < points_.size(); ++i) points[i] = smoothed(i, even_weight(i), 1.0 / 8);
    for (size_t i = 0; i < edges_.size(); ++i) {
      const Edge& e = edges_[i];
      const Point ends = points_[e.a] + points_[e.b];
      points[points_.size() + i] =
          e.is_boundary() ? 0.5 * ends
                          : 0.375 * ends + 0.125 * (points_[e.across[0]] + points_[e.across[1]]);
    }
    std::vector<std::array<uint32_t, 3>> triangles;
    triangles.reserve(triangles_.size() * 4);
    const auto first_odd = static_cast<uint32_t>(points_.size());
    for (size_t i = 0; i < triangles_.size(); ++i) {
      const auto& [a, b, c] = triangles_[i];
      const uint32_t ab = first_odd + sides_[i][0], bc = first_odd + sides_[i][1],
                     ca = first_odd + sides_[i][2];
      triangles.insert(triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    return {std::move(points), std::move(triangles), where};
  }

  TriangleMesh limit() const {
    TriangleMesh out;
    out.triangles = triangles_;
    for (size_t i = 0; i < points_.size(); ++i) {
      const double n = valence_[i];
      const double weight = valence_[i] > 0 ? 1 / (n + 3 / (8 * even_weight(i))) : 0;
      const Point p = smoothed(i, weight, 1.0 / 5);
      out.positions.push_back(
          {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    }
    return out;
  }

 private:
  /// Warren's weight of a neighbour.
  double even_weight(size_t i) const {
    return valence_[i] == 3 ? 3.0 / 16 : 3.0 / (8.0 * valence_[i]);
  }

  /// A vertex averaged with its ring: all of it inside, the two neighbours along it on a boundary.
  Point smoothed(size_t i, double inner_weight, double boundary_weight) const {
    const bool boundary = boundary_valence_[i] > 0;
    const double weight = boundary ? boundary_weight : inner_weight;
    const double n = boundary ? 2 : valence_[i];
    return (1 - n * weight) * points_[i] + weight * (boundary ? boundary_ring_ : ring_)[i];
  }

  void find_edges(const std::string& where) {
    struct Side {
      uint32_t a, b, triangle, corner;
    };
    std::vector<Side> sides;
    sides.reserve(triangles_.size() * 3);
    for (uint32_t t = 0; t < triangles_.size(); ++t) {
      for (uint32_t k = 0; k < 3; ++k) {
        const uint32_t a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
        sides.push_back({std::min(a, b), std::max(a, b), t, k});
      }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& p, const Side& q) {
      return std::array{p.a, p.b, p.triangle, p.corner} <
             std::array{q.a, q.b, q.triangle, q.corner};
    });
    sides_.resize(triangles_.size());
    for (const Side& side : sides) {
      const bool seen = !edges_.empty() && edges_.back().a == side.a && edges_.back().b == side.b;
      if (!seen) edges_.push_back({side.a, side.b});
      Edge& edge = edges_.back();
      LTE_CHECK(edge.across[1] == kUnset && side.a != side.b, where, ": the edge between vertices ",
                side.a, " and ", side.b,
                side.a == side.b ? " has no length" : " has more than two triangles");
      edge.across[edge.across[0] == kUnset ? 0 : 1] =
          triangles_[side.triangle][(side.corner + 2) % 3];
      sides_[side.triangle][side.corner] = static_cast<uint32_t>(edges_.size() - 1);
    }
  }

  void sum_rings(const std::string& where) {
    ring_.resize(points_.size());
    boundary_ring_.resize(points_.size());
    valence_.resize(points_.size());
    boundary_valence_.resize(points_.size());
    for (const Edge& edge : edges_) {
      for (const auto& [from, to] : {std::pair{edge.a, edge.b}, std::pair{edge.b, edge.a}}) {
        ring_[from] += points_[to];
        ++valence_[from];
        if (!edge.is_boundary()) continue;
        boundary_ring_[from] += points_[to];
        ++boundary_valence_[from];
      }
    }
    for (size_t i = 0; i < points_.size(); ++i) {
      LTE_CHECK(boundary_valence_[i] == 0 || boundary_valence_[i] == 2, where, ": vertex ", i,
                " lies on more than one boundary of the mesh");
    }
  }

  std::vector<Point> points_;
  std::vector<std::array<uint32_t, 3>> triangles_;
  std::vector<Edge> edges_;
  std::vector<std::array<uint32_t, 3>> sides_;  ///< edges of each triangle
  std::vector<Point> ring_, boundary_ring_;     ///< sums over neighbours
  std::vector<int> valence_, boundary_valence_;
};

}  // namespace

TriangleMesh loop_subdivide(const TriangleMesh& control, int levels, const std::string& where) {
  std::vector<uint32_t> number(control.positions.size(), kUnset);
  std::vector<Point> points;
  std::vector<std::array<uint32_t, 3>> triangles = control.triangles;
  for (std::array<uint32_t, 3>& triangle : triangles) {
    for (uint32_t& corner : triangle) {
      if (number[corner] == kUnset) {
        number[corner] = static_cast<uint32_t>(points.size());
        const Vec3& p = control.positions[corner];
        points.push_back({p.x, p.y, p.z});
      }
      corner = number[corner];
    }
  }
  Level level(std::move(points), std::move(triangles), where);
  for (int i = 0; i < levels; ++i) level = level.refined(where);
  return level.limit();
}

}  // namespace lte::scene
