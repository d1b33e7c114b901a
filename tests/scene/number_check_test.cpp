// Numbers that the path tracer cannot take are refused at load, whatever the format.
#include "lte/scene/number_check.h"

#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/image/exr.h"
#include "lte/scene/import/environment_file.h"
#include "lte/scene/load.h"
#include "tests/scene/gltf/gltf_builder.h"
#include "tests/support/scenes.h"
#include "tests/support/temp_dir.h"

namespace lte::scene {
namespace {

using test::Json;
using ::testing::AllOf;
using ::testing::HasSubstr;

class NumberCheck : public ::testing::Test {
 protected:
  Scene load(const std::string& name, const std::string& text) {
    test::write_text(dir_ / name, text);
    return load_scene(dir_ / name);
  }
  std::string error(const std::string& name, const std::string& text) {
    return test::error_of([&] { load(name, text); });
  }
  /// A triangle whose node and material `change` may spoil.
  std::string gltf_error(const std::function<void(Json&)>& change) {
    test::GltfBuilder builder;
    Json triangle = builder.triangle();
    triangle["material"] = 0;
    builder.json["materials"] = {{{"name", "paint"}}};
    builder.mesh(triangle);
    builder.json["meshes"][0]["name"] = "leaf";
    change(builder.json);
    builder.save_embedded(dir_ / "scene.gltf");
    return test::error_of([&] { load_scene(dir_ / "scene.gltf"); });
  }

  test::TempDir dir_;
};

std::string obj(const std::string& x) {
  return "v 0 0 0\nv 1 0 0\nv " + x + " 1 0\no leaf\nf 1 2 3\n";
}

std::string ply(const std::string& x) {
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
         "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0 1 0 0 " +
         x + " 1 0 3 0 1 2\n";
}

std::string pbrt(const std::string& before, const std::string& x) {
  return "WorldBegin\n" + before + "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 " + x +
         " 1 0] \"integer indices\" [0 1 2]\n";
}

TEST_F(NumberCheck, AVertexTooFarIsNamedInEveryFormat) {
  for (const std::string x : {"1e19", "-2e18", "1.1e9", "3e38"}) {
    const auto expected = AllOf(HasSubstr("vertex 2 lies at ("), HasSubstr("at most 1e+09"));
    EXPECT_THAT(error("a.obj", obj(x)), AllOf(HasSubstr("a.obj: mesh \"leaf\": "), expected));
    EXPECT_THAT(error("a.ply", ply(x)), AllOf(HasSubstr("a.ply: mesh \"a\": "), expected));
    EXPECT_THAT(error("a.pbrt", pbrt("", x)), AllOf(HasSubstr("a.pbrt: mesh \""), expected));
  }
  for (const std::string x : {"1e9", "-1e9", "1e-30"}) {
    EXPECT_EQ(load("a.obj", obj(x)).triangle_count(), 1);
    EXPECT_EQ(load("a.ply", ply(x)).triangle_count(), 1);
    EXPECT_EQ(load("a.pbrt", pbrt("", x)).triangle_count(), 1);
  }
}

TEST_F(NumberCheck, AVertexThatNoTriangleUsesMayBeAnywhere) {
  std::string text = ply("0");
  text.replace(text.find("vertex 3"), 8, "vertex 4");
  text.replace(text.find(" 3 0 1 2"), 8, " 1e30 0 0 3 0 1 2");
  const Scene scene = load("a.ply", text);
  EXPECT_EQ(scene.meshes[0].positions.size(), 4u);
}

TEST_F(NumberCheck, ColorsOfVerticesAreFinite) {
  Scene scene;
  test::add_quad(&scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, test::add_material(&scene, {1, 1, 1}));
  scene.meshes[0].colors = {{1, 1, 1}, {0, 0, 0}, {0, std::nanf(""), 0}, {1, 1, 1}};
  EXPECT_THAT(test::error_of([&] { check_numbers("file", scene); }),
              HasSubstr("file: mesh \"quad\": the color of vertex 2 is not finite"));
}

TEST_F(NumberCheck, TransformsCount) {
  EXPECT_THAT(error("a.pbrt", pbrt("Scale 1e10 1 1\n", "0")),
              HasSubstr("vertex 1 lies at (1e+10, "));
  EXPECT_THAT(error("a.pbrt", pbrt("Translate 0 0 -1e12\n", "0")), HasSubstr("vertex 0 lies at ("));
  EXPECT_EQ(load("a.pbrt", pbrt("Scale 1e-6 1 1\n", "1e12")).triangle_count(), 1);
  EXPECT_THAT(gltf_error([](Json& json) {
                json["nodes"][0]["translation"] = {0, 1e19, 0};
              }),
              AllOf(HasSubstr("scene.gltf: mesh \"leaf\": vertex 0 lies at (0, 1e+19, 0)"),
                    HasSubstr("at most 1e+09")));
  EXPECT_THAT(gltf_error([](Json& json) {
                json["nodes"][0]["scale"] = {1, 1, 1e-9};
              }),
              AllOf(HasSubstr("mesh \"leaf\": its node scales by 1e-09"), HasSubstr("1e-08")));
}

/// The frame of such an instance would take rays beyond what Embree traces, so it is not traced.
TEST_F(NumberCheck, WhatIsHiddenByATinyScaleLoads) {
  EXPECT_EQ(load("a.pbrt", pbrt("", "0") + pbrt("Scale 1e-20 1e-20 1e-20\n", "0").substr(11))
                .triangle_count(),
            2);
}

TEST_F(NumberCheck, LightsAndCamerasAreNamed) {
  const auto punctual = [](const Json& light, const Json& place) {
    return [=](Json& json) {
      json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({light});
      json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
      json["nodes"].push_back({{"translation", place}, {"children", {0}}});
      json["nodes"][0].erase("mesh");
      json["nodes"].push_back({{"mesh", 0}});
      json["scenes"] = {{{"nodes", {1, 2}}}};
    };
  };
  EXPECT_THAT(gltf_error(punctual({{"name", "bulb"}, {"type", "point"}}, {0, 2e9, 0})),
              HasSubstr("light \"bulb\" lies at (0, 2e+09, 0); expected"));
  EXPECT_THAT(
      gltf_error(punctual({{"name", "bulb"}, {"type", "point"}, {"intensity", 1e30}}, {0, 1, 0})),
      HasSubstr("light \"bulb\": its intensity is (1e+30, 1e+30, 1e+30); expected at most"));
  EXPECT_THAT(gltf_error(punctual({{"name", "sun"}, {"type", "directional"}, {"intensity", 1e30}},
                                  {0, 1, 0})),
              HasSubstr("light \"sun\": its intensity"));
  Scene scene;
  scene.cameras.emplace_back();
  scene.cameras[0].name = "view";
  scene.cameras[0].origin = {0, 0, -3e9f};
  EXPECT_THAT(test::error_of([&] { check_numbers("file", scene); }),
              HasSubstr("file: camera \"view\" lies at (0, 0, -3e+09); expected"));
  EXPECT_THAT(gltf_error([](Json& json) {
                json["materials"][0]["emissiveFactor"] = {1, 1, 1};
                json["materials"][0]["extensions"]["KHR_materials_emissive_strength"] = {
                    {"emissiveStrength", 1e13}};
              }),
              HasSubstr("material \"paint\": its radiance is (1e+13, 1e+13, 1e+13)"));
  EXPECT_THAT(error("a.pbrt", "WorldBegin\nLightSource \"infinite\" \"rgb L\" [1e20 0 0]\n" +
                                  pbrt("", "0").substr(11)),
              HasSubstr("environment: its radiance is ("));
}

TEST_F(NumberCheck, EnvironmentsOfFlagsToo) {
  Scene scene;
  EXPECT_THAT(test::error_of([&] { set_environment("1e13,0,0", 0, &scene); }),
              HasSubstr("environment 1e13,0,0: its radiance is (1e+13, 0, 0)"));
  image::Image picture(2, 1, 3);
  picture.pixels = {1, 1, 1, 0, 2e12f, 0};
  image::write_exr(dir_ / "sky.exr", {{"", &picture}});
  EXPECT_THAT(test::error_of([&] { set_environment((dir_ / "sky.exr").string(), 0, &scene); }),
              HasSubstr("texel 1, 0 of its picture has radiance (0, 2e+12, 0)"));
}

TEST(InverseStretch, IsThatOfTheInverse) {
  EXPECT_NEAR(inverse_stretch(test::scaling({2, 4, 0.5f})), 2, 1e-6);
  EXPECT_NEAR(inverse_stretch(test::rotation({0, 0, 1}, 0.7f)), std::cos(0.7) + std::sin(0.7),
              1e-6);
  EXPECT_NEAR(inverse_stretch(test::scaling({1e-20f, 1, 1})), 1e20, 1e15);
  EXPECT_TRUE(std::isinf(inverse_stretch(test::scaling({0, 1, 1}))));
  Affine shear;  // x' = x + 3 y, whose inverse is x = x' - 3 y'
  shear.m[0][1] = 3;
  EXPECT_NEAR(inverse_stretch(shear), 4, 1e-6);
}

}  // namespace
}  // namespace lte::scene
