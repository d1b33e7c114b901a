// The shipped Cornell box is the one that was measured.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/scene/load.h"
#include "lte/scene/surface.h"
#include "lte/scene/triangle.h"

namespace lte::scene {
namespace {

Vec3 mean(const std::vector<Vec3>& points) {
  Vec3 sum;
  for (const Vec3& p : points) sum += p;
  return sum / static_cast<float>(points.size());
}

class CornellBox : public ::testing::Test {
 protected:
  const Scene scene_ = load_scene(LTE_SOURCE_DIR "/assets/scenes/cornell_box.glb");

  const Instance& find(const std::string& mesh) const {
    for (const Instance& instance : scene_.instances) {
      if (scene_.meshes[static_cast<size_t>(instance.mesh)].name == mesh) return instance;
    }
    throw Error("no mesh " + mesh);
  }
  double area_of(const std::string& name) const {
    const Instance& instance = find(name);
    const Mesh& mesh = scene_.meshes[static_cast<size_t>(instance.mesh)];
    double sum = 0;
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i)
      sum += area(world_triangle(mesh, instance.to_world, i));
    return sum;
  }
  const Material& material_of(const std::string& name) const {
    return scene_.materials[static_cast<size_t>(
        scene_.meshes[static_cast<size_t>(find(name).mesh)].material)];
  }
};

TEST_F(CornellBox, HasItsSurfaces) {
  EXPECT_EQ(scene_.name, "cornell_box");
  EXPECT_EQ(scene_.instances.size(), 8u);
  EXPECT_EQ(scene_.triangle_count(), 6 * 2 + 2 * 5 * 2);
  EXPECT_THAT(scene_.light_groups, ::testing::ElementsAre("light"));
  EXPECT_THAT(scene_.ignored, ::testing::IsEmpty());
  EXPECT_EQ(material_of("left wall").base_color, (Rgb{0.63f, 0.065f, 0.05f}));
  EXPECT_EQ(material_of("right wall").base_color, (Rgb{0.14f, 0.45f, 0.091f}));
  EXPECT_EQ(material_of("floor").base_color, (Rgb{0.73f, 0.73f, 0.73f}));
}

TEST_F(CornellBox, HasTheMeasuredSize) {
  const Bounds bounds = scene_.bounds();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(bounds.low[c], 0, 1e-6);
  EXPECT_NEAR(bounds.high.x, 0.556, 1e-6);
  EXPECT_NEAR(bounds.high.y, 0.5488, 1e-6);
  EXPECT_NEAR(bounds.high.z, 0.5592, 1e-6);
  EXPECT_NEAR(area_of("ceiling"), 0.556 * 0.5592, 1e-6);
  EXPECT_NEAR(area_of("floor"), (0.5528 + 0.5496) / 2 * 0.5592, 1e-6);
  EXPECT_NEAR(area_of("right wall"), 0.5592 * 0.5488, 1e-6);
  // Blocks: four sides of known edge lengths, and the top by the shoelace formula.
  const double sides =
      std::hypot(48, 160) + std::hypot(158, 47) + std::hypot(50, 158) + std::hypot(160, 49);
  const double top = 0.5 * std::abs((130. * 225 - 82 * 65) + (82. * 272 - 240 * 225) +
                                    (240. * 114 - 290 * 272) + (290. * 65 - 130 * 114));
  EXPECT_NEAR(area_of("short block"), (165 * sides + top) * 1e-6, 1e-6);
}

TEST_F(CornellBox, LightHasItsPower) {
  EXPECT_EQ(material_of("light").emission, (Rgb{17, 12, 4}));
  EXPECT_FALSE(material_of("light").double_sided);
  EXPECT_NEAR(area_of("light"), 0.130 * 0.105, 1e-7);
  const Rgb power = material_of("light").emission * (kPi * static_cast<float>(area_of("light")));
  EXPECT_NEAR(power.x, 0.72901, 1e-4);  // pi * 0.01365 m² * 17
}

TEST_F(CornellBox, WallsFaceTheRoomAndBlocksFaceAwayFromTheirCentres) {
  for (size_t i = 0; i < scene_.instances.size(); ++i) {
    const Mesh& mesh = scene_.meshes[static_cast<size_t>(scene_.instances[i].mesh)];
    const bool is_block = mesh.name.ends_with("block");
    const Vec3 centre = is_block ? scene_.instances[i].to_world.point(mean(mesh.positions))
                                 : scene_.bounds().center();
    for (uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
      const Surface surface =
          evaluate_surface(scene_, static_cast<int>(i), triangle, 1 / 3.0f, 1 / 3.0f, 0);
      const float outward = dot(surface.normal, surface.position - centre);
      EXPECT_GT(is_block ? outward : -outward, 0.01f) << mesh.name << ", triangle " << triangle;
    }
  }
}

TEST_F(CornellBox, CameraLooksIntoTheOpenSide) {
  ASSERT_EQ(scene_.cameras.size(), 1u);
  const Camera& camera = scene_.cameras[0];
  EXPECT_NEAR(camera.origin.z, -0.8, 1e-6);
  EXPECT_NEAR(camera.vfov, 39.3077, 1e-3);
  const Vec3 forward = camera.direction(0.5f, 0.5f, 1), left = camera.direction(0, 0.5f, 1);
  EXPECT_NEAR(forward.z, 1, 1e-6);
  EXPECT_GT(left.x, 0.1) << "the red wall, at large x, is on the left of the picture";
}

/// The same numbers in another format: triangle by triangle, in the order of the file.
TEST_F(CornellBox, PbrtTwinIsTheSameScene) {
  const Scene twin = load_scene(LTE_SOURCE_DIR "/assets/scenes/cornell_box.pbrt");
  EXPECT_THAT(twin.ignored, ::testing::IsEmpty());
  ASSERT_EQ(twin.instances.size(), scene_.instances.size());
  for (size_t i = 0; i < scene_.instances.size(); ++i) {
    const Mesh& mesh = scene_.meshes[static_cast<size_t>(scene_.instances[i].mesh)];
    const Mesh& other = twin.meshes[static_cast<size_t>(twin.instances[i].mesh)];
    EXPECT_EQ(other.positions, mesh.positions) << mesh.name;
    EXPECT_EQ(other.triangles, mesh.triangles) << mesh.name;
    EXPECT_EQ(twin.instances[i].light_group, scene_.instances[i].light_group);
    for (uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
      const Surface a = evaluate_surface(scene_, static_cast<int>(i), triangle, 0.3f, 0.3f, 0);
      const Surface b = evaluate_surface(twin, static_cast<int>(i), triangle, 0.3f, 0.3f, 0);
      EXPECT_EQ(a.position, b.position);
      EXPECT_EQ(a.normal, b.normal);
      EXPECT_EQ(a.albedo, b.albedo);
      EXPECT_EQ(a.emission, b.emission);
      EXPECT_EQ(a.emits_back, b.emits_back);
    }
  }
  ASSERT_EQ(twin.cameras.size(), 1u);
  for (const float x : {0.0f, 0.5f, 1.0f}) {
    const Vec3 a = scene_.cameras[0].direction(x, 0.25f, 1);
    const Vec3 b = twin.cameras[0].direction(x, 0.25f, 1);
    EXPECT_LT(length(a - b), 1e-6f);
  }
  EXPECT_LT(length(scene_.cameras[0].origin - twin.cameras[0].origin), 1e-6f);
}

}  // namespace
}  // namespace lte::scene
