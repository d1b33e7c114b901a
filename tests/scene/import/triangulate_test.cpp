// Polygons to triangles: areas against the shoelace formula, and no corner lost.
#include "lte/scene/import/triangulate.h"

#include <cmath>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

namespace lte::scene {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

std::vector<uint32_t> ring(size_t n) {
  std::vector<uint32_t> out(n);
  std::iota(out.begin(), out.end(), 0u);
  return out;
}

Triangles split(const std::vector<Vec3>& polygon) {
  Triangles out;
  triangulate_polygon(polygon, ring(polygon.size()), &out);
  return out;
}

double signed_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 0.5 *
         ((double{b.x} - a.x) * (double{c.y} - a.y) - (double{b.y} - a.y) * (double{c.x} - a.x));
}

/// All triangles turn as the polygon does, and their areas add up to its own.
void expect_covers(const std::vector<Vec3>& polygon) {
  const Triangles triangles = split(polygon);
  ASSERT_EQ(triangles.size(), polygon.size() - 2);
  double shoelace = 0, sum = 0;
  for (size_t i = 1; i + 1 < polygon.size(); ++i)
    shoelace += signed_area(polygon[0], polygon[i], polygon[i + 1]);
  std::set<uint32_t> used;
  for (const auto& [a, b, c] : triangles) {
    const double area = signed_area(polygon[a], polygon[b], polygon[c]);
    EXPECT_GE(area * shoelace, -1e-9);
    sum += area;
    used.insert({a, b, c});
  }
  EXPECT_NEAR(sum, shoelace, 1e-6 * std::abs(shoelace));
  EXPECT_EQ(used.size(), polygon.size());
}

/// A comb with `teeth` teeth: nearly every corner is hidden from the others.
std::vector<Vec3> comb(int teeth) {
  std::vector<Vec3> out{{0, -1, 0}, {2.0f * static_cast<float>(teeth), -1, 0}};
  for (int i = teeth; i-- > 0;) {
    const float x = 2.0f * static_cast<float>(i);
    out.insert(out.end(), {{x + 2, 0, 0}, {x + 1.5f, 9, 0}, {x + 0.5f, 9, 0}});
  }
  out.push_back({0, 0, 0});
  return out;
}

TEST(Triangulate, CoversConcaveOutlinesOfEitherWinding) {
  std::vector<Vec3> star;
  for (int i = 0; i < 40; ++i) {
    const float radius = i % 2 == 0 ? 5.0f : 1.0f, angle = static_cast<float>(i) * kPi / 20;
    star.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
  }
  for (std::vector<Vec3> polygon : {star, comb(1), comb(7), comb(60)}) {
    expect_covers(polygon);
    std::reverse(polygon.begin(), polygon.end());
    expect_covers(polygon);
  }
}

TEST(Triangulate, CoversAnOutlineWithAHole) {
  // A square with a square hole, joined by a bridge that is passed twice.
  expect_covers({{0, 0, 0},
                 {4, 0, 0},
                 {4, 4, 0},
                 {0, 4, 0},
                 {0, 0, 0},
                 {1, 1, 0},
                 {1, 3, 0},
                 {3, 3, 0},
                 {3, 1, 0},
                 {1, 1, 0}});
}

TEST(Triangulate, CoversARightAngleWithCornersOnItsSides) {
  expect_covers(
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}});
}

TEST(Triangulate, FarFromTheOriginTooAndInAnyPlane) {
  std::vector<Vec3> polygon = comb(5);
  for (Vec3& p : polygon) p = Vec3{1e5f, -2e5f, 3e5f} + Vec3{p.y, 0.25f * p.y, p.x};
  const Triangles triangles = split(polygon);
  double sum = 0;
  for (const auto& [a, b, c] : triangles)
    sum += 0.5 * length(cross(polygon[b] - polygon[a], polygon[c] - polygon[a]));
  // 5 teeth of (2 + 1) / 2 * 9 each on a base of 10, stretched by the slope
  EXPECT_NEAR(sum, (5 * 13.5 + 10) * std::sqrt(1.0625), 0.05);
}

TEST(Triangulate, DegenerateOutlinesStillGiveTriangles) {
  EXPECT_EQ(split(std::vector<Vec3>(7)).size(), 5u);
  std::vector<Vec3> line;
  for (int i = 0; i < 9; ++i) line.push_back({static_cast<float>(i % 4), 0, 0});
  EXPECT_EQ(split(line).size(), 7u);
  EXPECT_EQ(split({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 2u) << "a bow tie";
}

TEST(Triangulate, HugeOutlinesEnd) {
  expect_covers(comb(300));
  const std::vector<Vec3> polygon = comb(20000);
  EXPECT_EQ(split(polygon).size(), polygon.size() - 2);
}

}  // namespace
}  // namespace lte::scene
