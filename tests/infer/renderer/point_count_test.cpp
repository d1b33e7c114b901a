// How many scene points a scene gets: by what it is like, not by how large it is.
#include "lte/embed/point_count.h"

#include <gtest/gtest.h>

#include "lte/pathtrace/bvh.h"
#include "tests/support/scenes.h"

namespace lte::embed {
namespace {

/// Rooms of 4 x 3 x 4 m in a row, each with a lamp, with boxes on the floor of each.
scene::Scene rooms(int count, int boxes, float scale = 1) {
  scene::Scene scene;
  const int wall = test::add_material(&scene, {0.6f, 0.5f, 0.4f});
  const int shine = test::add_material(&scene, {}, {4, 4, 4});
  for (int room = 0; room < count; ++room) {
    const float x = 10 * static_cast<float>(room) * scale;
    test::add_instance(&scene, test::box_mesh({x, 0, 0}, {x + 4 * scale, 3 * scale, 4 * scale},
                                              wall, /*inwards=*/true));
    test::add_quad(&scene, {x + 1.5f * scale, 2.9f * scale, 1.5f * scale}, {scale, 0, 0},
                   {0, 0, scale}, shine);
    for (int box = 0; box < boxes; ++box) {
      const Vec3 at{x + (0.2f + 0.6f * static_cast<float>(box % 6)) * scale, 0.01f * scale,
                    (0.2f + 0.6f * static_cast<float>(box / 6)) * scale};
      const Vec3 edge{0.3f * scale, 1.2f * scale, 0.3f * scale};
      test::add_instance(&scene, test::box_mesh(at, at + edge, wall, /*inwards=*/false));
    }
  }
  return scene;
}

double detail_of(const scene::Scene& scene) { return surface_detail(pathtrace::Bvh(scene)); }

int64_t count_of(const scene::Scene& scene, Reader reader, int64_t trained = 8192) {
  return scene_point_count(pathtrace::Bvh(scene), trained, reader);
}

TEST(PointCount, DetailIsThatOfTheShapeAndNotOfItsSize) {
  const double detail = detail_of(rooms(1, 6));
  EXPECT_NEAR(detail_of(rooms(1, 6, 4)), detail, 0.02 * detail);
  EXPECT_NEAR(detail_of(rooms(1, 6, 0.25f)), detail, 0.02 * detail);
}

TEST(PointCount, DetailAddsUpOverRoomsAndGrowsByFurniture) {
  const double empty = detail_of(rooms(1, 0));
  EXPECT_GT(empty, 20);
  EXPECT_LT(empty, 100);
  EXPECT_NEAR(detail_of(rooms(4, 0)), 4 * empty, empty);
  EXPECT_GT(detail_of(rooms(1, 36)), 3 * empty);
}

TEST(PointCount, ManyRoomsHaveMoreThanOneAndRaysNeedFewer) {
  const scene::Scene one = rooms(1, 0), many = rooms(4, 36);
  EXPECT_EQ(count_of(one, Reader::Points), 4096);
  EXPECT_EQ(count_of(many, Reader::Points), 8192);
  EXPECT_EQ(count_of(one, Reader::Rays), 1024);
  EXPECT_EQ(count_of(many, Reader::Rays), 2048);
}

TEST(PointCount, LuminairesHaveSixteenEachAsLongAsThatIsNoMoreThanInTraining) {
  scene::Scene scene = rooms(1, 0);
  const int shine = test::add_material(&scene, {}, {4, 4, 4});
  const auto add_lamps = [&](int count) {
    for (int i = 0; i < count; ++i)
      test::add_quad(&scene, {0.5f, 1, 0.5f}, {0.01f, 0, 0}, {0, 0, 0.01f}, shine);
  };
  add_lamps(99);
  EXPECT_EQ(count_of(scene, Reader::Rays), 1600);
  add_lamps(500);
  EXPECT_EQ(count_of(scene, Reader::Rays), 8192);
}

TEST(PointCount, AModelOfFewPointsGetsNoFewer) {
  for (const Reader reader : {Reader::Points, Reader::Rays})
    EXPECT_EQ(count_of(rooms(1, 0), reader, 400), 400);
}

TEST(PointCount, WithoutLightAllSurfaceCounts) {
  scene::Scene dark = rooms(1, 0);
  for (scene::Material& material : dark.materials) material.emission = {};
  for (scene::Instance& instance : dark.instances) instance.light_group = scene::kNone;
  dark.light_groups.clear();
  EXPECT_GT(detail_of(dark), 20);
}

}  // namespace
}  // namespace lte::embed
