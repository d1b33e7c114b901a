// PBRT: transforms, attribute blocks, objects, files, the camera.
#include "tests/scene/pbrt/fixture.h"

namespace lte::scene {
namespace {

using test::expect_near;
using test::front;
using test::kTriangle;
using test::world_positions;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class PbrtTransform : public test::PbrtTest {
 protected:
  /// Where the triangle's corners (0,0,0), (1,0,0), (0,1,0) go.
  std::vector<Vec3> moved(const std::string& directives) {
    return world_positions(load_world(directives + "\n" + kTriangle), 0);
  }
  void expect_moved(const std::string& directives, const Vec3& a, const Vec3& b, const Vec3& c) {
    SCOPED_TRACE(directives);
    const std::vector<Vec3> got = moved(directives);
    ASSERT_EQ(got.size(), 3u);
    expect_near(got[0], a);
    expect_near(got[1], b);
    expect_near(got[2], c);
  }
};

TEST_F(PbrtTransform, LaterDirectivesApplyFirst) {
  expect_moved("Translate 1 2 3", {1, 2, 3}, {2, 2, 3}, {1, 3, 3});
  expect_moved("Translate 1 2 3 Scale 2 3 4", {1, 2, 3}, {3, 2, 3}, {1, 5, 3});
  expect_moved("Scale 2 3 4 Translate 1 2 3", {2, 6, 12}, {4, 6, 12}, {2, 9, 12});
}

TEST_F(PbrtTransform, RotatesCounterClockwiseAboutEachAxis) {
  expect_moved("Rotate 90 0 0 1", {0, 0, 0}, {0, 1, 0}, {-1, 0, 0});
  expect_moved("Rotate 90 0 1 0", {0, 0, 0}, {0, 0, -1}, {0, 1, 0});
  expect_moved("Rotate 90 2 0 0", {0, 0, 0}, {1, 0, 0}, {0, 0, 1});
  // A third of a turn about the diagonal permutes the axes.
  expect_moved("Rotate 120 1 1 1", {0, 0, 0}, {0, 1, 0}, {0, 0, 1});
}

TEST_F(PbrtTransform, MatricesAreInColumnOrder) {
  const std::string columns = "[0 2 0 0  -1 0 0 0  0 0 1 0  5 6 7 1]";
  expect_moved("Transform " + columns, {5, 6, 7}, {5, 8, 7}, {4, 6, 7});
  expect_moved("Translate 1 0 0 Transform " + columns, {5, 6, 7}, {5, 8, 7}, {4, 6, 7});
  expect_moved("Translate 1 0 0 ConcatTransform " + columns, {6, 6, 7}, {6, 8, 7}, {5, 6, 7});
  expect_moved("Translate 9 9 9 Identity", {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
}

TEST_F(PbrtTransform, LookAtPutsTheTargetAheadOfTheEye) {
  // The frame of an eye at (0,0,5) that looks down -z: x right is -x of the world.
  expect_moved("LookAt 0 0 5  0 0 0  0 1 0", {0, 0, 5}, {-1, 0, 5}, {0, 1, 5});
}

TEST_F(PbrtTransform, NamedCoordinateSystemsComeBack) {
  expect_moved("Translate 1 0 0 CoordinateSystem \"here\" Scale 9 9 9 CoordSysTransform \"here\"",
               {1, 0, 0}, {2, 0, 0}, {1, 1, 0});
  const Scene scene = load_world("CoordSysTransform \"nowhere\"\n" + kTriangle);
  EXPECT_THAT(ignored(scene),
              ElementsAre("CoordSysTransform: no coordinate system \"nowhere\" (scene.pbrt:2)"));
}

TEST_F(PbrtTransform, CameraIsACoordinateSystem) {
  // One unit ahead of an eye at (1, 2, 3) that looks along +z.
  const Scene scene = load(
      "LookAt 1 2 3  1 2 9  0 1 0\nCamera \"perspective\"\nWorldBegin\n"
      "CoordSysTransform \"camera\"\nTranslate 0 0 1\n" +
      kTriangle);
  expect_near(world_positions(scene, 0)[0], {1, 2, 4});
}

TEST_F(PbrtTransform, WorldBeginForgetsTheCamera) {
  const Scene scene = load("Translate 7 7 7\nWorldBegin\n" + kTriangle);
  expect_near(world_positions(scene, 0)[0], {0, 0, 0});
}

TEST_F(PbrtTransform, BlocksRestoreWhatTheyChanged) {
  const Scene scene = load_world(
      "Material \"diffuse\" \"rgb reflectance\" [.1 .2 .3]\n"
      "AttributeBegin Translate 1 0 0 Material \"diffuse\" \"rgb reflectance\" [.9 .9 .9]\n"
      "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1]\nReverseOrientation\n" +
      kTriangle + "AttributeEnd\n" + kTriangle + "TransformBegin Scale 3 3 3 TransformEnd\n" +
      kTriangle);
  ASSERT_EQ(scene.instances.size(), 3u);
  expect_near(world_positions(scene, 0)[0], {1, 0, 0});
  EXPECT_EQ(test::material_of(scene, 0).base_color, (Rgb{.9f, .9f, .9f}));
  EXPECT_TRUE(test::material_of(scene, 0).emissive());
  expect_near(front(scene, 0), {0, 0, -1});
  for (const size_t i : {1u, 2u}) {
    expect_near(world_positions(scene, i)[1], {1, 0, 0});
    EXPECT_EQ(test::material_of(scene, i).base_color, (Rgb{.1f, .2f, .3f}));
    EXPECT_FALSE(test::material_of(scene, i).emissive());
    expect_near(front(scene, i), {0, 0, 1});
  }
}

TEST_F(PbrtTransform, TheStartOfAnAnimationIsTaken) {
  const Scene scene = load_world(
      "ActiveTransform StartTime Translate 1 0 0 ActiveTransform EndTime Translate 9 0 0\n"
      "ActiveTransform All Translate 0 1 0\n" +
      kTriangle);
  expect_near(world_positions(scene, 0)[0], {1, 1, 0});
  EXPECT_THAT(ignored(scene), ElementsAre("animated transform: its start is taken (scene.pbrt:4)"));
}

TEST_F(PbrtTransform, AttributesAreDefaultsThatDirectivesOverride) {
  const Scene scene = load_world(
      "AttributeBegin\nAttribute \"shape\" \"float radius\" 2\nShape \"sphere\"\n"
      "Attribute \"shape\" \"float radius\" 3\nShape \"sphere\"\n"
      "Shape \"sphere\" \"float radius\" 4\nAttributeEnd\nShape \"sphere\"\n"
      "Attribute \"material\" \"rgb reflectance\" [.1 .1 .1]\nMaterial \"diffuse\"\n"
      "Shape \"sphere\"\n");
  ASSERT_EQ(scene.instances.size(), 5u);
  for (const auto& [instance, radius] :
       std::vector<std::pair<size_t, float>>{{0, 2.f}, {1, 3.f}, {2, 4.f}, {3, 1.f}, {4, 1.f}}) {
    EXPECT_NEAR(length(world_positions(scene, instance)[0]), radius, 1e-5) << instance;
  }
  EXPECT_EQ(test::material_of(scene, 4).base_color, (Rgb{.1f, .1f, .1f}));
}

TEST_F(PbrtTransform, ObjectsAreStoredOnceAndPlacedByBothTransforms) {
  const Scene scene = load_world(
      "Translate 0 10 0\nObjectBegin \"o\"\nTranslate 1 0 0\n" + kTriangle + "Scale 2 2 2\n" +
      kTriangle +
      "ObjectEnd\nIdentity\n"
      "ObjectInstance \"o\"\nScale -1 1 1\nObjectInstance \"o\"\nObjectInstance \"later\"\n"
      "ObjectBegin \"later\"\n" +
      kTriangle + "ObjectEnd\n");
  EXPECT_EQ(scene.meshes.size(), 3u);
  ASSERT_EQ(scene.instances.size(), 5u);
  EXPECT_EQ(scene.triangle_count(), 5);
  expect_near(world_positions(scene, 0)[1], {2, 10, 0});
  expect_near(world_positions(scene, 1)[1], {3, 10, 0});
  EXPECT_EQ(scene.instances[2].mesh, scene.instances[0].mesh);
  expect_near(world_positions(scene, 2)[1], {-2, 10, 0});
  expect_near(front(scene, 2), {0, 0, 1});  // a mirrored front stays front
}

TEST_F(PbrtTransform, AreaLightsInObjectsAreIgnoredAsInPbrt) {
  const Scene scene = load_world("AreaLightSource \"diffuse\"\nObjectBegin \"o\"\n" + kTriangle +
                                 "ObjectEnd\nObjectInstance \"o\"\n");
  EXPECT_THAT(scene.light_groups, IsEmpty());
  EXPECT_THAT(ignored(scene),
              ElementsAre("area light in an object: pbrt has none there, ignored (scene.pbrt:4)"));
}

TEST_F(PbrtTransform, EqualQuadricsAreStoredOnce) {
  const Scene scene = load_world(
      "Shape \"sphere\"\nTranslate 1 0 0\nShape \"sphere\"\n"
      "Shape \"sphere\" \"float radius\" 1.0000001\n"
      "Material \"diffuse\"\nShape \"sphere\"\n");
  EXPECT_EQ(scene.meshes.size(), 3u);
  EXPECT_EQ(scene.instances.size(), 4u);
  EXPECT_EQ(scene.instances[0].mesh, scene.instances[1].mesh);
}

TEST_F(PbrtTransform, FilesAreFoundBesideTheIncludingOneOrBesideTheScene) {
  std::filesystem::create_directories(dir_ / "parts/deep");
  write_file(dir_ / "parts/a.pbrt", "Translate 1 0 0\nInclude \"deep/b.pbrt\"\n");
  write_file(dir_ / "parts/deep/b.pbrt", "Translate 0 1 0\nInclude \"parts/c.pbrt\"\n");
  write_file(dir_ / "parts/c.pbrt", kTriangle);
  const Scene scene = load_world("Include \"parts/a.pbrt\"\n" + kTriangle);
  expect_near(world_positions(scene, 0)[0], {1, 1, 0});
  expect_near(world_positions(scene, 1)[0], {1, 1, 0}, 0);  // an Include's state goes on
}

TEST_F(PbrtTransform, ImportsKeepTheirStateToThemselves) {
  write_file(dir_ / "a.pbrt", "Translate 1 0 0\n" + kTriangle);
  const Scene scene = load_world("Import \"a.pbrt\"\n" + kTriangle);
  expect_near(world_positions(scene, 0)[0], {1, 0, 0});
  expect_near(world_positions(scene, 1)[0], {0, 0, 0});
}

class PbrtCamera : public test::PbrtTest {
 protected:
  Camera camera(const std::string& options) {
    const Scene scene = load(options + "\nWorldBegin\n" + kTriangle);
    notes_ = ignored(scene);
    EXPECT_EQ(scene.cameras.size(), 1u);
    return scene.cameras.at(0);
  }
  std::vector<std::string> notes_;
};

/// Where pbrt's camera looks at image point (x, y) in [0,1]², from its own definition: the screen
/// point is carried through the inverse of the LookAt matrix.
TEST_F(PbrtCamera, ImageIsThatOfALeftHandedFrame) {
  const Camera camera = this->camera(
      "LookAt 0 0 0  0 0 1  0 1 0\nCamera \"perspective\" \"float fov\" 90\n"
      "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100");
  EXPECT_TRUE(camera.mirrored);
  EXPECT_NEAR(camera.vfov, 90, 1e-4);  // the shorter axis is the vertical one
  // The right edge of the picture is x = +2, the top y = +1, at z = 1.
  expect_near(camera.direction(1, 0.5f, 2), normalize(Vec3{2, 0, 1}));
  expect_near(camera.direction(0.5f, 0, 2), normalize(Vec3{0, 1, 1}));
  expect_near(camera.direction(0.25f, 0.5f, 2), normalize(Vec3{-1, 0, 1}));
}

TEST_F(PbrtCamera, AMirroringScaleGivesAnOrdinaryCamera) {
  const Camera camera =
      this->camera("Scale -1 1 1\nLookAt 1 2 3  1 2 8  0 1 0\nCamera \"perspective\"");
  EXPECT_FALSE(camera.mirrored);
  EXPECT_EQ(camera.origin, (Vec3{1, 2, 3}));
  // The right edge of the picture is now at -x of the world.
  EXPECT_LT(camera.direction(1, 0.5f, 1).x, -0.5f);
}

TEST_F(PbrtCamera, FieldOfViewIsThatOfTheShorterAxis) {
  const auto vfov = [&](const std::string& rest) {
    return this->camera("Camera \"perspective\" \"float fov\" 90 " + rest).vfov;
  };
  EXPECT_NEAR(vfov(""), 90, 1e-4);  // 1280 x 720
  const std::string tall = "Film \"rgb\" \"integer xresolution\" 100 \"integer yresolution\" 200";
  EXPECT_NEAR(vfov(tall), 2 * std::atan(2.0) * 180 / M_PI, 1e-4);
  EXPECT_NEAR(vfov("\"float frameaspectratio\" 0.25"), 2 * std::atan(4.0) * 180 / M_PI, 1e-4);
  EXPECT_NEAR(vfov("\"float screenwindow\" [-1 1 -0.5 0.5]"), 2 * std::atan(0.5) * 180 / M_PI,
              1e-4);
  EXPECT_THAT(notes_, IsEmpty());
  vfov("\"float screenwindow\" [0 1 -0.5 0.5] \"float lensradius\" 0.1");
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("screenwindow off the middle"),
                                  HasSubstr("lens of the camera")));
}

TEST_F(PbrtCamera, ScaleOfTheWorldDoesNotChangeTheView) {
  const Camera camera = this->camera(
      "Scale 10 10 10\nLookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 40");
  EXPECT_NEAR(camera.vfov, 40, 1e-4);
  expect_near(camera.origin, {0, 0, 5});
  expect_near(camera.direction(0.5f, 0.5f, 1), {0, 0, -1});
}

TEST_F(PbrtCamera, OtherProjectionsAreNoted) {
  const Scene scene = load("Camera \"orthographic\"\nWorldBegin\n" + kTriangle);
  EXPECT_THAT(scene.cameras, IsEmpty());
  EXPECT_THAT(ignored(scene), ElementsAre("Camera \"orthographic\" (scene.pbrt:1)"));
}

}  // namespace
}  // namespace lte::scene
