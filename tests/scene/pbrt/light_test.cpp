// PBRT: area lights and punctual lights in the units of pbrt-v4.
#include "lte/image/exr.h"
#include "lte/scene/surface.h"
#include "tests/scene/pbrt/fixture.h"

namespace lte::scene {
namespace {

using test::expect_near;
using test::front;
using test::kTriangle;
using test::material_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class PbrtLight : public test::PbrtTest {
 protected:
  Material area_light(const std::string& params, const std::string& shape = kTriangle) {
    const Scene scene = load_world("AreaLightSource \"diffuse\" " + params + "\n" + shape);
    EXPECT_EQ(scene.light_groups.size(), 1u);
    EXPECT_EQ(scene.instances[0].light_group, 0);
    return material_of(scene);
  }
  PunctualLight light(const std::string& directive) {
    const Scene scene = load_world(directive + "\n" + kTriangle);
    EXPECT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.light_groups.size(), 1u);
    notes_ = ignored(scene);
    return scene.lights.at(0);
  }
  std::vector<std::string> notes_;
};

TEST_F(PbrtLight, RgbIsRadianceTimesScale) {
  EXPECT_EQ(area_light("\"rgb L\" [17 12 4]").emission, (Rgb{17, 12, 4}));
  EXPECT_EQ(area_light("\"rgb L\" [1 2 3] \"float scale\" 2").emission, (Rgb{2, 4, 6}));
  EXPECT_EQ(area_light("").emission, (Rgb{1, 1, 1}));
  EXPECT_FALSE(area_light("").double_sided);
  EXPECT_TRUE(area_light("\"bool twosided\" true").double_sided);
  EXPECT_TRUE(area_light("\"bool twosided\" \"true\"").double_sided);
}

TEST_F(PbrtLight, SpectraHaveLuminanceOne) {
  for (const char* spectrum : {"\"blackbody L\" 3000", "\"spectrum L\" \"stdillum-A\"",
                               "\"spectrum L\" [400 1 500 2 700 3]"}) {
    const Rgb emission = area_light(std::string(spectrum) + " \"float scale\" 5").emission;
    EXPECT_NEAR(luminance(emission), 5, 1e-4) << spectrum;
    EXPECT_GT(emission.x, emission.z) << spectrum;
  }
}

TEST_F(PbrtLight, PowerIsThatOfOneTriangle) {
  // Radiance is power / (pi * area); pbrt makes a light of each triangle. The triangle has 1/2 m².
  EXPECT_NEAR(area_light("\"float power\" 3").emission.x, 3 / (M_PI * 0.5), 1e-5);
  EXPECT_NEAR(area_light("\"float power\" 3 \"bool twosided\" true").emission.x,
              3 / (2 * M_PI * 0.5), 1e-5);
  EXPECT_NEAR(area_light("\"float power\" 3 \"rgb L\" [2 4 6] \"float scale\" 10").emission.y,
              40 * 3 / (M_PI * 0.5), 1e-3);
  const std::string square =
      "Scale 2 2 1\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0] \"integer "
      "indices\" "
      "[0 1 2 0 2 3]";
  EXPECT_NEAR(area_light("\"float power\" 3", square).emission.x, 3 / (M_PI * 2), 1e-5);
}

TEST_F(PbrtLight, PowerOfASphereIsThatOfTheWhole) {
  const Material sphere = area_light("\"float power\" 100", "Shape \"sphere\" \"float radius\" 2");
  EXPECT_NEAR(sphere.emission.x, 100 / (M_PI * 16 * M_PI), 0.002 * 100 / (M_PI * 16 * M_PI));
}

TEST_F(PbrtLight, EqualLightsOfDifferentShapesWithPowerAreTwoMaterials) {
  const Scene scene = load_world("AreaLightSource \"diffuse\" \"float power\" 1\n" + kTriangle +
                                 "Scale 2 2 2\n" + kTriangle);
  EXPECT_NEAR(material_of(scene, 0).emission.x / material_of(scene, 1).emission.x, 4, 1e-4);
  EXPECT_EQ(scene.light_groups.size(), 2u);
}

TEST_F(PbrtLight, UnevenTrianglesWithPowerKeepTheSumAndAreNoted) {
  const Scene scene = load_world(
      "AreaLightSource \"diffuse\" \"float power\" 1\n"
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 0 -3 0] \"integer indices\" "
      "[0 1 2 0 3 1]");
  EXPECT_NEAR(material_of(scene).emission.x * M_PI * test::area_of(scene), 2, 1e-5);
  EXPECT_THAT(ignored(scene), ElementsAre(HasSubstr("power of an area light")));
}

TEST_F(PbrtLight, EmissionLeavesTheSideOfTheNormal) {
  const auto side = [&](const std::string& before) {
    const Scene scene = load_world(before + "\nAreaLightSource \"diffuse\"\n" + kTriangle);
    return front(scene).z;
  };
  EXPECT_EQ(side(""), 1);
  EXPECT_EQ(side("ReverseOrientation"), -1);
  EXPECT_EQ(side("Scale -1 1 1"), 1);   // swaps handedness: the normal is turned back
  EXPECT_EQ(side("Scale 1 1 -1"), -1);  // the triangle's own normal is carried to -z
  EXPECT_EQ(side("Scale 1 1 -1\nReverseOrientation"), 1);
  EXPECT_NEAR(side("Rotate 180 1 0 0"), -1, 1e-6);
}

TEST_F(PbrtLight, PicturesEmitThroughTheirTexture) {
  image::Image picture(2, 1, 3);
  picture.set_rgb(0, 0, {8, 0, 0});
  picture.set_rgb(1, 0, {0, 4, 2});
  image::write_exr(dir_ / "light.exr", {{"", &picture}});
  const std::string square = "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]\n";
  const Scene scene = load_world(
      "AreaLightSource \"diffuse\" \"string filename\" \"light.exr\" \"float scale\" 3\n" + square);
  Rgb albedo, emission;
  // The first triangle is (0,0) (1,0) (1,1); near its corner (1,0) lies the right texel.
  evaluate_appearance(scene, 0, 0, 0.9f, 0.05f, 0, &albedo, &emission);
  expect_near(emission, {0, 12, 6}, 0.15f);  // 8 bits of the curve near 1/4: 0.5 % each
  const Scene powered = load_world(
      "AreaLightSource \"diffuse\" \"string filename\" \"light.exr\" \"float power\" 10\n" +
      square);
  // Mean luminance: half of each texel's. Total: pi * area * mean = 10.
  const float mean = (luminance(Rgb{8, 0, 0}) + luminance(Rgb{0, 4, 2})) / 2;
  evaluate_appearance(powered, 0, 0, 0.9f, 0.05f, 0, &albedo, &emission);
  EXPECT_NEAR(emission.y, 4 / mean * 10 / M_PI, 0.2);
}

TEST_F(PbrtLight, PointLight) {
  const PunctualLight light = this->light(
      "Translate 1 2 3 Scale 5 5 5\nLightSource \"point\" \"rgb I\" [1 2 3] \"float scale\" 2 "
      "\"point3 from\" [1 0 0]");
  EXPECT_EQ(light.kind, LightKind::Point);
  expect_near(light.position, {6, 2, 3});
  EXPECT_EQ(light.intensity, (Rgb{2, 4, 6}));
  EXPECT_EQ(light.light_group, 0);
  EXPECT_NEAR(this->light("LightSource \"point\" \"float power\" 100").intensity.x,
              100 / (4 * M_PI), 1e-4);
  EXPECT_THAT(notes_, IsEmpty());
}

TEST_F(PbrtLight, DistantLight) {
  const PunctualLight light = this->light(
      "Rotate 90 1 0 0\nLightSource \"distant\" \"rgb L\" [3 2 1] \"point3 from\" [0 5 0] "
      "\"point3 to\" [0 0 0]");
  EXPECT_EQ(light.kind, LightKind::Directional);
  expect_near(light.direction, {0, 0, -1});
  EXPECT_EQ(light.intensity, (Rgb{3, 2, 1}));
  const PunctualLight lit = this->light("LightSource \"distant\" \"float illuminance\" 7");
  expect_near(lit.direction, {0, 0, 1});
  EXPECT_NEAR(lit.intensity.x, 7, 1e-5);
}

TEST_F(PbrtLight, SpotLight) {
  const PunctualLight light = this->light(
      "LightSource \"spot\" \"rgb I\" [1 1 1] \"point3 from\" [0 3 0] \"point3 to\" [0 0 0] "
      "\"float coneangle\" 40 \"float conedeltaangle\" 10");
  EXPECT_EQ(light.kind, LightKind::Spot);
  expect_near(light.position, {0, 3, 0});
  expect_near(light.direction, {0, -1, 0});
  EXPECT_NEAR(light.outer_cone * 180 / M_PI, 40, 1e-4);
  EXPECT_NEAR(light.inner_cone * 180 / M_PI, 30, 1e-4);
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("falloff")));
  // A hard edge: power over the solid angle of the cone.
  const PunctualLight hard = this->light(
      "LightSource \"spot\" \"float power\" 9 \"float coneangle\" 60 \"float conedeltaangle\" 0");
  EXPECT_NEAR(hard.intensity.x, 9 / (2 * M_PI * 0.5), 1e-4);
  EXPECT_THAT(notes_, IsEmpty());
}

TEST_F(PbrtLight, OtherKindsAreNoted) {
  const Scene scene = load_world(
      "LightSource \"goniometric\"\nLightSource \"goniometric\"\nLightSource \"laser\"\n"
      "AreaLightSource \"striped\"\n" +
      kTriangle);
  EXPECT_THAT(scene.lights, IsEmpty());
  EXPECT_THAT(scene.light_groups, IsEmpty());
  EXPECT_THAT(
      ignored(scene),
      ElementsAre(
          "LightSource \"goniometric\": not supported, ignored (2 times, first at scene.pbrt:2)",
          "unknown LightSource \"laser\" (scene.pbrt:4)",
          "AreaLightSource \"striped\" (scene.pbrt:5)"));
}

}  // namespace
}  // namespace lte::scene
