#include "lte/radiosity/point_radiosity.h"

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"

namespace lte::radiosity {
namespace {

/// Points in struct-of-arrays form that Points borrows.
struct Set {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo, emission;
  std::vector<float> area;
  std::vector<int32_t> group;

  void add(const Vec3& p, const Vec3& n, float albedo_value, const Rgb& light, float a,
           int32_t light_group) {
    position.push_back(p);
    normal.push_back(n);
    albedo.push_back({albedo_value, albedo_value, albedo_value});
    emission.push_back(light);
    area.push_back(a);
    group.push_back(light_group);
  }
  Points points() const { return {position, normal, albedo, emission, area, group}; }
};

/// A unit vector, the i-th of `count` that are spread evenly (a Fibonacci sphere).
Vec3 on_sphere(int i, int count) {
  const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z),
               angle = 2.399963229728653 * i;
  return {static_cast<float>(r * std::cos(angle)), static_cast<float>(z),
          static_cast<float>(r * std::sin(angle))};
}

/// An integrating sphere of radius 1 seen from inside: every patch sends every other the same
/// irradiance, radiosity · area / 4π, wherever the two lie.
Set integrating_sphere(int count, float albedo, int luminaires) {
  Set set;
  const float area = 4 * kPi / static_cast<float>(count);
  for (int i = 0; i < count; ++i) {
    const Vec3 p = on_sphere(i, count);
    const bool shines = i < luminaires;
    set.add(p, -p, albedo, shines ? Rgb{1, 2, 4} : Rgb{}, area, shines ? i % 2 : -1);
  }
  return set;
}

double mean_green(const std::vector<Rgb>& light, size_t first, size_t count) {
  double sum = 0;
  for (size_t i = first; i < first + count; ++i) sum += light[i].y;
  return sum / static_cast<double>(count);
}

TEST(PointRadiosity, AnIntegratingSphereHasItsClosedForm) {
  constexpr int kCount = 6000, kLuminaires = 60;
  constexpr float kAlbedo = 0.5f;
  const Set set = integrating_sphere(kCount, kAlbedo, kLuminaires);
  const PointIrradiance light = solve(set.points(), 2, {.senders = 1200, .bounces = 4});
  const double share = static_cast<double>(kLuminaires) / kCount;
  const double direct = M_PI * 2 * share / 2;  // of each group in green
  double indirect = 0, power = 1;
  for (int bounce = 0; bounce < 4; ++bounce) {
    power *= kAlbedo * (1 - share);
    indirect += direct * power;
  }
  for (size_t group = 0; group < 2; ++group) {
    const size_t first = group * kCount + kLuminaires, rest = kCount - kLuminaires;
    EXPECT_NEAR(mean_green(light.direct, first, rest), direct, 0.06 * direct);
    // Links that graze the curved shell meet its cells, so some light of each bounce is lost.
    EXPECT_NEAR(mean_green(light.indirect, first, rest), indirect, 0.18 * indirect);
    EXPECT_EQ(mean_green(light.direct_back, first, rest), 0) << "outside";
    EXPECT_EQ(mean_green(light.indirect_back, first, rest), 0) << "outside";
    EXPECT_EQ(mean_green(light.direct, group * kCount, kLuminaires), 0) << "luminaires";
  }
}

// One bounce in a sphere lights all of it alike, by albedo · flux / 4π, wherever the flux arrives:
// here on a hundredth of it.
TEST(PointRadiosity, FewSendersFindASpotOfLight) {
  constexpr int kCount = 6000;
  constexpr float kAlbedo = 0.5f;
  Set set = integrating_sphere(kCount, kAlbedo, 0);
  set.add({0, 0.9f, 0}, {0, 1, 0}, 0, {100, 100, 100}, 1e-3f, 0);
  const PointIrradiance light = solve(set.points(), 1, {.senders = 64, .bounces = 1});
  const double flux = mean_green(light.direct, 0, kCount) * 4 * M_PI;
  EXPECT_NEAR(flux, 0.1 * M_PI, 0.2 * 0.1 * M_PI) << "emission · area · π";
  const double expected = kAlbedo * flux / (4 * M_PI);
  EXPECT_NEAR(mean_green(light.indirect, 0, kCount), expected, 0.18 * expected);
}

TEST(PointRadiosity, IsLinearInTheEmissionOfEachGroup) {
  Set set = integrating_sphere(600, 0.7f, 12);
  const PointIrradiance once = solve(set.points(), 2);
  for (size_t i = 0; i < set.emission.size(); ++i) {
    if (set.group[i] == 1) set.emission[i] *= 4;
  }
  const PointIrradiance gained = solve(set.points(), 2);
  for (size_t i = 0; i < 600; ++i) {
    EXPECT_EQ(gained.indirect[i], once.indirect[i]);
    EXPECT_EQ(gained.indirect[600 + i], once.indirect[600 + i] * 4);
  }
}

/// A floor and a board above it.
Set floor_and_board(bool board) {
  Set set;
  constexpr int kSide = 40;
  const auto grid = [&](float height, float half, const Vec3& normal, float albedo) {
    const float step = 2 * half / kSide;
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; j < kSide; ++j) {
        set.add({-half + step * (static_cast<float>(i) + 0.5f), height,
                 -half + step * (static_cast<float>(j) + 0.5f)},
                normal, albedo, {}, step * step, -1);
      }
    }
  };
  grid(0, 1, {0, 1, 0}, 0.5f);
  if (board) grid(0.5f, 0.3f, {0, 1, 0}, 0.5f);
  return set;
}

/// A floor and a lamp above it, with a board between the two.
Set lamp_over_board(bool board) {
  Set set = floor_and_board(board);
  set.add({0, 1, 0}, {0, -1, 0}, 0, {100, 100, 100}, 1e-4f, 0);
  return set;
}

TEST(PointRadiosity, DirectLightOfASmallLampIsThatOfTheInverseSquare) {
  const Set set = lamp_over_board(false);
  const PointIrradiance light = solve(set.points(), 1);
  for (size_t i = 0; i < set.position.size() - 1; ++i) {
    const Vec3 d = set.position.back() - set.position[i];
    const float cosine = d.y / length(d);
    EXPECT_NEAR(light.direct[i].x, 100 * 1e-4f * cosine * cosine / dot(d, d), 1e-5f);
  }
}

/// A panel of 10 cm that shines downwards and half as much upwards: its 800 points lie in few cells
/// of the grid, so they share their marches, and each weighs little by itself.
TEST(PointRadiosity, PointsOfALampInOneCellEachLightAsTheyFace) {
  Set set = floor_and_board(false);
  set.add({0.9f, 3.2f, 0.9f}, {0, -1, 0}, 0.5f, {}, 1e-4f, -1);  // the grid reaches up to it
  constexpr int kSide = 20;
  constexpr float kStep = 0.1f / kSide, kHeight = 3;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const Vec3 p{kStep * (static_cast<float>(i) + 0.5f) - 0.05f, kHeight,
                   kStep * (static_cast<float>(j) + 0.5f) - 0.05f};
      set.add(p, {0, -1, 0}, 0, {10, 10, 10}, kStep * kStep, 0);
      set.add(p, {0, 1, 0}, 0, {5, 5, 5}, kStep * kStep, 0);
    }
  }
  const PointIrradiance light = solve(set.points(), 1);
  for (size_t i = 0; i < 1600; ++i) {
    const Vec3 d = Vec3{0, kHeight, 0} - set.position[i];
    const float cosine = d.y / length(d);
    const float expected = 10 * 0.01f * cosine * cosine / dot(d, d);
    EXPECT_NEAR(light.direct[i].x, expected, 0.01f * expected) << "point " << i;
  }
  const Vec3 up = set.position[1600] - Vec3{0, kHeight, 0};
  const float above = up.y / length(up), expected = 5 * 0.01f * above * above / dot(up, up);
  EXPECT_NEAR(light.direct[1600].x, expected, 0.02f * expected);
}

TEST(PointRadiosity, ABoardShadesTheFloorAndIsLitOnOneSide) {
  const Set set = lamp_over_board(true);
  const PointIrradiance light = solve(set.points(), 1);
  const auto at = [&](float x, float y, float z) {
    size_t best = 0;
    for (size_t i = 0; i < set.position.size(); ++i) {
      if (length(set.position[i] - Vec3{x, y, z}) < length(set.position[best] - Vec3{x, y, z}))
        best = i;
    }
    return best;
  };
  EXPECT_EQ(light.direct[at(0, 0, 0)].x, 0) << "in the shade";
  EXPECT_GT(light.direct[at(0.9f, 0, 0.9f)].x, 1e-3f) << "beside it";
  EXPECT_GT(light.direct[at(0.1f, 0.5f, 0.1f)].x, 1e-2f) << "its upper side";
  EXPECT_EQ(light.direct_back[at(0.1f, 0.5f, 0.1f)].x, 0) << "its lower side";
  EXPECT_GT(light.indirect_back[at(0, 0.5f, 0)].x, 0) << "the floor lights it from below";
}

TEST(PointRadiosity, AnswersAreTheSameForAnyNumberOfThreads) {
  const Set set = integrating_sphere(500, 0.7f, 10);
  set_num_threads(1);
  const PointIrradiance one = solve(set.points(), 2);
  set_num_threads(2);
  const PointIrradiance two = solve(set.points(), 2);
  set_num_threads(0);
  EXPECT_EQ(one.direct, two.direct);
  EXPECT_EQ(one.indirect, two.indirect);
}

TEST(PointRadiosity, PointsInOnePlaceWithoutAreaAreFinite) {
  Set set;
  for (int i = 0; i < 8; ++i) {
    const bool shines = i == 0;
    set.add({1, 1, 1}, {0, 1, 0}, 0.5f, shines ? Rgb{1, 1, 1} : Rgb{}, 0, shines ? 0 : -1);
  }
  const PointIrradiance light = solve(set.points(), 1);
  for (const Rgb& irradiance : light.indirect) EXPECT_TRUE(is_finite(irradiance));
  EXPECT_TRUE(solve({}, 0).direct.empty());
}

TEST(PointRadiosity, RefusesArraysAndGroupsThatDoNotFit) {
  Set set = integrating_sphere(20, 0.5f, 2);
  EXPECT_THROW(solve(set.points(), 1), Error);
  set.area.pop_back();
  EXPECT_THROW(solve(set.points(), 2), Error);
}

/// Direct irradiance at a point from a square of edge 1 and radiance 1 that lies parallel to it at
/// distance 1, its middle above the point: π times four times the form factor of a quarter.
double under_a_square() {
  const double x = 0.5, a = x / std::sqrt(1 + x * x);
  return 4 * a * std::atan(a);
}

TEST(PointRadiosity, ASheetThatShinesFromBothSidesLightsFloorAndCeilingAlike) {
  Set set;
  constexpr int kEdge = 24;
  for (int i = 0; i < kEdge * kEdge; ++i) {
    const Vec3 p{(static_cast<float>(i % kEdge) + 0.5f) / kEdge - 0.5f, 0,
                 (static_cast<float>(i / kEdge) + 0.5f) / kEdge - 0.5f};
    for (const float up : {-1.0f, 1.0f})
      set.add(p, {0, up, 0}, 0, {1, 2, 4}, 1.0f / (kEdge * kEdge), 0);
  }
  const size_t floor = set.position.size();
  set.add({0, -1, 0}, {0, 1, 0}, 0.5f, {}, 0.01f, -1);
  set.add({0, 1, 0}, {0, -1, 0}, 0.5f, {}, 0.01f, -1);
  const PointIrradiance light = solve(set.points(), 1);
  for (const size_t i : {floor, floor + 1}) {
    EXPECT_NEAR(light.direct[i].x, under_a_square(), 0.01 * under_a_square());
    EXPECT_NEAR(light.direct[i].z, 4 * under_a_square(), 0.04 * under_a_square());
    EXPECT_EQ(light.direct_back[i].y, 0);
  }
}

TEST(PointRadiosity, LightThatNoPointStandsForIsReflectedToo) {
  // An integrating sphere whose luminaires are dark, given what they send.
  constexpr int kCount = 3000, kLuminaires = 30;
  const Set lit = integrating_sphere(kCount, 0.5f, kLuminaires);
  const PointIrradiance solved = solve(lit.points(), 2);
  Set dark = lit;
  dark.emission.assign(kCount, {});
  Points points = dark.points();
  points.direct = solved.direct;
  points.direct_back = solved.direct_back;
  const PointIrradiance given = solve(points, 2);
  EXPECT_EQ(given.direct[kLuminaires + 7], solved.direct[kLuminaires + 7]);
  const double whole = mean_green(solved.indirect, kLuminaires, kCount - kLuminaires);
  EXPECT_NEAR(mean_green(given.indirect, kLuminaires, kCount - kLuminaires), whole, 0.02 * whole);
  // Both together are twice the light.
  points = lit.points();
  points.direct = solved.direct;
  points.direct_back = solved.direct_back;
  const PointIrradiance both = solve(points, 2);
  EXPECT_NEAR(mean_green(both.indirect, kLuminaires, kCount - kLuminaires), 2 * whole,
              0.02 * whole);
  points.direct = points.direct.first(10);
  EXPECT_THROW(solve(points, 2), Error);
}

}  // namespace
}  // namespace lte::radiosity
