// Light maps' texels on a cube and a sphere of known area.
#include "infer/bench/pareto/texel_atlas.h"

#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

scene::Scene cube() {
  scene::Scene scene;
  const int matt = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_instance(&scene, test::box_mesh({-1, -1, -1}, {1, 1, 1}, matt, false));
  return scene;
}

TEST(TexelAtlas, CoversACubeWithOneChartAFace) {
  const TexelAtlas atlas = make_texel_atlas(cube(), 2400);
  EXPECT_NEAR(atlas.edge, 0.1f, 1e-6f);
  EXPECT_GE(atlas.size(), 6 * 20 * 20);
  EXPECT_LE(atlas.size(), 6 * 22 * 22);
  std::map<uint32_t, size_t> texels;
  std::map<int, Vec3> sums;
  for (size_t i = 0; i < atlas.place.size(); ++i) {
    EXPECT_TRUE(texels.emplace(atlas.place[i], i).second) << "two texels in one place";
    const Vec3 &p = atlas.position[i], &n = atlas.normal[i];
    EXPECT_NEAR(dot(p, n), 1, 1e-5f) << "on its face, whose front is outside";
    EXPECT_LE(max_component(p), 1.00001f);
    EXPECT_NEAR(length(n), 1, 1e-5f);
  }
  // Neighbours in the picture are neighbours on a face: charts stand apart.
  for (const auto& [place, i] : texels) {
    for (const uint32_t step : {1u, static_cast<uint32_t>(atlas.width)}) {
      const auto next = texels.find(place + step);
      if (next == texels.end()) continue;
      EXPECT_LT(length(atlas.position[next->second] - atlas.position[i]), 0.11f);
    }
  }
}

TEST(TexelAtlas, EveryPlaceOfASurfaceHasATexelNearIt) {
  scene::Scene scene = test::furnished_room();
  const TexelAtlas atlas = make_texel_atlas(scene, 4000);
  double area = 0;
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
    for (const auto& t : mesh.triangles) {
      const Vec3 a = instance.to_world.point(mesh.positions[t[0]]),
                 b = instance.to_world.point(mesh.positions[t[1]]),
                 c = instance.to_world.point(mesh.positions[t[2]]);
      area += 0.5 * double{length(cross(b - a, c - a))};
      const Vec3 middle = (a + b + c) / 3;
      float nearest = INFINITY;
      for (const Vec3& p : atlas.position) nearest = std::min(nearest, length(p - middle));
      EXPECT_LT(nearest, 1.3f * atlas.edge);
    }
  }
  EXPECT_NEAR(double{atlas.edge}, std::sqrt(area / 4000), 1e-4);
}

TEST(TexelAtlas, PutsValuesInTheirPlaces) {
  const TexelAtlas atlas = make_texel_atlas(cube(), 60);
  const image::Image picture = atlas.picture(atlas.normal);
  EXPECT_EQ(picture.width, atlas.width);
  double sum = 0;
  for (const float value : picture.pixels) sum += std::fabs(double{value});
  EXPECT_NEAR(sum, static_cast<double>(atlas.size()), 1e-3);
}

TEST(TexelAtlas, RefusesWhatHasNoSurface) {
  EXPECT_THROW(make_texel_atlas({}, 100), Error);
  EXPECT_THROW(make_texel_atlas(cube(), 0), Error);
  EXPECT_THROW(make_texel_atlas(cube(), int64_t{1} << 40), Error);
}

}  // namespace
}  // namespace lte::infer
