// PBRT: infinite lights become the scene's environment.
#include "lte/image/exr.h"
#include "tests/scene/pbrt/fixture.h"

namespace lte::scene {
namespace {

using test::expect_near;
using test::kTriangle;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class PbrtInfinite : public test::PbrtTest {
 protected:
  Environment environment(const std::string& directives) {
    const Scene scene = load_world(directives + "\n" + kTriangle);
    notes_ = ignored(scene);
    EXPECT_THAT(scene.light_groups, ElementsAre("environment"));
    EXPECT_EQ(scene.environment->light_group, 0);
    return *scene.environment;
  }
  Rgb constant(const std::string& params) {
    const Environment out = environment("LightSource \"infinite\" " + params);
    EXPECT_EQ(out.map, nullptr);
    return out.radiance;
  }
  std::string failure(const std::string& params) {
    return error("WorldBegin\nLightSource \"infinite\" " + params + "\n" + kTriangle);
  }
  /// A picture of four texels, black but for `value` at one of them.
  void write_picture(int x, int y, const Rgb& value) {
    image::Image image(2, 2, 3);
    image.set_rgb(x, y, value);
    image::write_exr(dir_ / "sky.exr", {{"", &image}});
  }
  std::vector<std::string> notes_;
};

TEST_F(PbrtInfinite, ConstantsAreRadiance) {
  EXPECT_EQ(constant(""), (Rgb{1, 1, 1}));
  EXPECT_EQ(constant("\"rgb L\" [1 2 3] \"float scale\" 2"), (Rgb{2, 4, 6}));
  expect_near(constant("\"float illuminance\" 10"), Rgb{1, 1, 1} * (10 / kPi));
  expect_near(constant("\"rgb L\" [2 2 2] \"float illuminance\" 10"), Rgb{2, 2, 2} * (10 / kPi));
  EXPECT_NEAR(luminance(constant("\"blackbody L\" 6500 \"float scale\" 3")), 3, 1e-4);
  EXPECT_THAT(notes_, IsEmpty());
}

TEST_F(PbrtInfinite, SeveralAddUp) {
  EXPECT_EQ(environment("LightSource \"infinite\" \"rgb L\" [1 2 3]\n"
                        "LightSource \"infinite\" \"rgb L\" [1 1 1]")
                .radiance,
            (Rgb{2, 3, 4}));
  write_picture(1, 0, {4, 4, 4});
  const std::string sky = "LightSource \"infinite\" \"string filename\" \"sky.exr\"\n";
  const std::string fill = "LightSource \"infinite\" \"rgb L\" [1 2 3]\n";
  for (const std::string& both : {sky + fill, fill + sky}) {
    const Environment out = environment(both);
    expect_near(out.radiance_from(normalize({1, -1, 0.1f})), {5, 6, 7});
    expect_near(out.radiance_from(normalize({-1, -1, 0.1f})), {1, 2, 3});
  }
  environment(sky + sky);
  EXPECT_THAT(notes_, ElementsAre("second infinite light with a picture: ignored (scene.pbrt:3)"));
}

/// Texel (1, 0) of 2x2, top right, covers x > 0, y < 0 of the light's frame: u grows with x, v,
/// downwards, with y.
TEST_F(PbrtInfinite, PicturesLieAsInPbrt) {
  write_picture(1, 0, {4, 6, 8});
  const std::string light = "LightSource \"infinite\" \"string filename\" \"sky.exr\"";
  for (const float z : {0.3f, -0.3f}) {
    const Environment out = environment(light);
    EXPECT_EQ(out.radiance_from(normalize({1, -1, z})), (Rgb{4, 6, 8}));
    EXPECT_EQ(out.radiance_from(normalize({1, 1, z})), (Rgb{0, 0, 0}));
    EXPECT_EQ(out.radiance_from(normalize({-1, -1, z})), (Rgb{0, 0, 0}));
  }
  // The light's frame is turned: z up, as pbrt-v4's scenes have it, to y up.
  const Environment turned = environment("Rotate -90 1 0 0\n" + light + " \"float scale\" 0.5");
  EXPECT_EQ(turned.radiance_from(normalize({1, 0.2f, 1})), (Rgb{2, 3, 4})) << "-y goes to +z";
  EXPECT_EQ(turned.radiance_from(normalize({1, 0.2f, -1})), (Rgb{0, 0, 0}));
  const Environment mirrored = environment("Scale -2 2 2\n" + light);
  EXPECT_EQ(mirrored.radiance_from(normalize({-1, -1, 0.2f})), (Rgb{4, 6, 8}));
  EXPECT_THAT(notes_, IsEmpty());
  environment("Scale 1 2 1\n" + light);
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("its transform stretches or shears")));
}

/// pbrt's own sum, which weighs texels with half their solid angle: a white picture, whose upper
/// half gives pi, comes out at 2/pi per unit of illuminance.
TEST_F(PbrtInfinite, IlluminanceOfAPictureIsPbrts) {
  constexpr int kSide = 64;
  image::Image image(kSide, kSide, 3);
  for (float& value : image.pixels) value = 3;
  image::write_exr(dir_ / "sky.exr", {{"", &image}});
  const Environment out = environment(
      "LightSource \"infinite\" \"string filename\" \"sky.exr\" \"float illuminance\" 10");
  EXPECT_NEAR(out.radiance_from({0, 0, 1}).x, 10 * 2 / M_PI, 0.01);
}

/// pbrt-v3: longitude and latitude around +z, from +x over +y on.
TEST_F(PbrtInfinite, TakesTheLatitudesOfVersion3) {
  image::Image image(4, 2, 3);
  image.set_rgb(1, 0, {1, 2, 3});  // phi in [90, 180) degrees, upper half
  image::write_exr(dir_ / "sky.exr", {{"", &image}});
  const Environment out = environment(
      "LightSource \"infinite\" \"string mapname\" \"sky.exr\" \"rgb L\" [2 2 2] "
      "\"integer nsamples\" 16");
  EXPECT_EQ(out.radiance_from(normalize({-1, 1, 0.5f})), (Rgb{2, 4, 6}));
  EXPECT_EQ(out.radiance_from(normalize({1, 1, 0.5f})), (Rgb{0, 0, 0}));
  EXPECT_EQ(out.radiance_from(normalize({-1, 1, -0.5f})), (Rgb{0, 0, 0}));
  EXPECT_EQ(out.radiance_from(normalize({-1, -1, 0.5f})), (Rgb{0, 0, 0}));
  EXPECT_THAT(notes_, IsEmpty());
}

TEST_F(PbrtInfinite, PortalsAreNoted) {
  environment(
      "LightSource \"infinite\" \"rgb L\" [1 1 1] \"point3 portal\" [0 0 0 1 0 0 1 1 0 0 1 0]");
  EXPECT_THAT(notes_, ElementsAre("portal of an infinite light: its light comes from all "
                                  "directions (scene.pbrt:2)"));
}

TEST_F(PbrtInfinite, PicturesKeepToTheLimitOfTextures) {
  write_picture(0, 0, {1, 1, 1});
  LoadLimits limits;
  limits.texture_pixels = 3;
  EXPECT_THAT(
      error("WorldBegin\nLightSource \"infinite\" \"string filename\" \"sky.exr\"\n" + kTriangle,
            limits),
      HasSubstr("exceed the limit \"pixels\" of 3"));
}

TEST_F(PbrtInfinite, BrokenOnesAreErrorsWithAPlace) {
  write_picture(0, 0, {1, 1, 1});
  EXPECT_THAT(failure("\"string filename\" \"sky.exr\" \"rgb L\" [1 1 1]"),
              HasSubstr("scene.pbrt:2: LightSource \"infinite\" has both"));
  EXPECT_THAT(failure("\"string filename\" \"none.exr\""), HasSubstr("none.exr"));
  EXPECT_THAT(failure("\"float scale\" -1"), HasSubstr("negative"));
  EXPECT_THAT(failure("\"string filename\" \"sky.exr\" \"float scale\" -1"), HasSubstr("negative"));
  image::Image image(4, 2, 3);
  image::write_exr(dir_ / "wide.exr", {{"", &image}});
  EXPECT_THAT(failure("\"string filename\" \"wide.exr\""), HasSubstr("4x2"));
  image.at(2, 1)[0] = INFINITY;
  image::write_exr(dir_ / "wide.exr", {{"", &image}});
  EXPECT_THAT(failure("\"string mapname\" \"wide.exr\""), HasSubstr("pixel 2, 1 is not finite"));
  image = image::Image(2, 2, 3);
  image::write_exr(dir_ / "black.exr", {{"", &image}});
  EXPECT_THAT(failure("\"string filename\" \"black.exr\" \"float illuminance\" 1"),
              HasSubstr("upper half is black"));
}

}  // namespace
}  // namespace lte::scene
