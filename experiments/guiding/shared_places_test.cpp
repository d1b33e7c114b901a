#include "experiments/guiding/shared_places.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/random.h"

namespace lte::experiments {
namespace {

constexpr float kRadius = 0.3f, kCosine = 0.9f;

/// The nearest place that looks the same way, by looking at all of them.
int32_t by_looking_at_all(const SharedPlaces& places, const Vec3& position, const Vec3& normal) {
  int32_t nearest = -1;
  float least = kRadius;
  for (size_t i = 0; i < places.position().size(); ++i) {
    const float distance = length(places.position()[i] - position);
    if (distance > least || dot(places.normal()[i], normal) < kCosine) continue;
    if (distance == least && nearest >= 0) continue;
    least = distance;
    nearest = static_cast<int32_t>(i);
  }
  return nearest;
}

TEST(SharedPlaces, EachPointHasTheNearestThatFacesTheSameWay) {
  SharedPlaces places(kRadius, kCosine);
  Rng rng(4);
  int joined = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 position{rng.uniform(-1, 1), rng.uniform(-2, 0), rng.uniform(5, 6)};
    const Vec3 normal = normalize({rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)});
    const int32_t expected = by_looking_at_all(places, position, normal);
    ASSERT_EQ(places.find(position, normal), expected);
    const auto before = static_cast<int32_t>(places.position().size());
    ASSERT_EQ(places.join(position, normal), expected >= 0 ? expected : before);
    joined += expected >= 0;
  }
  EXPECT_GT(joined, 1000);
  EXPECT_GT(places.position().size(), 100u);
  for (size_t i = 0; i < places.position().size(); ++i) {
    for (size_t j = 0; j < i; ++j)
      ASSERT_TRUE(length(places.position()[i] - places.position()[j]) > kRadius * 0.999f ||
                  dot(places.normal()[i], places.normal()[j]) < kCosine)
          << "two places serve the same points";
  }
}

TEST(SharedPlaces, TakeFarPlacesAndRefuseWhatIsNoRadius) {
  SharedPlaces places(1e-3f, 0);
  EXPECT_EQ(places.join({3e8f, -3e8f, 0}, {0, 1, 0}), 0);
  EXPECT_EQ(places.join({3e8f, -3e8f, 0}, {0, 1, 0}), 0);
  EXPECT_EQ(places.join({3e8f, 0, 0}, {0, 1, 0}), 1);
  EXPECT_THROW(SharedPlaces(0, 0.9f), Error);
  EXPECT_THROW(SharedPlaces(NAN, 0.9f), Error);
  EXPECT_THROW(SharedPlaces(1, 1.5f), Error);
}

}  // namespace
}  // namespace lte::experiments
