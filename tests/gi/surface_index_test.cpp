// The index against a search through all points by the same definition of closeness.
#include "lte/gi/surface_index.h"

#include <map>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"

namespace lte::gi {
namespace {

Vec3 random_unit(Rng* rng) {
  for (;;) {
    const Vec3 v{rng->uniform(-1, 1), rng->uniform(-1, 1), rng->uniform(-1, 1)};
    if (dot(v, v) > 0.01f && dot(v, v) < 1) return normalize(v);
  }
}

struct Points {
  std::vector<Vec3> position, normal;
  std::vector<float> radius;
};

/// Points of a ball's volume: every normal, many radii, and several in each other's way.
Points random_points(int count, uint64_t seed) {
  Rng rng(seed);
  Points out;
  for (int i = 0; i < count; ++i) {
    out.position.push_back(random_unit(&rng) * (0.7f * rng.uniform()));
    out.normal.push_back(random_unit(&rng));
    out.radius.push_back(rng.uniform(0.05f, 0.5f));
  }
  return out;
}

TEST(SurfaceIndex, FindsWhatASearchThroughAllPointsFinds) {
  const Points points = random_points(1500, 1);
  const SurfaceIndex index(points.position, points.normal, points.radius);
  Rng rng(2);
  int64_t found = 0;
  for (int query = 0; query < 400; ++query) {
    const Vec3 p = random_unit(&rng) * rng.uniform(0, 1.1f), n = random_unit(&rng);
    std::map<uint32_t, float> listed;
    index.for_each(p, n, [&](uint32_t i, float weight, const Vec3& offset) {
      EXPECT_TRUE(listed.emplace(i, weight).second) << "twice";
      EXPECT_EQ(offset, p - points.position[i]);
    });
    size_t expected = 0;
    for (uint32_t i = 0; i < points.position.size(); ++i) {
      const Vec3 d = p - points.position[i];
      const double r = points.radius[i], far = double{dot(d, d)} / (r * r);
      const double cosine = dot(n, points.normal[i]);
      const double off =
          std::max(std::fabs(dot(d, n)), std::fabs(dot(d, points.normal[i]))) / (0.2 * r);
      if (far >= 1 || cosine <= 0.8 || off >= 1) continue;
      const double weight = (1 - far) * (1 - far) * (1 - off * off) * (cosine - 0.8) / 0.2;
      if (weight < 1e-4) continue;  // rounding decides
      ++expected;
      ASSERT_TRUE(listed.contains(i)) << "query " << query;
      EXPECT_NEAR(listed[i], weight, 1e-4 + 1e-3 * weight);
    }
    EXPECT_GE(listed.size(), expected);
    EXPECT_LE(listed.size(), expected + 2);
    found += static_cast<int64_t>(expected);
  }
  EXPECT_GT(found, 400) << "the test has to find something";
}

/// Few points, whose lists have lanes without one, and many, whose lists are longer than what is
/// weighed in one go.
TEST(SurfaceIndex, FindsTheSameOncePacked) {
  for (const int count : {1, 7, 300, 4000}) {
    const Points points = random_points(count, 5);
    const SurfaceIndex plain(points.position, points.normal, points.radius, 0.5f);
    SurfaceIndex packed = plain;
    packed.pack();
    packed.pack();
    EXPECT_EQ(packed.size(), count);
    Rng rng(6);
    size_t found = 0, most = 0;
    for (int query = 0; query < 500; ++query) {
      const size_t near = static_cast<size_t>(query) % points.position.size();
      const Vec3 p = points.position[near] + random_unit(&rng) * 0.02f;
      const Vec3 n = normalize(points.normal[near] + random_unit(&rng) * 0.2f);
      std::vector<std::pair<uint32_t, float>> a, b;
      plain.for_each(p, n, [&](uint32_t i, float w, const Vec3&) { a.emplace_back(i, w); });
      packed.for_each(p, n, [&](uint32_t i, float w, const Vec3& offset) {
        b.emplace_back(i, w);
        EXPECT_EQ(offset, p - points.position[i]);
      });
      std::erase_if(a, [](const auto& of) { return of.second < 1e-6f; });  // rounding decides
      std::erase_if(b, [](const auto& of) { return of.second < 1e-6f; });
      ASSERT_EQ(a.size(), b.size());
      for (size_t k = 0; k < a.size(); ++k) {
        EXPECT_EQ(a[k].first, b[k].first) << "in their order";
        EXPECT_NEAR(a[k].second, b[k].second, 1e-5f);
      }
      found += a.size();
      most = std::max(most, a.size());
    }
    EXPECT_GT(found, 50u) << count;
    if (count == 4000) {
      EXPECT_GT(most, 64u);
    }
  }
}

TEST(SurfaceIndex, AnswersOutsideItsBoundsAndWithoutPoints) {
  const Points points = random_points(10, 3);
  const SurfaceIndex index(points.position, points.normal, points.radius);
  const auto never = [](uint32_t, float, const Vec3&) { FAIL(); };
  index.for_each({1e9f, 0, 0}, {0, 0, 1}, never);
  index.for_each({-1e9f, -1e30f, 0}, {0, 0, 1}, never);
  SurfaceIndex().for_each({0, 0, 0}, {0, 0, 1}, never);
  EXPECT_EQ(SurfaceIndex({}, {}, {}).size(), 0);
}

TEST(SurfaceIndex, RefusesWhatIsNoPoint) {
  const std::vector<Vec3> here{{0, 0, 0}}, up{{0, 0, 1}}, nowhere{{NAN, 0, 0}};
  EXPECT_THROW(SurfaceIndex(here, up, std::vector<float>{0}), Error);
  EXPECT_THROW(SurfaceIndex(nowhere, up, std::vector<float>{1}), Error);
  EXPECT_THROW(SurfaceIndex(here, up, std::vector<float>{1, 1}), Error);
}

}  // namespace
}  // namespace lte::gi
