// Wavefront OBJ and MTL.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/image/png.h"
#include "lte/scene/load.h"
#include "lte/scene/surface.h"
#include "lte/scene/triangle.h"
#include "tests/scene/expect.h"
#include "tests/support/temp_dir.h"

namespace lte::scene {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Triangle = std::array<uint32_t, 3>;

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

class Obj : public ::testing::Test {
 protected:
  Scene load(const std::string& text, const LoadLimits& limits = {}) {
    test::write_text(dir_ / "model.obj", text);
    return load_scene(dir_ / "model.obj", limits);
  }

  void expect_error(const std::string& text, const std::string& line, const std::string& part) {
    EXPECT_THAT(test::error_of([&] { load(text); }),
                AllOf(HasSubstr("model.obj: " + line), HasSubstr(part)));
  }

  void write(const std::string& name, const std::string& text) {
    test::write_text(dir_ / name, text);
  }

  /// 2 x 2 texels: top left red, top right green, bottom left blue, bottom right white.
  void write_picture(const std::string& name) {
    image::Image picture(2, 2, 3);
    picture.pixels = {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    image::write_png(dir_ / name, picture);
  }

  test::TempDir dir_;
};

TEST_F(Obj, ReadsATriangle) {
  const Scene scene = load(std::string("# a comment\r\n\r\n") + kTriangle + "f 1 2 3\r\n");
  EXPECT_EQ(scene.name, "model");
  EXPECT_THAT(scene.unit, HasSubstr("assumed"));
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_THAT(scene.meshes[0].positions, ElementsAre(Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}));
  EXPECT_THAT(scene.meshes[0].triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_EQ(evaluate_surface(scene, 0, 0, 0.3f, 0.3f, 0).normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(scene.materials.at(0).base_color, (Rgb{0.5f, 0.5f, 0.5f}));
  EXPECT_THAT(scene.ignored, IsEmpty());
}

TEST_F(Obj, ReadsLinesThatEndAsOnAnOldMacintosh) {
  const Scene scene = load("# a comment\rv 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r");
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_THAT(scene.meshes[0].triangles, ElementsAre(Triangle{0, 1, 2}));
  expect_error("v 0 0 0\rv 1 0 0\rv 0 x 0\r", "line 3", "expected a number");
}

TEST_F(Obj, RefusesASceneWithoutArea) {
  expect_error("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 1 1 2\n", "", "has area");
  EXPECT_EQ(load(std::string(kTriangle) + "f 1 1 2\nf 1 2 3\n").triangle_count(), 2);
}

TEST_F(Obj, ReadsEveryFormOfCornerAndNumber) {
  const Scene scene = load(
      "v +0 0.0 -0 1.0\nv 1e0 0 0\nv 0 1.5E+0 1e-50\n"
      "vt 0.25 0.75\nvt 0.5\nvn 0 0 1\n"
      "f 1 2 3\nf 1/1 2/2 3/1\nf 1//1 2//1 3//1\nf 1/1/1 2/2/1 3/1/1\nf -3/-2/-1 -2/-1 -1/-2\n"
      "f 1 \\\n 2 \\\n 3");
  EXPECT_EQ(scene.triangle_count(), 6);
  const Mesh& mesh = scene.meshes.at(0);
  for (size_t t = 0; t < 6; ++t) {
    EXPECT_EQ(mesh.positions[mesh.triangles[t][1]], (Vec3{1, 0, 0})) << t;
    EXPECT_EQ(mesh.positions[mesh.triangles[t][2]], (Vec3{0, 1.5f, 0})) << t;
  }
  EXPECT_EQ(mesh.positions.size(), 6u) << "three without and three with texture coordinates";
  const Vec2 uv = mesh.uvs[0][mesh.triangles[4][0]];
  EXPECT_EQ(uv.x, 0.25f);
  EXPECT_EQ(uv.y, 0.25f) << "V points up in the file and down in a scene";
  EXPECT_EQ(mesh.uvs[0][mesh.triangles[1][1]].y, 1) << "a missing V is 0";
}

TEST_F(Obj, SplitsConcavePolygonsWithinTheirOutline) {
  // An arrow head whose fan from the first corner would cover the notch.
  const Scene scene = load("v 0 0 1\nv 2 2 1\nv 0 1 1\nv -2 2 1\nf 2 3 4 1\n");
  ASSERT_EQ(scene.triangle_count(), 2);
  double sum = 0;
  for (uint32_t t = 0; t < 2; ++t) {
    sum += area(world_triangle(scene.meshes[0], {}, t));
    EXPECT_GT(evaluate_surface(scene, 0, t, 0.3f, 0.3f, 0).normal.z, 0.99f);
  }
  EXPECT_NEAR(sum, 2, 1e-6);
}

TEST_F(Obj, PartsAreObjectsByMaterial) {
  write("m.mtl", "newmtl red\nKd 1 0 0\nnewmtl lamp\nKe 5 6 7\n");
  const Scene scene = load(std::string("mtllib m.mtl\n") + kTriangle +
                           "o chair\nusemtl red\nf 1 2 3\nusemtl lamp\nf 1 2 3\n"
                           "o table\nusemtl red\nf 1 2 3\no chair\nf 3 2 1\n");
  ASSERT_EQ(scene.meshes.size(), 3u);
  EXPECT_EQ(scene.meshes[0].name, "chair");
  EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
  EXPECT_EQ(scene.meshes[2].name, "table");
  EXPECT_EQ(scene.materials[static_cast<size_t>(scene.meshes[0].material)].base_color,
            (Rgb{1, 0, 0}));
  EXPECT_THAT(scene.light_groups, ElementsAre("chair"));
  EXPECT_EQ(scene.instances[1].light_group, 0);
  const Surface lamp = evaluate_surface(scene, 1, 0, 0.3f, 0.3f, 0);
  EXPECT_EQ(lamp.emission, (Rgb{5, 6, 7}));
  EXPECT_TRUE(lamp.emits_back) << "the format says nothing of sides";
}

TEST_F(Obj, GroupsNameWhatNoObjectNames) {
  const Scene scene = load(std::string(kTriangle) + "g left arm\nf 1 2 3\ng right\nf 1 2 3\n");
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].name, "left arm");
}

TEST_F(Obj, VertexColorsCarryTheSrgbCurve) {
  const Scene scene = load("v 0 0 0 1 0.5 0\nv 1 0 0\nv 0 1 0 1 0.2 0.4 0.6\nf 1 2 3\n");
  const Mesh& mesh = scene.meshes.at(0);
  ASSERT_EQ(mesh.colors.size(), 3u);
  EXPECT_EQ(mesh.colors[0].x, 1);
  EXPECT_NEAR(mesh.colors[0].y, test::decode_srgb(127.5), 1e-6);
  EXPECT_EQ(mesh.colors[1], (Rgb{1, 1, 1}));
  EXPECT_NEAR(mesh.colors[2].z, test::decode_srgb(153), 1e-6) << "x y z w r g b";
}

TEST_F(Obj, ReadsMapsWithTheirOptions) {
  write_picture("a wall.png");
  write("m.mtl",
        "newmtl wall\n  Kd 0.5 1 1\n\tmap_Kd -clamp on -bm 0.3 -s 2 3 1 -o 0.25 0.5 "
        "textures\\a wall.png\n"
        "newmtl lamp\nmap_Ke a wall.png\n");
  const Scene scene =
      load(std::string("mtllib m.mtl\n") + kTriangle +
           "vt 0.25 0.25\nusemtl wall\nf 1/1 2/1 3/1\nusemtl lamp\nf 1/1 2/1 3/1\n");
  ASSERT_EQ(scene.textures.size(), 1u) << "decoded once, found beside the file";
  const TextureRef& ref = scene.materials[0].base_color_texture;
  EXPECT_EQ(ref.wrap_u, Wrap::ClampToEdge);
  // file: u' = 0.25 + 2 u, v' = 0.5 + 3 v with v up; at u = v = 0.1
  const Vec2 uv = ref.transform({0.1f, 1 - 0.1f});
  EXPECT_NEAR(uv.x, 0.45, 1e-6);
  EXPECT_NEAR(uv.y, 1 - 0.8, 1e-6);
  EXPECT_EQ(scene.materials[1].emission, (Rgb{1, 1, 1}));
  EXPECT_EQ(evaluate_surface(scene, 1, 0, 0.3f, 0.3f, 0).emission.z, 1) << "bottom left is blue";
}

TEST_F(Obj, TheLowerLeftOfThePictureIsTheOriginOfUv) {
  write_picture("p.png");
  write("m.mtl", "newmtl a\nmap_Kd p.png\n");
  const Scene scene = load(std::string("mtllib m.mtl\nusemtl a\n") + kTriangle +
                           "vt 0.25 0.25\nvt 0.75 0.75\nf 1/1 2/1 3/1\nf 1/2 2/2 3/2\n");
  EXPECT_EQ(evaluate_surface(scene, 0, 0, 0.3f, 0.3f, 0).albedo, (Rgb{0, 0, 1}));
  EXPECT_EQ(evaluate_surface(scene, 0, 1, 0.3f, 0.3f, 0).albedo, (Rgb{0, 1, 0}));
}

TEST_F(Obj, ReadsMetalAndRoughness) {
  write("m.mtl",
        "newmtl a\nKd 1\nPm 1\nPr 0.3\nnewmtl b\nPm 0.4\nnewmtl c\nPr 0.2\nmap_Pr r.png\n");
  const Scene scene = load(std::string("mtllib m.mtl\n") + kTriangle +
                           "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n");
  ASSERT_EQ(scene.materials.size(), 3u);
  EXPECT_EQ(scene.materials[0].metallic, 1);
  EXPECT_EQ(scene.materials[0].roughness, 0.3f);
  EXPECT_EQ(scene.materials[1].metallic, 0.4f);
  EXPECT_EQ(scene.materials[1].roughness, 0.5f);
  EXPECT_EQ(scene.materials[2].metallic, 0);
  EXPECT_THAT(scene.ignored, ElementsAre("Pm without Pr (roughness 0.5 taken) (1 material)",
                                         "map_Pr, roughness map (1 material)"));
}

TEST_F(Obj, ReadsNormalMapsAndNotesHeights) {
  image::write_png(dir_ / "n.png", image::Image(1, 1, 3));
  write("bad.png", "no picture");
  write("m.mtl",
        "newmtl a\nKd 1 1 1\nmap_Kd n.png\nnorm -bm 0.5 n.png\n"
        "newmtl b\nmap_Kn bad.png\nnewmtl c\nmap_Kn gone.png\nbump n.png\n");
  const Scene scene = load(std::string("mtllib m.mtl\n") + kTriangle +
                           "vt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n"
                           "usemtl b\nf 1/1 2/2 3/3\nusemtl c\nf 1/1 2/2 3/3\n");
  EXPECT_THAT(scene.ignored,
              ElementsAre("bump map (1 material)", "damaged picture of a normal map (1 image)",
                          "texture \"gone.png\", which is not there (1 use)"));
  ASSERT_EQ(scene.textures.size(), 2u) << "as colors and as it stands";
  const Material& a = scene.materials[0];
  EXPECT_TRUE(scene.textures[static_cast<size_t>(a.base_color_texture.texture)]->srgb());
  EXPECT_FALSE(scene.textures[static_cast<size_t>(a.normal_texture.texture)]->srgb());
  EXPECT_EQ(a.normal_scale, 0.5f);
  EXPECT_EQ(scene.materials[1].normal_texture.texture, kNone);
}

TEST_F(Obj, NotesWhatItLeavesOut) {
  write("m.mtl",
        "newmtl a\nKd 1\nKs 0 0 0\nd 1.0\nTr 0\nillum 2\n"
        "newmtl b\nKs 0.5 0.5 0.5\nd 0.25\nillum 7\nmap_bump bumps.png\nmap_Kd gone.png\n"
        "newmtl b\nKd 1 1 1\n");
  const Scene scene =
      load(std::string("mtllib m.mtl\nmtllib far.mtl\n") + kTriangle +
           "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\nl 1 2\np 1\nbananas\n"
           "cstype bezier\ns off\n");
  EXPECT_THAT(
      scene.ignored,
      ElementsAre("Ks, specular color (1 material)", "bump map (1 material)",
                  "d or Tr, transparency (surfaces are opaque) (1 material)",
                  "free-form curves and surfaces (1 statement)",
                  "illum 7, mirrors or glass (only Pm makes metal) (1 material)",
                  "lines (1 statement)", "material given twice, the later one (1 material)",
                  "mtllib \"far.mtl\", which is not there (1 file)", "points (1 statement)",
                  "texture \"gone.png\", which is not there (1 use)", "unknown statements (1 line)",
                  "usemtl without a newmtl (it is grey) (1 material)"));
  EXPECT_EQ(scene.materials[0].base_color, (Rgb{1, 1, 1})) << "one number is grey";
  EXPECT_EQ(scene.materials[2].name, "c");
  EXPECT_EQ(scene.materials[2].base_color, (Rgb{0.5f, 0.5f, 0.5f}));
}

TEST_F(Obj, NumbersThatAreNone) {
  expect_error("v nan 0 0\n", "line 1", "nan is not a finite");
  expect_error("v 0 0 0\n\n# c\nv 1e99 0 0\n", "line 4", "1e99 is not a finite");
  expect_error("v 1e999 0 0\n", "line 1", "1e999");
  expect_error("v inf 0 0\n", "line 1", "inf is not a finite");
  expect_error("v one 0 0\n", "line 1", "got \"one\"");
  expect_error("v 0x10 0 0\n", "line 1", "got \"0x10\"");
  expect_error("v 1 2\n", "line 1", "v has 2 numbers");
  expect_error("vt\n", "line 1", "a number is missing");
  expect_error("v 1,5 0 0\n", "line 1", "got \"1,5\"");
}

TEST_F(Obj, IndicesThatLeadNowhere) {
  const std::string t = kTriangle;
  expect_error(t + "f 1 2 4\n", "line 4", "4 is no index of a vertex; there are 3 before it");
  expect_error(t + "f 1 2 0\n", "line 4", "0 is no index");
  expect_error(t + "f 1 2 -4\n", "line 4", "-4 is no index");
  expect_error(t + "f 1 2 4294967297\n", "line 4", "4294967297 is no index");
  expect_error(t + "f 1 2 99999999999999999999\n", "line 4", "is no index");
  expect_error(t + "f 1 2 -9223372036854775808\n", "line 4", "is no index");
  expect_error(t + "f 1 2 x\n", "line 4", "got \"x\"");
  expect_error(t + "f 1 2 2.5\n", "line 4", "got \"2.5\"");
  expect_error(t + "f 1/1 2 3\n", "line 4", "1 is no index of a texture coordinate; there are 0");
  expect_error(t + "f 1//7 2 3\n", "line 4", "7 is no index of a normal");
  expect_error(t + "f 1 2\n", "line 4", "f has 2 corners");
  expect_error(t + "f\n", "line 4", "f has 0 corners");
}

TEST_F(Obj, FilesThatAreNoScene) {
  expect_error("v 0 0 0\n", "", "no triangles");
  expect_error(std::string("\0\x01\x02 garbage\nmore\n", 17), "", "no triangles");
  EXPECT_THAT(test::error_of([&] { load_scene(dir_ / "gone.obj"); }), HasSubstr("no such file"));
  write("empty.obj", "");
  EXPECT_THAT(test::error_of([&] { load_scene(dir_ / "empty.obj"); }), HasSubstr("empty"));
  LoadLimits limits;
  limits.triangles = 1;
  EXPECT_THAT(test::error_of([&] { load(std::string(kTriangle) + "f 1 2 3\nf 1 2 3\n", limits); }),
              HasSubstr("model.obj: line 5: more than 1 triangles"));
}

TEST_F(Obj, BrokenMaterials) {
  const auto error = [&](const std::string& mtl) {
    write("m.mtl", mtl);
    return test::error_of([&] { load(std::string("mtllib m.mtl\n") + kTriangle + "f 1 2 3\n"); });
  };
  EXPECT_THAT(error("newmtl a\nKd 1 nan 1\n"), HasSubstr("m.mtl: line 2: Kd: nan"));
  EXPECT_THAT(error("newmtl a\nKe -1 0 0\n"), HasSubstr("m.mtl: line 2: Ke must not be negative"));
  EXPECT_THAT(error("newmtl a\nKd 1 1\n"), HasSubstr("m.mtl: line 2: Kd: a number is missing"));
  write("m.png", "no picture");
  EXPECT_THAT(error("newmtl a\nmap_Kd m.png\n"), HasSubstr("m.png: broken image header"));
}

TEST_F(Obj, RandomDamageNeverCrashes) {
  write("m.mtl", "newmtl a\nKd 1 1 1\nmap_Kd -s 2 2 x.png\nKe 1 1 1\nd 0.5\nillum 4\n");
  const std::string whole = std::string("mtllib m.mtl\no a\nusemtl a\n") + kTriangle +
                            "v 1 1 0 1 0 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1 4//1 3\nf -1 -2 -3\n";
  uint64_t state = 11;
  int errors = 0;
  for (int run = 0; run < 400; ++run) {
    std::string bytes = whole;
    for (int k = 0; k < 3; ++k) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      bytes[(state >> 33) % bytes.size()] = "0123456789/-.e \n#vf\\"[(state >> 20) % 20];
    }
    try {
      load(bytes);
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("model.obj"));
      ++errors;
    }
  }
  EXPECT_GT(errors, 100);
}

}  // namespace
}  // namespace lte::scene
