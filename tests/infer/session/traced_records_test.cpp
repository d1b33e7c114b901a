#include "infer/session/traced_records.h"

#include <array>
#include <memory>

#include <gtest/gtest.h>

#include "infer/session/light_records.h"
#include "infer/session/scene_edits.h"
#include "lte/base/check.h"
#include "tests/infer/fixture.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

/// A furnished room with a third lamp.
scene::Scene three_lamps() {
  scene::Scene room = test::furnished_room();
  test::add_point_light(&room, {1, 2, 1}, {1, 2, 3});
  return room;
}

struct Lit {
  scene::Scene scene = three_lamps();
  pathtrace::Bvh bvh{scene};
  pathtrace::Lights lights{scene};
};

constexpr std::array<int, 3> kAll = {0, 1, 2};
const std::array<Rgb, 3> kOne = {Rgb{1, 1, 1}, Rgb{1, 1, 1}, Rgb{1, 1, 1}};

TEST(TracedRecords, AtGainOneTheyFillTheCacheThatPicturesRead) {
  const Lit lit;
  const render::CacheSettings settings{.records = 1024};
  const TracedRecords records =
      trace_records(lit.bvh, lit.lights, settings, render::Method::Gather);
  const gi::IrradianceCache mine =
      gi::IrradianceCache::of(records.geometry, records.places, records.light_of(kAll, kOne));
  const gi::IrradianceCache table = render::make_cache({lit.bvh, lit.lights}, settings);
  ASSERT_EQ(mine.size(), table.size());
  double a = 0, b = 0, late_a = 0, late_b = 0;
  int found = 0;
  for (size_t i = 0; i < records.places.position.size(); ++i) {
    const Vec3 &at = records.places.position[i], &side = records.places.normal[i];
    Rgb of_mine, of_table;
    if (!mine.lookup(at, side, &of_mine) || !table.lookup(at, side, &of_table)) continue;
    found += max_component(of_mine) > 0;
    a += double{of_mine.y} * records.places.area[i];
    b += double{of_table.y} * records.places.area[i];
    ASSERT_TRUE(mine.lookup(at, side, &of_mine, 2) && table.lookup(at, side, &of_table, 2));
    late_a += double{of_mine.y} * records.places.area[i];
    late_b += double{of_table.y} * records.places.area[i];
  }
  EXPECT_GT(found, mine.size() / 4);
  EXPECT_NEAR(a, b, 0.03 * b) << "paths of other numbers, of the same light";
  EXPECT_NEAR(late_a, late_b, 0.03 * b) << "without their last bounce";
  EXPECT_LT(late_b, b);
}

TEST(TracedRecords, LightIsTheSumOfLampsTimesTheirGains) {
  const Lit lit;
  const TracedRecords records =
      trace_records(lit.bvh, lit.lights, {.records = 512}, render::Method::Gather);
  const std::array<Rgb, 3> gains = {Rgb{0.5f, 1, 2}, Rgb{0, 0, 0}, Rgb{0.1f, 0.2f, 0}};
  const std::vector<Rgb> sum = records.light_of(kAll, gains).total();
  const std::array<int, 1> first = {0}, second = {2};
  const std::array<Rgb, 1> one = {Rgb{1, 1, 1}};
  const std::vector<Rgb> a = records.light_of(first, one).total(),
                         b = records.light_of(second, one).total();
  double of_a = 0, of_b = 0;
  for (size_t i = 0; i < sum.size(); ++i) {
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(sum[i][c], a[i][c] * gains[0][c] + b[i][c] * gains[2][c], 1e-5f * sum[i][c]);
    of_a += double{a[i].y};
    of_b += double{b[i].y};
  }
  EXPECT_GT(of_a, 0);
  EXPECT_GT(of_b, 0);
  EXPECT_EQ(records.light_of({}, {}).total(), std::vector<Rgb>(sum.size())) << "all lamps are off";
  EXPECT_THROW(records.light_of(kAll, one), Error);
  const std::array<int, 1> none = {3};
  EXPECT_THROW(records.light_of(none, one), Error);
}

TEST(TracedRecords, ForANetworkTheyAreTheDirectLightOfAllPlaces) {
  const Lit lit;
  const render::CacheSettings settings{.records = 512};
  const TracedRecords records =
      trace_records(lit.bvh, lit.lights, settings, render::Method::Network);
  EXPECT_GE(records.places.size(), 512);
  for (const Rgb& bounced : records.indirect) EXPECT_EQ(bounced, Rgb());
  int calls = 0;
  EXPECT_THROW(trace_records(lit.bvh, lit.lights, settings, render::Method::Network,
                             [&] {
                               ++calls;
                               throw Error("enough");
                             }),
               Error);
  EXPECT_EQ(calls, 1);
}

/// What stands around the records is found once while lamps are dimmed, and anew where a thing has
/// been moved into their way.
TEST(LightRecords, ShareTheirGeometryWhileNothingMoves) {
  const Lit lit;
  NextIds ids;
  EditReport report;
  SceneEdits edits = make_edits(lit.scene, &ids);
  const LightRecords records =
      trace_light_records(lit.bvh, lit.lights, std::make_shared<const SceneEdits>(edits),
                          Method::Gather, {.records = 64}, {});
  apply_edit(SetLight{0, 0.5, {}}, &edits, &ids, &report);
  EXPECT_EQ(records.geometry(edits, lit.bvh).get(), records.traced.geometry.get());
  apply_edit(MoveInstance{1, test::translation({0.2f, 0, 0})}, &edits, &ids, &report);
  EXPECT_NE(records.geometry(edits, lit.bvh).get(), records.traced.geometry.get());
}

TEST(TracedRecords, WithoutLightThereAreNone) {
  scene::Scene dark = test::furnished_room();
  for (scene::Material& material : dark.materials) material.emission = {};
  const pathtrace::Bvh bvh(dark);
  const pathtrace::Lights lights(dark);
  EXPECT_EQ(trace_records(bvh, lights, {.records = 64}, render::Method::Gather).places.size(), 0);
}

}  // namespace
}  // namespace lte::infer
