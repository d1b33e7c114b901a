// Contacts of planes whose meeting is known.
#include "lte/gi/contacts.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gi/planes.h"

namespace lte::gi {
namespace {

using test::PlanePicture;

TEST(Contacts, AFloorMeetsAWallInTheRowsAroundTheirCrease) {
  const PlanePicture picture(32, 40, test::floor_and_wall());
  int crease = 0;  // the first row of floor
  while (picture.plane[static_cast<size_t>(crease * 32)] == 1) ++crease;
  ASSERT_GT(crease, 5);
  ASSERT_LT(crease, 35);
  for (const int radius : {0, 1, 3}) {
    const std::vector<uint8_t> near = find_contacts(picture.view(), radius);
    for (int y = 0; y < 40; ++y) {
      const bool expected = y >= crease - 1 - radius && y <= crease + radius;
      for (int x = 0; x < 32; ++x)
        EXPECT_EQ(near[static_cast<size_t>(y * 32 + x)] != 0, expected) << x << " " << y;
    }
  }
  EXPECT_THAT(find_contacts(picture.view(), -1), testing::IsEmpty());
}

TEST(Contacts, AnEdgeThatPointsAtTheCameraIsNone) {
  // Two walls that fall back to both sides of an edge at x = 0.
  const PlanePicture picture(32, 32,
                             {{{0, 0, -2}, {1, 0, 1}, [](const Vec3& p) { return p.x >= 0; }},
                              {{0, 0, -2}, {-1, 0, 1}, [](const Vec3& p) { return p.x < 0; }}});
  EXPECT_THAT(find_contacts(picture.view(), 2), testing::Each(0));
  // The same edge pointing away: a corner of a room.
  const PlanePicture corner(32, 32,
                            {{{0, 0, -2}, {-1, 0, 1}, [](const Vec3& p) { return p.x >= 0; }},
                             {{0, 0, -2}, {1, 0, 1}, [](const Vec3& p) { return p.x < 0; }}});
  const std::vector<uint8_t> near = find_contacts(corner.view(), 0);
  EXPECT_EQ(std::count(near.begin(), near.end(), 1), 2 * 32);
}

TEST(Contacts, WhatStandsBehindAnOutlineIsNone) {
  // A slab whose side is seen as nothing: its front hides part of a floor far below.
  const PlanePicture picture(32, 32,
                             {{{0, -3, 0}, {0, 1, 0}},
                              {{0, 0, -2}, {0, 0, 1}, [](const Vec3& p) { return p.y > -0.3f; }}});
  EXPECT_THAT(find_contacts(picture.view(), 1), testing::Each(0));
}

}  // namespace
}  // namespace lte::gi
