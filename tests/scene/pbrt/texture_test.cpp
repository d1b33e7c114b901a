// PBRT: textures and their encodings, mappings and combinations.
#include "lte/image/exr.h"
#include "lte/image/png.h"
#include "lte/image/tonemap.h"
#include "lte/scene/shading_normal.h"
#include "lte/scene/surface.h"
#include "tests/scene/pbrt/fixture.h"

namespace lte::scene {
namespace {

using test::expect_near;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The unit square with uv = xy, as one patch.
const std::string kSquare = "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]\n";

class PbrtTexture : public test::PbrtTest {
 protected:
  PbrtTexture() {
    // 2 x 2, top row first: codes 51, 102 / 153, 204 of 255 in every channel.
    image::Image picture(2, 2, 3);
    for (int i = 0; i < 4; ++i) {
      const float v = 0.2f * static_cast<float>(i + 1);
      picture.set_rgb(i % 2, i / 2, {v, v, v});
    }
    image::write_png(dir_ / "four.png", picture);
  }

  /// `textures` must define "t".
  void use(const std::string& textures) {
    scene_ =
        load_world(textures + "\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n" + kSquare);
  }
  void use_image(const std::string& params) {
    use("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\" " + params);
  }

  /// Albedo at (x, y) of the square.
  Rgb at(float x, float y) const {
    Rgb albedo, emission;
    // Triangles (0,0) (1,0) (1,1) and (0,0) (1,1) (0,1).
    if (x >= y) {
      evaluate_appearance(scene_, 0, 0, x - y, y, 0, &albedo, &emission);
    } else {
      evaluate_appearance(scene_, 0, 1, x, y - x, 0, &albedo, &emission);
    }
    return albedo;
  }

  Scene scene_;
};

TEST_F(PbrtTexture, NormalMapsOfMaterials) {
  scene_ = load_world("Material \"diffuse\" \"string normalmap\" \"four.png\"\n" + kSquare +
                      "Material \"diffuse\" \"string normalmap\" \"gone.png\"\n" + kSquare);
  EXPECT_THAT(ignored(scene_), ElementsAre(HasSubstr("normal map that is not there")));
  ASSERT_EQ(scene_.textures.size(), 1u);
  EXPECT_FALSE(scene_.textures[0]->srgb());
  EXPECT_EQ(test::material_of(scene_, 0).normal_texture.texture, 0);
  EXPECT_EQ(test::material_of(scene_, 1).normal_texture.texture, kNone);
  // Rows upwards are +y of the square: (51, 51, 51) is code 128 − 77 in x and y, z below 0.
  const Vec3 n = shading_normal(scene_, 0, 1, 0.25f, 0.5f, 0, {0, 0, 1});
  EXPECT_LT(n.x, 0);
  EXPECT_LT(n.y, 0);
}

TEST_F(PbrtTexture, PicturesStandUprightInUv) {
  use_image("\"string encoding\" \"linear\"");
  EXPECT_NEAR(at(0.25f, 0.75f).x, 0.2f, 1e-5);
  EXPECT_NEAR(at(0.75f, 0.75f).x, 0.4f, 1e-5);
  EXPECT_NEAR(at(0.25f, 0.25f).x, 0.6f, 1e-5);
  EXPECT_NEAR(at(0.75f, 0.25f).x, 0.8f, 1e-5);
  EXPECT_THAT(scene_.ignored, IsEmpty());
}

TEST_F(PbrtTexture, Encodings) {
  use_image("");
  EXPECT_NEAR(at(0.25f, 0.25f).x, image::srgb_to_linear(0.6f), 1e-5);
  use_image("\"string encoding\" \"sRGB\"");
  EXPECT_NEAR(at(0.25f, 0.25f).x, image::srgb_to_linear(0.6f), 1e-5);
  use_image("\"string encoding\" \"gamma 2\"");
  EXPECT_NEAR(at(0.25f, 0.25f).x, 0.36f, 0.003);  // stored again in 8 bits
}

TEST_F(PbrtTexture, MappingWrapScaleAndInvert) {
  use_image("\"string encoding\" \"linear\" \"float udelta\" 0.5 \"float vdelta\" 0.5");
  EXPECT_NEAR(at(0.25f, 0.25f).x, 0.4f, 1e-5);  // half a picture on, in both directions
  use_image("\"string encoding\" \"linear\" \"float uscale\" 2 \"float vscale\" 2");
  for (const float x : {0.125f, 0.625f}) EXPECT_NEAR(at(x, 0.125f).x, 0.6f, 1e-5);
  use_image(
      "\"string encoding\" \"linear\" \"float uscale\" 2 \"float vscale\" 2 \"string wrap\" "
      "\"clamp\"");
  EXPECT_NEAR(at(0.9f, 0.1f).x, 0.8f, 1e-5);
  EXPECT_NEAR(at(0.9f, 0.9f).x, 0.4f, 1e-5);
  use_image("\"string encoding\" \"linear\" \"float scale\" 0.5");
  EXPECT_NEAR(at(0.75f, 0.25f).x, 0.4f, 1e-5);
  use_image("\"string encoding\" \"linear\" \"bool invert\" true");
  EXPECT_NEAR(at(0.75f, 0.25f).x, 0.2f, 0.003);
  EXPECT_NEAR(at(0.25f, 0.75f).x, 0.8f, 0.004);
  use_image("\"string wrap\" \"black\" \"string mapping\" \"planar\"");
  EXPECT_THAT(ignored(scene_),
              ElementsAre("wrap \"black\" of a texture: clamped instead (scene.pbrt:2)",
                          "mapping \"planar\" of a texture: uv taken (scene.pbrt:2)"));
}

TEST_F(PbrtTexture, FloatPicturesKeepValuesAboveOne) {
  image::Image picture(2, 1, 3);
  picture.set_rgb(0, 0, {0.25f, 0.5f, 1});
  picture.set_rgb(1, 0, {4, 4, 4});
  image::write_exr(dir_ / "t.exr", {{"", &picture}});
  use("Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"t.exr\" \"float scale\" .25\n"
      "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"i\" \"float scale\" 1");
  expect_near(at(0.25f, 0.5f), {0.0625f, 0.125f, 0.25f}, 0.003f);
  expect_near(at(0.75f, 0.5f), {1, 1, 1}, 1e-5f);
}

TEST_F(PbrtTexture, ScaleByAConstantIsExact) {
  use("Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\" \"string "
      "encoding\" "
      "\"linear\"\n"
      "Texture \"c\" \"spectrum\" \"constant\" \"rgb value\" [.5 .25 1]\n"
      "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"i\" \"texture scale\" \"c\"");
  expect_near(at(0.75f, 0.25f), {0.4f, 0.2f, 0.8f});
  EXPECT_EQ(scene_.textures.size(), 1u);
  EXPECT_EQ(scene_.textures[0]->width(), 2);
}

TEST_F(PbrtTexture, MixturesOfPicturesAreBaked) {
  use("Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\" \"string "
      "encoding\" "
      "\"linear\" \"float uscale\" 3 \"float vscale\" 3\n"
      "Texture \"t\" \"spectrum\" \"mix\" \"texture tex1\" \"i\" \"rgb tex2\" [1 0 0] "
      "\"float amount\" .25");
  ASSERT_EQ(scene_.textures.size(), 1u);
  EXPECT_EQ(scene_.textures[0]->width(), 2);  // in the picture's own st: no texel is lost
  // Texel (1, bottom) = 0.8; st = (2.25, 0.75) folds to (0.25, 0.75): 0.2.
  expect_near(at(0.25f, 0.25f / 3), {.75f * .8f + .25f, .75f * .8f, .75f * .8f}, 0.0045f);
  expect_near(at(0.75f, 0.25f), {.75f * .2f + .25f, .75f * .2f, .75f * .2f},
              0.0045f);  // half a step of 8 bits
}

TEST_F(PbrtTexture, Checkerboards) {
  use("Texture \"t\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [1 0 0] \"rgb tex2\" [0 0 1] "
      "\"float uscale\" 4 \"float vscale\" 2");
  const auto color = [](int cell) { return cell % 2 == 0 ? Rgb{1, 0, 0} : Rgb{0, 0, 1}; };
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 2; ++j) {
      const float x = (static_cast<float>(i) + 0.5f) / 4, y = (static_cast<float>(j) + 0.5f) / 2;
      expect_near(at(x, y), color(i + j));
      expect_near(at(x + 0.11f, y - 0.2f), color(i + j));  // near the edges of its square, too
    }
  }
}

TEST_F(PbrtTexture, DifferentMappingsAreBakedOverTheUnitSquare) {
  const std::string check =
      "Texture \"c\" \"float\" \"checkerboard\" \"float uscale\" 2 \"float vscale\" 2\n";
  const auto with_scale = [&](const std::string& scale) {
    use(check +
        "Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\" "
        "\"string encoding\" \"linear\" \"float uscale\" " +
        scale +
        "\n"
        "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"i\" \"texture scale\" \"c\"");
  };
  with_scale("1");
  expect_near(at(0.25f, 0.25f), {.6f, .6f, .6f}, 0.01f);  // an even square
  expect_near(at(0.75f, 0.25f), {0, 0, 0}, 0.01f);        // an odd one
  EXPECT_THAT(scene_.ignored, IsEmpty());
  with_scale("1.5");
  EXPECT_THAT(ignored(scene_), ElementsAre(HasSubstr("different mappings")));
}

TEST_F(PbrtTexture, OnePictureIsDecodedOnce) {
  use("Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\"\n"
      "Texture \"b\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\" \"float scale\" "
      ".5\n"
      "Texture \"unused\" \"float\" \"imagemap\" \"string filename\" \"nowhere.png\"\n"
      "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"a\" \"float scale\" 1\n"
      "Material \"diffuse\" \"texture reflectance\" \"b\"\n" +
      kSquare);
  EXPECT_EQ(scene_.materials.size(), 2u);
  EXPECT_EQ(scene_.textures.size(), 1u);
}

TEST_F(PbrtTexture, TrianglesWithoutCoordinatesGetThoseOfPbrt) {
  const Scene scene = load_world(
      "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\"\n"
      "Material \"diffuse\" \"texture reflectance\" \"t\"\n"
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0] \"integer indices\" "
      "[0 1 2 0 2 3]");
  const Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.uvs[0].size(), 6u);
  for (const auto& [a, b, c] : mesh.triangles) {
    EXPECT_EQ(mesh.uvs[0][a].x, 0);
    EXPECT_EQ(mesh.uvs[0][b].x, 1);
    EXPECT_EQ(mesh.uvs[0][b].y, 0);
    EXPECT_EQ(mesh.uvs[0][c].y, 1);
  }
  EXPECT_THAT(ignored(scene), ElementsAre(HasSubstr("texture on a shape without uv")));
}

TEST_F(PbrtTexture, UnknownOnesAreNoted) {
  use("Texture \"t\" \"spectrum\" \"marble\" \"float scale\" 3");
  EXPECT_NEAR(at(0.5f, 0.5f).x, 0.5f, 1e-6);
  EXPECT_THAT(ignored(scene_), ElementsAre("Texture \"marble\": 0.5 taken (scene.pbrt:2)"));
}

}  // namespace
}  // namespace lte::scene
