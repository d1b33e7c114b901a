// PBRT: materials and values to albedo and metal.
#include <cmath>

#include "lte/scene/pbrt/spectrum.h"
#include "tests/scene/pbrt/fixture.h"

namespace lte::scene {
namespace {

using pbrt::named_conductor;
using test::expect_near;
using test::kTriangle;
using test::material_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class PbrtMaterial : public test::PbrtTest {
 protected:
  Rgb albedo(const std::string& directive) {
    const Scene scene = load_world(directive + "\n" + kTriangle);
    notes_ = ignored(scene);
    return material_of(scene).base_color;
  }
  std::vector<std::string> notes_;
};

TEST_F(PbrtMaterial, DiffuseIsItsReflectance) {
  EXPECT_EQ(albedo(""), (Rgb{.5f, .5f, .5f}));
  EXPECT_EQ(albedo("Material \"diffuse\""), (Rgb{.5f, .5f, .5f}));
  EXPECT_EQ(albedo("Material \"diffuse\" \"rgb reflectance\" [.1 .2 .3]"), (Rgb{.1f, .2f, .3f}));
  EXPECT_EQ(albedo("Material \"diffuse\" \"float reflectance\" .25"), (Rgb{.25f, .25f, .25f}));
  expect_near(albedo("Material \"diffuse\" \"spectrum reflectance\" [300 .4 900 .4]"),
              {.4f, .4f, .4f});
  EXPECT_THAT(notes_, IsEmpty());
  write_file(dir_ / "grey.spd", "# wavelength value\n300 0.3\n900 0.3\n");
  expect_near(albedo("Material \"diffuse\" \"spectrum reflectance\" \"grey.spd\""),
              {.3f, .3f, .3f});
}

TEST_F(PbrtMaterial, WhatIsLeftOutIsNoted) {
  EXPECT_EQ(
      albedo("Material \"coateddiffuse\" \"rgb reflectance\" [.1 .2 .3] \"float roughness\" 0"),
      (Rgb{.1f, .2f, .3f}));
  EXPECT_THAT(notes_,
              ElementsAre("Material \"coateddiffuse\": its coating is left out (scene.pbrt:2)",
                          "parameter \"roughness\" of Material \"coateddiffuse\" (scene.pbrt:2)"));
  EXPECT_EQ(albedo("Material \"diffusetransmission\""), (Rgb{.25f, .25f, .25f}));
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("transmission is left out")));
  EXPECT_EQ(albedo("Material \"dielectric\" \"float eta\" 1.5"), (Rgb{1, 1, 1}));
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("white and opaque"), HasSubstr("\"eta\"")));
  EXPECT_EQ(albedo("Material \"subsurface\" \"rgb reflectance\" [.9 .8 .7]"), (Rgb{.9f, .8f, .7f}));
  EXPECT_EQ(albedo("Material \"velvet\""), (Rgb{.5f, .5f, .5f}));
  EXPECT_THAT(notes_, ElementsAre("unknown Material \"velvet\": 0.5 taken (scene.pbrt:2)"));
  for (const char* type : {"thindielectric", "measured", "hair"}) {
    albedo(std::string("Material \"") + type + "\"");
    EXPECT_THAT(notes_, ElementsAre(HasSubstr(type)));
  }
}

TEST_F(PbrtMaterial, ConductorsReflectAtNormalIncidence) {
  const Rgb copper = albedo("Material \"conductor\" \"float roughness\" 0.1");
  EXPECT_THAT(notes_, IsEmpty());
  EXPECT_EQ(copper, *named_conductor("Cu"));
  EXPECT_EQ(albedo("Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" "
                   "\"metal-Au-k\""),
            *named_conductor("Au"));
  EXPECT_EQ(albedo("Material \"coatedconductor\" \"spectrum conductor.eta\" \"metal-Al-eta\" "
                   "\"spectrum conductor.k\" \"metal-Al-k\""),
            *named_conductor("Al"));
  EXPECT_EQ(albedo("Material \"conductor\" \"rgb reflectance\" [.9 .8 .7]"), (Rgb{.9f, .8f, .7f}));
  expect_near(albedo("Material \"conductor\" \"rgb eta\" [1 3 1] \"rgb k\" [2 0 0]"),
              {.5f, .25f, 0});
  expect_near(albedo("Material \"conductor\" \"spectrum eta\" [300 1 900 1] \"spectrum k\" "
                     "[300 2 900 2]"),
              {.5f, .5f, .5f});
  EXPECT_EQ(albedo("Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" "
                   "\"metal-Ag-k\""),
            (Rgb{.5f, .5f, .5f}));
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("not known here")));
}

TEST_F(PbrtMaterial, ConductorsAreRoughMetal) {
  const auto roughness = [&](const std::string& directive) {
    const Scene scene = load_world(directive + "\n" + kTriangle);
    notes_ = ignored(scene);
    EXPECT_EQ(material_of(scene).metallic, 1);
    return material_of(scene).roughness;
  };
  // pbrt-v4: alpha is the square root of what the file says, unless remaproughness is false; and
  // alpha here is the square of the roughness.
  EXPECT_NEAR(roughness("Material \"conductor\" \"float roughness\" .0625"), .5, 1e-6);
  EXPECT_THAT(notes_, IsEmpty());
  EXPECT_NEAR(roughness("Material \"conductor\" \"float roughness\" .25 "
                        "\"bool remaproughness\" false"),
              .5, 1e-6);
  EXPECT_EQ(roughness("Material \"conductor\""), 0);
  EXPECT_NEAR(roughness("Material \"conductor\" \"float uroughness\" .04 \"float vroughness\" .01"),
              std::pow(.04 * .01, 1 / 8.0), 1e-6);
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("anisotropic roughness")));
  EXPECT_NEAR(roughness("Material \"coatedconductor\" \"float conductor.roughness\" .0625 "
                        "\"float interface.roughness\" 1"),
              .5, 1e-6);
  EXPECT_THAT(notes_,
              ElementsAre(HasSubstr("coating is left out"), HasSubstr("interface.roughness")));
  // pbrt-v3's polynomial: at roughness 1 its logarithm is 0.
  EXPECT_NEAR(roughness("Material \"metal\" \"float roughness\" 1"), 1, 1e-6);
  EXPECT_NEAR(roughness("Material \"metal\" \"float roughness\" .01"),
              std::sqrt(1.62142 - .819955 * 4.605170 + .1734 * 21.207592 - .0171201 * 97.664578 +
                        .000640711 * 449.762),
              1e-4);
  EXPECT_EQ(roughness("Material \"mirror\""), 0);
  EXPECT_NEAR(roughness("Texture \"t\" \"float\" \"checkerboard\"\n"
                        "Material \"conductor\" \"texture roughness\" \"t\""),
              std::sqrt(.3), 1e-6);
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("texture of a conductor's roughness")));
}

TEST_F(PbrtMaterial, MixturesShareOutMetal) {
  const Scene scene = load_world(
      "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [1 0 0]\n"
      "MakeNamedMaterial \"b\" \"string type\" \"conductor\" \"rgb reflectance\" [0 1 0] "
      "\"float roughness\" .0625\n"
      "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" .25\n" +
      kTriangle);
  EXPECT_NEAR(material_of(scene).metallic, .25, 1e-6);
  EXPECT_NEAR(material_of(scene).roughness, .5, 1e-6);
  expect_near(material_of(scene).base_color, {.75f, .25f, 0});
  EXPECT_THAT(ignored(scene), ElementsAre(HasSubstr("mix with a metal")));
}

TEST_F(PbrtMaterial, NamedOnesMayBeUsedBeforeTheyAreMade) {
  const Scene scene = load_world(
      "NamedMaterial \"red\"\n" + kTriangle +
      "MakeNamedMaterial \"red\" \"string type\" \"diffuse\" \"rgb reflectance\" [1 0 0]\n" +
      kTriangle);
  EXPECT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(material_of(scene, 0).base_color, (Rgb{1, 0, 0}));
  EXPECT_EQ(material_of(scene, 0).name, "red");
}

TEST_F(PbrtMaterial, MixturesAreWeightedMeans) {
  const std::string two =
      "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [1 0 0]\n"
      "MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"rgb reflectance\" [0 1 0]\n";
  expect_near(albedo(two + "Material \"mix\" \"string materials\" [\"a\" \"b\"]"), {.5f, .5f, 0});
  expect_near(
      albedo(two + "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" .25"),
      {.75f, .25f, 0});
  EXPECT_THAT(notes_, IsEmpty());
}

TEST_F(PbrtMaterial, InterfacesAreNotSeen) {
  const Scene scene =
      load_world("Material \"interface\"\n" + kTriangle + "AreaLightSource \"diffuse\"\n" +
                 kTriangle + "Material \"diffuse\"\n" + kTriangle);
  EXPECT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.light_groups.size(), 1u);
  EXPECT_THAT(ignored(scene),
              ElementsAre("surfaces of the material \"interface\": left out (scene.pbrt:2)",
                          "area light of a shape that is left out (scene.pbrt:5)"));
}

TEST_F(PbrtMaterial, OlderAndForeignDirectivesAreNotedOrPassedOver) {
  const Scene scene = load(
      "Option \"bool disablepixeljitter\" true\nSampler \"zsobol\" \"integer pixelsamples\" 4\n"
      "Integrator \"volpath\"\nPixelFilter \"box\"\nAccelerator \"bvh\"\nColorSpace \"srgb\"\n"
      "ColorSpace \"rec2020\"\nMakeNamedMedium \"fog\" \"string type\" \"homogeneous\"\n"
      "TransformTimes 0 1\nWorldBegin\nMediumInterface \"fog\" \"\"\nMediumInterface \"fog\"\n"
      "Material \"matte\" \"color Kd\" [.1 .2 .3]\n"
      "Shape \"trianglemesh\" \"point P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\n"
      "WorldEnd\n");
  EXPECT_EQ(material_of(scene).base_color, (Rgb{.1f, .2f, .3f}));
  EXPECT_THAT(
      ignored(scene),
      ElementsAre("ColorSpace \"rec2020\": sRGB taken (scene.pbrt:7)",
                  "MakeNamedMedium \"fog\" (scene.pbrt:8)",
                  "MediumInterface (2 times, first at scene.pbrt:11)", "WorldEnd (scene.pbrt:15)",
                  "Material \"matte\": a pbrt-v3 material, Kd taken (scene.pbrt:13)"));
}

}  // namespace
}  // namespace lte::scene
