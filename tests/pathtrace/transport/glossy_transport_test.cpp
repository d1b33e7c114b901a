// Light by way of metal: mirrors and furnaces in closed form, rough reflections by quadrature.
#include <gtest/gtest.h>

#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/render.h"
#include "tests/pathtrace/materials/ggx_reference.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

using test::add_instance;
using test::add_material;
using test::add_metal;
using test::add_quad;
using test::Double3;
using test::ggx_reflection;

Irradiance at(const scene::Scene& scene, const Vec3& position, const Vec3& normal, int max_depth,
              int rays = 4096) {
  const Bvh bvh(scene);
  const Lights lights(scene);
  IrradianceOptions options;
  options.rays = rays;
  options.max_depth = max_depth;
  return estimate_irradiance(bvh, lights, std::vector{position}, std::vector{normal}, options);
}

/// So narrow a view that a pixel is a point.
Rgb radiance_seen(const scene::Scene& scene, const Vec3& from, const Vec3& target, int max_depth,
                  int spp) {
  const Bvh bvh(scene);
  const Lights lights(scene);
  scene::Camera camera;
  camera.origin = from;
  camera.target = target;
  camera.vfov = 0.01f;
  RenderOptions options;
  options.max_depth = max_depth;
  options.spp = spp;
  return render_reference(bvh, lights, camera, 1, 1, options).rgb(0, 0);
}

/// A light seen in a mirror is one more light: that of the mirrored scene.
TEST(GlossyTransport, MirrorShowsTheMirroredLight) {
  scene::Scene scene;
  const int mirror = add_metal(&scene, {1, 1, 1}, 0);
  const int lamp = add_material(&scene, {0, 0, 0}, {5, 3, 1});
  add_quad(&scene, {-400, 0, 400}, {800, 0, 0}, {0, 0, -800}, mirror);  // looks up
  add_quad(&scene, {-0.5f, 2, -0.5f}, {1, 0, 0}, {0, 0, 1}, lamp);      // looks down
  const Vec3 position{0.4f, 1, 0.7f};
  const Vec3 normal = normalize({0.2f, -1, 0});
  const std::vector<Vec3> image{
      {-0.5f, -2, -0.5f}, {0.5f, -2, -0.5f}, {0.5f, -2, 0.5f}, {-0.5f, -2, 0.5f}};
  const double expected = 5 * test::polygon_irradiance(image, position, normal);
  const Irradiance two = at(scene, position, normal, 2);
  EXPECT_EQ(two.direct_sum(0).x, 0) << "the lamp is behind the point";
  EXPECT_NEAR(two.indirect_sum(0).x, expected, 0.02 * expected);
  EXPECT_NEAR(two.indirect_sum(0).y, 0.6 * expected, 0.012 * expected);
}

/// In a closed box of mirrors that lose nothing each depth brings the same again.
TEST(GlossyTransport, MirrorsThatGlowAddUpByDepth) {
  scene::Scene scene;
  const int wall = add_metal(&scene, {1, 1, 1}, 0);
  scene.materials[0].emission = {2, 2, 2};
  add_instance(&scene, test::box_mesh({-1, -1, -1}, {1, 1, 1}, wall, true));
  for (const int depth : {1, 2, 5}) {
    const Irradiance e = at(scene, {0.1f, -1, 0.3f}, {0, 1, 0}, depth, 1024);
    EXPECT_NEAR(e.total(0).x, 2 * M_PI * depth, 5e-3 * 2 * M_PI * depth) << depth;
  }
}

/// Rough white metal loses energy by single scattering only, and by no more than a white surface
/// could give.
TEST(GlossyTransport, RoughFurnaceStaysBelowTheWhiteOne) {
  double last = 0;
  for (const float roughness : {1.0f, 0.6f, 0.3f}) {
    scene::Scene scene;
    const int wall = add_metal(&scene, {1, 1, 1}, roughness);
    scene.materials[0].emission = {1, 1, 1};
    add_instance(&scene, test::box_mesh({-1, -1, -1}, {1, 1, 1}, wall, true));
    const double total = at(scene, {0.1f, -1, 0.3f}, {0, 1, 0}, 4, 1024).total(0).x;
    EXPECT_LT(total, 4 * M_PI * 1.002) << roughness;
    EXPECT_GT(total, last) << roughness;
    last = total;
  }
}

class RoughPlate : public testing::TestWithParam<float> {
 protected:
  /// A plate in the plane y = 0 that looks up, seen at the origin.
  scene::Scene plate(float metallic = 1) const {
    scene::Scene scene;
    add_metal(&scene, {0.9f, 0.6f, 0.1f}, GetParam(), metallic);
    add_quad(&scene, {-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, 0);
    return scene;
  }
  double alpha() const { return double{GetParam()} * GetParam(); }
};
INSTANTIATE_TEST_SUITE_P(Roughness, RoughPlate, testing::Values(0.1f, 0.3f, 0.6f, 1.0f));

/// y is the normal: to the reference's frame.
Double3 local(const Vec3& v) { return {v.z, v.x, v.y}; }

TEST_P(RoughPlate, ReflectsAPointLightAsTheFormulaSays) {
  scene::Scene scene = plate();
  const Vec3 light{0.8f, 1.5f, 0.1f}, eye{-1.4f, 2.5f, 0};
  test::add_point_light(&scene, light, {10, 10, 10});
  const Rgb seen = radiance_seen(scene, eye, {0, 0, 0}, 2, 16);
  for (int c = 0; c < 3; ++c) {
    const double f0 = scene.materials[0].base_color[c];
    const double expected =
        ggx_reflection(local(normalize(eye)), local(normalize(light)), alpha(), f0) * 10 /
        double{dot(light, light)};
    EXPECT_NEAR(seen[c], expected, 5e-3 * expected) << c;
  }
}

/// An area light that both ways of sampling meet, by quadrature over the light.
TEST_P(RoughPlate, ReflectsAnAreaLight) {
  for (const float metallic : {1.0f, 0.4f}) {
    scene::Scene scene = plate(metallic);
    const int lamp = add_material(&scene, {0, 0, 0}, {10, 10, 10});
    add_quad(&scene, {0.5f, 1.5f, -0.5f}, {1, 0, 0}, {0, 0, 1}, lamp);
    const Vec3 eye{-1.0f, 2.0f, 0.4f};
    const Rgb seen = radiance_seen(scene, eye, {0, 0, 0}, 2, 1 << 15);
    constexpr int kSteps = 400;
    for (int c = 0; c < 3; ++c) {
      const double f0 = scene.materials[0].base_color[c];
      double expected = 0;
      for (int i = 0; i < kSteps * kSteps; ++i) {
        const double x = 0.5 + (i % kSteps + 0.5) / kSteps, z = -0.5 + (i / kSteps + 0.5) / kSteps;
        const double d2 = x * x + z * z + 1.5 * 1.5, d = std::sqrt(d2), cosine = 1.5 / d;
        const double reflected =
            metallic * ggx_reflection(local(normalize(eye)), {z / d, x / d, cosine}, alpha(), f0) +
            (1 - metallic) * f0 * cosine / M_PI;
        expected += 10 * reflected * cosine / d2 / (kSteps * kSteps);
      }
      EXPECT_NEAR(seen[c], expected, 0.015 * expected) << "metallic " << metallic;
    }
  }
}

/// Metal in a texture: where its blue is 0 the surface is the Lambertian one.
TEST(GlossyTransport, TextureDecidesWhereMetalIs) {
  scene::Scene scene;
  add_metal(&scene, {1, 1, 1}, 1);
  scene::Material& material = scene.materials[0];
  // Left half: roughness 0.2, metal; right half: roughness 1, none.
  std::vector<uint8_t> texels{0, 51, 255, 0, 255, 0};
  scene.textures.push_back(std::make_shared<scene::Texture>(2, 1, texels, /*srgb=*/false));
  material.metallic_roughness_texture.texture = 0;
  material.metallic_roughness_texture.wrap_u = scene::Wrap::ClampToEdge;
  add_quad(&scene, {-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, 0);
  test::add_point_light(&scene, {0, 2, 0}, {1, 1, 1});
  const Vec3 left{-2.5f, 0, 0}, right{2.5f, 0, 0};
  const double d2 = 2.5 * 2.5 + 4, cosine = 2 / std::sqrt(d2);
  // Towards the mirror image of the light for the left, anywhere for the right.
  const double metal = radiance_seen(scene, {-5, 2, 0}, left, 2, 4).x;
  const double matt = radiance_seen(scene, {5, 2, 0}, right, 2, 4).x;
  const Double3 out = local(normalize({-2.5f, 2, 0})), in = local(normalize({2.5f, 2, 0}));
  const double expected = ggx_reflection(out, in, 0.04, 1) / d2;
  EXPECT_NEAR(metal, expected, 0.01 * expected);
  EXPECT_NEAR(matt, cosine / M_PI / d2, 1e-4);
}

}  // namespace
}  // namespace lte::pathtrace
