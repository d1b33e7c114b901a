// Interpolation between probes, against sums written out by hand.
#include "infer/eval/rivals/probes.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "lte/base/random.h"

namespace lte::infer {
namespace {

struct Points {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo, value;
  QueryPoints queries() const { return {position, normal, albedo}; }
  void add(const Vec3& p, const Vec3& n, const Rgb& v) {
    position.push_back(p);
    normal.push_back(n);
    albedo.push_back({1, 1, 1});
    value.push_back(v);
  }
};

constexpr Vec3 kUp{0, 1, 0}, kSide{1, 0, 0};

TEST(ProbeField, WeighsByInverseSquaredDistanceAmongThoseThatFaceAlike) {
  Points probes;
  probes.add({0, 0, 0}, kUp, {1, 0, 0});
  probes.add({3, 0, 0}, kUp, {4, 0, 0});
  probes.add({1, 0.1f, 0}, kSide, {100, 0, 0});  // at a right angle, close by
  Points at;
  at.add({1, 0, 0}, kUp, {});
  const std::vector<Rgb> found =
      ProbeField(probes.queries(), probes.value, 10).interpolate(at.queries());
  // Weights 1 and 1/4, softened by (3 mm)².
  const double near = 1 / (1 + 9e-6), far = 1 / (4 + 9e-6);
  EXPECT_NEAR(found[0].x, (1 * near + 4 * far) / (near + far), 1e-5);
}

TEST(ProbeField, TakesTheNearestWhereNoneFacesAlike) {
  Points probes;
  probes.add({0, 0, 0}, kUp, {1, 2, 3});
  probes.add({3, 0, 0}, kUp, {4, 5, 6});
  Points at;
  at.add({2, 0, 0}, {0, -1, 0}, {});
  const ProbeField field(probes.queries(), probes.value, 10);
  EXPECT_EQ(field.interpolate(at.queries())[0], (Rgb{4, 5, 6}));
}

TEST(ProbeField, NeverReadsTheProbeAtTheQueriedPlace) {
  Points probes;
  probes.add({0, 0, 0}, kUp, {1, 1, 1});
  probes.add({1, 0, 0}, kUp, {9, 9, 9});
  const ProbeField field(probes.queries(), probes.value, 10);
  const std::vector<Rgb> found = field.interpolate(probes.queries());
  EXPECT_EQ(found[0], (Rgb{9, 9, 9}));
  EXPECT_EQ(found[1], (Rgb{1, 1, 1}));
  EXPECT_EQ(ProbeField(probes.queries(), probes.value, 1).interpolate(probes.queries())[0], Rgb{})
      << "there is no other";
  EXPECT_EQ(ProbeField(probes.queries(), probes.value, 0).size(), 0);
}

TEST(ProbeField, MatchesSortingAllProbesByDistance) {
  Rng rng(2);
  Points probes, at;
  const auto random = [&] { return Vec3{rng.uniform(), rng.uniform(), rng.uniform()}; };
  for (int i = 0; i < 300; ++i)
    probes.add(random(), normalize(random() - Vec3{0.5f, 0.5f, 0.5f}), random());
  for (int i = 0; i < 50; ++i) at.add(random(), normalize(random() - Vec3{0.5f, 0.5f, 0.5f}), {});
  const std::vector<Rgb> found =
      ProbeField(probes.queries(), probes.value, 300).interpolate(at.queries());
  for (size_t i = 0; i < 50; ++i) {
    std::vector<std::pair<double, size_t>> order;
    for (size_t k = 0; k < 300; ++k) {
      const Vec3 d = at.position[i] - probes.position[k];
      if (dot(at.normal[i], probes.normal[k]) > 0) order.emplace_back(dot(d, d), k);
    }
    std::sort(order.begin(), order.end());
    double sum = 0, weights = 0;
    for (size_t j = 0; j < 8; ++j) {
      const double weight =
          dot(at.normal[i], probes.normal[order[j].second]) / (order[j].first + 1e-6);
      sum += weight * probes.value[order[j].second].y;
      weights += weight;
    }
    EXPECT_NEAR(found[i].y, sum / weights, 1e-3);
  }
}

}  // namespace
}  // namespace lte::infer
