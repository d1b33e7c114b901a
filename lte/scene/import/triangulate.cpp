#include "lte/scene/import/triangulate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lte::scene {
namespace {

/// Point-in-triangle tests that one polygon may take, at most a tenth of a second: clipping takes
/// quadratic time, or worse where somebody wants it to.
constexpr int64_t kSteps = int64_t{1} << 24;

struct Point2 {
  double x = 0, y = 0;
  friend bool operator==(const Point2&, const Point2&) = default;
};

/// Twice the signed area of a triangle.
double doubled_area(const Point2& a, const Point2& b, const Point2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Newell's normal: twice the area of the outline seen along each axis, about the first corner, so
/// that far-off polygons keep their digits.
std::array<double, 3> newell(const std::vector<Vec3>& positions,
                             const std::vector<uint32_t>& corners) {
  std::array<double, 3> normal{};
  const Vec3& origin = positions[corners[0]];
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3 &p = positions[corners[i]], &q = positions[corners[(i + 1) % corners.size()]];
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      normal[static_cast<size_t>(axis)] +=
          (double{p[u]} - q[u]) * (double{p[v]} + q[v] - 2 * double{origin[v]});
    }
  }
  return normal;
}

/// The corners seen along the largest axis of the normal, counter-clockwise.
std::vector<Point2> project(const std::vector<Vec3>& positions,
                            const std::vector<uint32_t>& corners) {
  const std::array<double, 3> normal = newell(positions, corners);
  const auto largest = std::max_element(
      normal.begin(), normal.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  const int axis = static_cast<int>(largest - normal.begin());
  const double sign = *largest < 0 ? -1 : 1;
  const Vec3& origin = positions[corners[0]];
  std::vector<Point2> out;
  out.reserve(corners.size());
  for (const uint32_t corner : corners) {
    const Vec3& p = positions[corner];
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    out.push_back({sign * (double{p[u]} - origin[u]), double{p[v]} - origin[v]});
  }
  return out;
}

/// Ear clipping over a ring of corners that are left.
class EarClipper {
 public:
  explicit EarClipper(const std::vector<Point2>& points) : points_(points) {
    for (size_t i = 0; i < points.size(); ++i) ring_.push_back(i);
  }

  template <typename Emit>
  void run(const Emit& emit) {
    size_t at = 0;
    while (ring_.size() > 3 && steps_ > 0) {
      at = find_ear(at % ring_.size());
      emit(ring_[before(at)], ring_[at], ring_[after(at)]);
      ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(at));
      if (at > 0) --at;  // the corner before may have become an ear
    }
    for (size_t i = 1; i + 1 < ring_.size(); ++i) emit(ring_[0], ring_[i], ring_[i + 1]);
  }

  /// Whether every corner turns left and the outline goes round once, so that a fan will do.
  bool convex() const {
    double turns = 0;
    for (size_t i = 0; i < ring_.size(); ++i) {
      const Point2 &a = points_[ring_[before(i)]], &b = points_[ring_[i]],
                   &c = points_[ring_[after(i)]];
      const double area = doubled_area(a, b, c);
      if (area < 0) return false;
      turns += std::atan2(area, (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y));
    }
    return turns < 3 * M_PI;
  }

 private:
  size_t before(size_t i) const { return i == 0 ? ring_.size() - 1 : i - 1; }
  size_t after(size_t i) const { return i + 1 == ring_.size() ? 0 : i + 1; }

  /// The first ear from `start` on. An outline that crosses itself may have none left: then a
  /// corner that at least is convex, else any.
  size_t find_ear(size_t start) {
    size_t convex_corner = start;
    bool found_convex = false;
    for (size_t k = 0; k < ring_.size() && steps_ > 0; ++k) {
      const size_t i = (start + k) % ring_.size();
      const double area =
          doubled_area(points_[ring_[before(i)]], points_[ring_[i]], points_[ring_[after(i)]]);
      if (!(area > 0)) continue;
      if (!holds_another(i)) return i;
      if (!found_convex) convex_corner = i;
      found_convex = true;
    }
    return convex_corner;
  }

  /// Whether another corner lies in the triangle at i. Corners that lie on its own corners do not
  /// count: outlines with a hole pass their bridge twice.
  bool holds_another(size_t i) {
    const Point2 &a = points_[ring_[before(i)]], &b = points_[ring_[i]],
                 &c = points_[ring_[after(i)]];
    steps_ -= static_cast<int64_t>(ring_.size());
    return std::any_of(ring_.begin(), ring_.end(), [&](size_t other) {
      const Point2& p = points_[other];
      return doubled_area(a, b, p) >= 0 && doubled_area(b, c, p) >= 0 &&
             doubled_area(c, a, p) >= 0 && !(p == a) && !(p == b) && !(p == c);
    });
  }

  const std::vector<Point2>& points_;
  std::vector<size_t> ring_;
  int64_t steps_ = kSteps;
};

}  // namespace

void triangulate_polygon(const std::vector<Vec3>& positions, const std::vector<uint32_t>& corners,
                         std::vector<std::array<uint32_t, 3>>* out) {
  if (corners.size() == 3) {
    out->push_back({corners[0], corners[1], corners[2]});
    return;
  }
  const std::vector<Point2> points = project(positions, corners);
  EarClipper clipper(points);
  if (clipper.convex()) {
    for (size_t i = 1; i + 1 < corners.size(); ++i)
      out->push_back({corners[0], corners[i], corners[i + 1]});
    return;
  }
  clipper.run([&](size_t a, size_t b, size_t c) {
    out->push_back({corners[a], corners[b], corners[c]});
  });
}

}  // namespace lte::scene
