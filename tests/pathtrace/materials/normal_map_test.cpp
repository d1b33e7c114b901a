// Light on surfaces with normal maps: closed forms, and what must not change.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "lte/pathtrace/direct_light.h"
#include "lte/pathtrace/gbuffer.h"
#include "lte/pathtrace/render.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

/// Gives all materials a map of one texel.
void add_map(scene::Scene* scene, std::vector<uint8_t> texel) {
  for (scene::Material& material : scene->materials)
    material.normal_texture.texture = static_cast<int>(scene->textures.size());
  scene->textures.push_back(std::make_shared<const scene::Texture>(1, 1, std::move(texel), false));
}

/// A large plane that faces +y, seen from above. U runs along +z.
scene::Scene plane(const Rgb& albedo) {
  scene::Scene scene;
  const int material = test::add_material(&scene, albedo);
  test::add_quad(&scene, {-50, 0, -50}, {0, 0, 100}, {100, 0, 0}, material);
  return scene;
}

/// The direction of texel (`code`, 128, 255) on the plane.
Vec3 tilted(int code) { return normalize({0, 1, 2 * static_cast<float>(code - 128) / 255}); }

scene::Camera above() {
  scene::Camera camera;
  camera.origin = {0.3f, 4, 0.1f};
  camera.target = {0, 0, 0};
  camera.up = {0, 0, 1};
  return camera;
}

image::Image picture(const scene::Scene& scene, int spp = 16, int side = 12, int max_depth = 4) {
  const Bvh bvh(scene);
  const Lights lights(scene);
  const scene::Camera camera = scene.cameras.empty() ? above() : scene.cameras.front();
  return render_reference(bvh, lights, camera, side, side, {spp, max_depth, 3});
}

void set_sky(scene::Scene* scene, float radiance) {
  scene->environment.emplace();
  scene->environment->radiance = {radiance, radiance, radiance};
  scene->environment->light_group = static_cast<int>(scene->light_groups.size());
  scene->light_groups.push_back("sky");
}

TEST(NormalMap, AFlatOneChangesNoBit) {
  scene::Scene room = test::furnished_room();
  room.materials[1].metallic = 1;
  room.materials[1].roughness = 0.4f;
  room.cameras.push_back({"inside", {2, 1.6f, 2.8f}, {2, 1, 0}, {0, 1, 0}, 70});
  const image::Image plain = picture(room);
  add_map(&room, {128, 128, 255});
  EXPECT_EQ(picture(room).pixels, plain.pixels);
}

TEST(NormalMap, ATiltedOneIsThePlaneWithTiltedNormals) {
  for (const float metallic : {0.0f, 1.0f, 0.5f}) {
    scene::Scene mapped = plane({0.6f, 0.5f, 0.4f}), leaning = mapped;
    add_map(&mapped, {230, 128, 255});
    add_map(&leaning, {128, 128, 255});
    leaning.meshes[0].normals.assign(4, tilted(230));
    for (scene::Scene* scene : {&mapped, &leaning}) {
      scene->materials[0].metallic = metallic;
      scene->materials[0].roughness = 0.5f;
      test::add_point_light(scene, {1, 3, 2}, {9, 9, 9});
      set_sky(scene, 0.5f);
    }
    const image::Image a = picture(mapped), b = picture(leaning);
    ASSERT_GT(a.pixels[0], 0);
    for (size_t i = 0; i < a.pixels.size(); ++i)
      EXPECT_NEAR(a.pixels[i], b.pixels[i], 1e-4f * b.pixels[i]) << i;
  }
}

TEST(NormalMap, APointLightShinesByTheShadingNormalsCosine) {
  scene::Scene scene = plane({0.8f, 0.8f, 0.8f});
  add_map(&scene, {200, 128, 255});
  test::add_point_light(&scene, {0, 2, 2}, {10, 10, 10});
  scene::Camera camera = above();
  camera.vfov = 0.01f;
  scene.cameras.push_back(camera);
  const float cosine = dot(tilted(200), normalize({0, 2, 2}));
  EXPECT_NEAR(picture(scene, 1, 1).pixels[0], 0.8f / kPi * 10 / 8 * cosine, 1e-4f);
  // Below the surface, though above the shading normal's horizon, nothing arrives.
  scene.lights[0].position = {0, -0.2f, 2};
  EXPECT_EQ(picture(scene, 4, 1).pixels[0], 0);
}

/// Of a uniform sky of radiance 1 a white plane tilted by θ sees (1 + cos θ) / 2 above its own
/// horizon.
TEST(NormalMap, UnderASkyTheSurfaceHidesWhatLiesBelowIt) {
  for (const int code : {160, 220, 255}) {
    scene::Scene scene = plane({1, 1, 1});
    add_map(&scene, {static_cast<uint8_t>(code), 128, 255});
    set_sky(&scene, 1);
    const image::Image seen = picture(scene, 1024, 4, 2);
    double mean = 0;
    for (const float value : seen.pixels) mean += value / static_cast<double>(seen.pixels.size());
    EXPECT_NEAR(mean, (1 + tilted(code).y) / 2, 2e-3) << code;
  }
}

TEST(NormalMap, DirectLightAtPointsIsThatOfPaths) {
  scene::Scene scene = plane({1, 1, 1});
  set_sky(&scene, 1);
  const Bvh bvh(scene);
  const Lights lights(scene);
  const std::vector<Vec3> position(64, {0.1f, 0, 0.2f}), shading(64, tilted(240)),
      geometric(64, {0, 1, 0});
  std::vector<uint64_t> streams(64);
  for (size_t i = 0; i < 64; ++i) streams[i] = i;
  const std::vector<int32_t> samples(64, 64);
  for (const float share : {0.0f, 0.25f, 1.0f}) {
    DirectOptions options;
    options.hemisphere_share = share;
    const DirectLight light =
        estimate_direct(bvh, lights, {position, shading, streams, geometric}, samples, options);
    double mean = 0;
    for (const Rgb& value : light.irradiance) mean += value.x / 64.0;
    EXPECT_NEAR(mean, kPi * (1 + tilted(240).y) / 2, 0.01) << share;
  }
}

/// A closed box of radiance 1 and albedo 1 - ε would glow without end if maps made light: with
/// every wall bumpy no pixel exceeds the furnace with level walls.
TEST(NormalMap, InAFurnaceNoLightIsMade) {
  for (const float metallic : {0.0f, 1.0f}) {
    scene::Scene box;
    const int wall = test::add_material(&box, {1, 1, 1}, {1, 1, 1});
    box.materials[static_cast<size_t>(wall)].metallic = metallic;
    box.materials[static_cast<size_t>(wall)].roughness = 0.3f;
    test::add_instance(&box, test::box_mesh({0, 0, 0}, {2, 2, 2}, wall, true));
    box.cameras.push_back({"inside", {1, 1, 1}, {1, 0.4f, 0}, {0, 1, 0}, 80});
    constexpr int kHits = 4;
    add_map(&box, {200, 90, 230});
    const image::Image bumpy = picture(box, 64, 8, kHits);
    double mean = 0;
    for (const float value : bumpy.pixels) {
      mean += value / static_cast<double>(bumpy.pixels.size());
      EXPECT_TRUE(std::isfinite(value));
    }
    EXPECT_LE(mean, kHits) << "one for each hit of a path: nothing is lost between level walls";
    EXPECT_GT(mean, 0.3 * kHits);
  }
}

TEST(NormalMap, TheGBufferHasBothNormals) {
  scene::Scene scene = plane({0.5f, 0.5f, 0.5f});
  EXPECT_TRUE(trace_gbuffer(Bvh(scene), above(), 4, 4).geometric_normal.empty());
  add_map(&scene, {60, 128, 255});
  const GBuffer hits = trace_gbuffer(Bvh(scene), above(), 4, 4);
  const GBuffer rows = rows_of(hits, 1, 3);
  for (size_t i = 0; i < hits.mask.size(); ++i) {
    EXPECT_EQ(hits.geometric(i), (Vec3{0, 1, 0}));
    EXPECT_NEAR(hits.normal[i].z, tilted(60).z, 1e-6f);
  }
  EXPECT_EQ(rows.geometric_normal.size(), 8u);
  scene::Camera below = above();
  below.origin.y = -4;
  const GBuffer back = trace_gbuffer(Bvh(scene), below, 4, 4);
  EXPECT_EQ(back.geometric(5), (Vec3{0, -1, 0}));
  EXPECT_NEAR(back.normal[5].z, -tilted(60).z, 1e-6f);
}

}  // namespace
}  // namespace lte::pathtrace
