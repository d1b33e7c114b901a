// Which places may see a vertex, against all of them one by one.
#include "lte/pathtrace/reach/place_grid.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "lte/base/random.h"

namespace lte::pathtrace {
namespace {

Vec3 direction(Rng* rng) {
  const float y = rng->uniform(-1, 1), phi = rng->uniform(0, 2 * kPi), r = std::sqrt(1 - y * y);
  return {r * std::cos(phi), y, r * std::sin(phi)};
}

TEST(PlaceGrid, FindsWhatLiesNearbyAndFacesTheVertex) {
  constexpr float kRadius = 0.3f;
  Rng rng(5);
  const auto anywhere = [&] {
    return Vec3{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
  };
  std::vector<Place> places(3000);
  std::vector<uint32_t> members;
  for (uint32_t i = 0; i < places.size(); ++i) {
    places[i].origin = anywhere();
    places[i].side = direction(&rng);
    if (i % 3 != 0) members.push_back(i);
  }
  const PlaceGrid grid(places, members, kRadius);
  size_t all = 0;
  for (int query = 0; query < 300; ++query) {
    const PathVertex vertex{anywhere(), direction(&rng)};
    std::vector<uint32_t> found, expected;
    EXPECT_FALSE(grid.any_before(vertex, [&](uint32_t number) {
      found.push_back(number);
      return false;
    }));
    for (const uint32_t i : members) {
      const Vec3 way = places[i].origin - vertex.position;
      // Leaves out what rounding decides; such places are few here.
      if (length(way) < kRadius && dot(way, vertex.side) > 0 && dot(way, places[i].side) < 0)
        expected.push_back(i);
    }
    std::sort(found.begin(), found.end());
    EXPECT_TRUE(std::includes(found.begin(), found.end(), expected.begin(), expected.end()));
    EXPECT_LE(found.size(), expected.size() + 2);
    EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
    all += expected.size();
  }
  EXPECT_GT(all, 1000u);
}

TEST(PlaceGrid, NeighboursInAPlaneFaceEachOtherAndBothSidesOfItDoNot) {
  std::vector<Place> places(3);
  for (size_t i = 0; i < 3; ++i) {
    places[i].origin = {static_cast<float>(i), 0.001f, 1000};
    places[i].side = {0, 1, 0};
  }
  places[2].origin.y = -0.001f;
  places[2].side.y = -1;
  const std::vector<uint32_t> members{0, 1, 2};
  const PlaceGrid grid(places, members, 1.5f);
  std::vector<uint32_t> found;
  grid.any_before({{1, 0.001f, 1000}, {0, 1, 0}}, [&](uint32_t number) {
    found.push_back(number);
    return false;
  });
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, (std::vector<uint32_t>{0, 1}));
}

}  // namespace
}  // namespace lte::pathtrace
