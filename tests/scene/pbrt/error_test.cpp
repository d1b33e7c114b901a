// PBRT: broken and hostile files. One clear line each, naming file and line, and no crash.
#include "tests/scene/pbrt/fixture.h"

namespace lte::scene {
namespace {

using test::kTriangle;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class PbrtError : public test::PbrtTest {
 protected:
  /// `body` begins on line 2.
  void expect(const std::string& body, const std::string& start, const LoadLimits& limits = {}) {
    EXPECT_THAT(error("WorldBegin\n" + body, limits), StartsWith(start)) << body;
  }
};

TEST_F(PbrtError, Syntax) {
  expect("Spehre", "scene.pbrt:2: unknown directive \"Spehre\"");
  expect("\n\"float\"", "scene.pbrt:3: expected a directive, got a string \"float\"");
  expect("[", "scene.pbrt:2: expected a directive, got a bracket \"[\"");
  expect("Shape sphere", "scene.pbrt:2: Shape: expected a quoted string, got \"sphere\"");
  expect("Shape", "scene.pbrt:2: Shape: expected a quoted string, got the end of the file");
  expect("Shape \"sphere\" \"float radius", "scene.pbrt:2: unterminated string");
  expect("Shape \"sphere\" \"float\nradius\" 1", "scene.pbrt:2: unterminated string");
  expect("Shape \"sph\\qere\"", "scene.pbrt:2: unknown escape");
  expect("Shape \"sphere\" \"radius\" 1",
         "scene.pbrt:2: \"radius\": expected the type and the name");
  expect("Shape \"sphere\" \"\" 1", "scene.pbrt:2: \"\": expected the type and the name");
  expect("Shape \"sphere\" \"lenght radius\" 1", "scene.pbrt:2: \"lenght radius\": unknown type");
  expect("Shape \"sphere\" \"float radius\" [1",
         "scene.pbrt:2: the file ends inside the parameter");
  expect("Shape \"sphere\" \"float radius\"", "scene.pbrt:2: the file ends inside the parameter");
  expect("Shape \"sphere\" \"float radius\" [[1]]",
         "scene.pbrt:2: parameter \"radius\" is of type");
  expect("Translate 1 2",
         "scene.pbrt:2: Translate takes 3 numbers, got the end of the file after 2");
  expect("Translate 1 x 2", "scene.pbrt:2: expected a number, got \"x\"");
  expect("Transform [1 2 3]", "scene.pbrt:2: Transform takes 16 numbers, got \"]\" after 3");
  expect("Translate [1 2 3 4]", "scene.pbrt:2: Translate takes 3 numbers, expected \"]\"");
}

TEST_F(PbrtError, BytesThatNoTextHas) {
  EXPECT_THAT(error(std::string("\x01\x02\x03", 3)), StartsWith("scene.pbrt:1: byte 0x01"));
  EXPECT_THAT(error("\xff\xfe S"), StartsWith("scene.pbrt:1: UTF-16"));
  EXPECT_THAT(error(std::string("WorldBegin\nShape \"a\0b\"", 22)),
              StartsWith("scene.pbrt:2: byte 0x00 in a string"));
  EXPECT_THAT(error(""), StartsWith("scene.pbrt: the file has no WorldBegin"));
  EXPECT_THAT(error("\x89PNG\r\n"), HasSubstr("scene.pbrt:1: "));
  EXPECT_THAT(test::error_of([&] { load_scene(dir_ / "none.pbrt"); }), HasSubstr("none.pbrt"));
  EXPECT_THAT(test::error_of([&] { load_scene(dir_.path() / ".pbrt"); }), HasSubstr(".pbrt"));
}

TEST_F(PbrtError, Numbers) {
  for (const char* bad : {"nan", "inf", "-inf", "1e999", "1.2.3", "0x", "--1", "+-1", "1f", "-"}) {
    expect(concat("Shape \"sphere\" \"float radius\" ", bad), "scene.pbrt:2: ");
    expect(concat("Translate 0 0 ", bad), "scene.pbrt:2: ");
  }
  expect("Shape \"sphere\" \"float radius\" 1e300",
         "scene.pbrt:2: parameter \"radius\": 1e+300 is beyond the range of float");
  expect("Shape \"loopsubdiv\" \"integer levels\" 1.5",
         "scene.pbrt:2: parameter \"levels\": 1.5 is no");
  expect("Shape \"loopsubdiv\" \"integer levels\" 99999999999",
         "scene.pbrt:2: parameter \"levels\"");
  EXPECT_EQ(load_world("Translate +1 -.5 1e-999\n" + kTriangle).triangle_count(), 1);
}

TEST_F(PbrtError, TypesAndCounts) {
  expect("Shape \"sphere\" \"float radius\" \"big\"",
         "scene.pbrt:2: parameter \"radius\" is of type float, but got the string \"big\"");
  expect("Shape \"sphere\" \"string radius\" \"big\"",
         "scene.pbrt:2: parameter \"radius\" of Shape \"sphere\" must be float or integer, not "
         "string");
  expect("Shape \"sphere\" \"float radius\" [1 2]",
         "scene.pbrt:2: parameter \"radius\" of Shape \"sphere\" takes one value, got 2");
  expect("Shape \"sphere\" \"float radius\" []",
         "scene.pbrt:2: parameter \"radius\" of Shape \"sphere\" takes one value, got 0");
  expect("AreaLightSource \"diffuse\" \"bool twosided\" 1\n" + kTriangle,
         "scene.pbrt:2: parameter \"twosided\": expected true or false, got \"1\"");
  expect("Material \"diffuse\" \"rgb reflectance\" [1 2]\n" + kTriangle,
         "scene.pbrt:2: parameter \"reflectance\" of type rgb takes 3 values, got 2");
  expect("Material \"diffuse\" \"rgb reflectance\" [1 -2 1]\n" + kTriangle,
         "scene.pbrt:2: parameter \"reflectance\" has a negative value");
  expect("Material \"diffuse\" \"blackbody reflectance\" 3000\n" + kTriangle,
         "scene.pbrt:2: parameter \"reflectance\" cannot be of type blackbody");
  expect("AreaLightSource \"diffuse\" \"blackbody L\" -3\n" + kTriangle,
         "scene.pbrt:2: parameter \"L\"");
  expect("AreaLightSource \"diffuse\" \"blackbody L\" []\n" + kTriangle,
         "scene.pbrt:2: parameter \"L\"");
  expect("AreaLightSource \"diffuse\" \"spectrum L\" [1 2 3]\n" + kTriangle,
         "scene.pbrt:2: parameter \"L\": expected pairs");
  expect("AreaLightSource \"diffuse\" \"spectrum L\" [500 1 400 1]\n" + kTriangle,
         "scene.pbrt:2: parameter \"L\": wavelengths must ascend");
  expect("AreaLightSource \"diffuse\" \"spectrum L\" \"nothing.spd\"\n" + kTriangle,
         "scene.pbrt:2: cannot find the file \"nothing.spd\"");
}

TEST_F(PbrtError, Shapes) {
  const std::string mesh = "Shape \"trianglemesh\" ";
  expect(mesh, "scene.pbrt:2: Shape \"trianglemesh\" needs \"point3 P\"");
  expect(mesh + "\"point3 P\" [0 0]",
         "scene.pbrt:2: parameter \"P\" of Shape \"trianglemesh\" has 2");
  expect(mesh + "\"point3 P\" [0 0 0 1 0 0]",
         "scene.pbrt:2: Shape \"trianglemesh\" needs \"integer");
  const std::string p = mesh + "\"point3 P\" [0 0 0 1 0 0 0 1 0] ";
  expect(p + "\"integer indices\" [0 1 3]",
         "scene.pbrt:2: parameter \"indices\" of Shape \"trianglemesh\": index 3, but there are 3");
  expect(p + "\"integer indices\" [0 1 -1]", "scene.pbrt:2: parameter \"indices\"");
  expect(p + "\"integer indices\" [0 1]", "scene.pbrt:2: Shape \"trianglemesh\": 2 indices");
  expect(p + "\"normal N\" [0 0 1]", "scene.pbrt:2: Shape \"trianglemesh\": 1 values of \"N\"");
  expect(p + "\"point2 uv\" [0 0 1]", "scene.pbrt:2: parameter \"uv\"");
  expect("Shape \"sphere\" \"float radius\" 0",
         "scene.pbrt:2: Shape \"sphere\": \"radius\" must be");
  expect("Shape \"sphere\" \"float zmin\" 1 \"float zmax\" 1", "scene.pbrt:2: Shape \"sphere\"");
  expect("Shape \"cylinder\" \"float zmin\" 1 \"float zmax\" 1",
         "scene.pbrt:2: Shape \"cylinder\"");
  expect("Shape \"disk\" \"float innerradius\" 1", "scene.pbrt:2: Shape \"disk\": \"innerradius\"");
  expect("Shape \"disk\" \"float phimax\" 0", "scene.pbrt:2: Shape \"disk\": \"phimax\"");
  expect("Shape \"plymesh\"", "scene.pbrt:2: Shape \"plymesh\" needs \"string filename\"");
  expect("Shape \"plymesh\" \"string filename\" \"no.ply\"", "scene.pbrt:2: cannot find the file");
  expect("Shape \"plymesh\" \"string filename\" \".\"",
         "scene.pbrt:2: \".\" is not a regular file");
  write_file(dir_ / "bad.ply", "ply\nformat ascii 1.0\nelement vertex x\n");
  expect("Shape \"plymesh\" \"string filename\" \"bad.ply\"", "scene.pbrt:2: bad.ply:3: ");
  expect("Shape \"curve\"", "scene.pbrt: the scene has no triangles");
}

TEST_F(PbrtError, Transforms) {
  expect("Scale 1 0 1\n" + kTriangle, "scene.pbrt:3: the transform here is singular");
  expect("Transform [1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1]\n" + kTriangle,
         "scene.pbrt:3: the transform here is not affine");
  expect("Scale 1e300 1 1 Scale 1e300 1 1\n" + kTriangle,
         "scene.pbrt:3: the transform here is beyond the range of numbers");
  expect("Scale 1e30 1e30 1e30 Scale 1e30 1e30 1e30\n" + kTriangle,
         "scene.pbrt:3: the transform here is beyond the range of float");
  expect("Scale 1e30 1e30 1e30\nShape \"sphere\" \"float radius\" 1e30",
         "scene.pbrt: mesh \"sphere scene.pbrt:3\": vertex ");
  expect("LookAt 0 0 0 0 0 0 0 1 0", "scene.pbrt:2: LookAt: the eye and the target coincide");
  expect("LookAt 0 0 0 0 1 0 0 1 0", "scene.pbrt:2: LookAt: the up vector lies along the view");
  expect("LookAt 0 0 0 0 1 0 0 0 0", "scene.pbrt:2: LookAt: the up vector has no direction");
  expect("ActiveTransform Never",
         "scene.pbrt:2: ActiveTransform: expected StartTime, EndTime or All");
  EXPECT_THAT(error("Scale 0 0 0\nCamera \"perspective\""),
              StartsWith("scene.pbrt:2: the transform"));
}

TEST_F(PbrtError, Cameras) {
  const auto with = [&](const std::string& options) {
    return error(options + "\nWorldBegin\n" + kTriangle);
  };
  EXPECT_THAT(with("Camera \"perspective\" \"float fov\" 180"), StartsWith("scene.pbrt:1: Camera"));
  EXPECT_THAT(with("Camera \"perspective\" \"float fov\" 0"), StartsWith("scene.pbrt:1: Camera"));
  EXPECT_THAT(with("Camera \"perspective\" \"float screenwindow\" [1 0 0 1]"),
              StartsWith("scene.pbrt:1: Camera \"perspective\": \"screenwindow\" is empty"));
  EXPECT_THAT(with("Camera \"perspective\"\nFilm \"rgb\" \"integer xresolution\" 0"),
              StartsWith("scene.pbrt:2: Film \"rgb\": its resolution"));
}

TEST_F(PbrtError, BlocksAndNames) {
  expect("AttributeEnd", "scene.pbrt:2: AttributeEnd ends nothing");
  expect("AttributeBegin\nObjectEnd",
         "scene.pbrt:3: ObjectEnd ends another kind of block, begun at ");
  expect("\nAttributeBegin\n" + kTriangle, "scene.pbrt:3: AttributeBegin is never ended");
  expect("ObjectBegin \"a\"\n" + kTriangle, "scene.pbrt:2: ObjectBegin is never ended");
  expect("ObjectBegin \"a\"\nObjectBegin \"b\"",
         "scene.pbrt:3: ObjectBegin inside of the object \"a\"");
  expect("ObjectBegin \"a\"\nObjectInstance \"a\"", "scene.pbrt:3: ObjectInstance inside of");
  expect("ObjectBegin \"a\" ObjectEnd\nObjectBegin \"a\"",
         "scene.pbrt:3: the object \"a\" is defined twice");
  expect("ObjectInstance \"a\"", "scene.pbrt:2: no object \"a\" is defined");
  expect("NamedMaterial \"a\"\n" + kTriangle, "scene.pbrt:2: no material \"a\" is made");
  expect("MakeNamedMaterial \"a\"", "scene.pbrt:2: MakeNamedMaterial \"a\" needs \"string type\"");
  const std::string make = "MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\n";
  expect(make + make, "scene.pbrt:3: the material \"a\" is made twice, first at ");
  expect("Material \"diffuse\" \"texture reflectance\" \"t\"\n" + kTriangle,
         "scene.pbrt:2: no texture \"t\" is defined");
  const std::string texture = "Texture \"t\" \"spectrum\" \"constant\"\n";
  expect(texture + texture, "scene.pbrt:3: the texture \"t\" is defined twice");
  expect("Texture \"t\" \"sound\" \"constant\"", "scene.pbrt:2: Texture \"t\" of type \"sound\"");
  expect("Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"t\"\n" + kTriangle,
         "scene.pbrt:2: no texture \"t\" is defined");
  expect("Texture \"t\" \"spectrum\" \"imagemap\"\n" + kTriangle,
         "scene.pbrt:2: Texture \"imagemap\" needs");
  expect("Attribute \"sound\" \"float a\" 1", "scene.pbrt:2: Attribute of \"sound\"");
  expect("WorldBegin", "scene.pbrt:2: WorldBegin stands behind WorldBegin");
  expect("Camera \"perspective\"", "scene.pbrt:2: Camera stands behind WorldBegin");
  EXPECT_THAT(error(kTriangle), StartsWith("scene.pbrt:1: Shape stands before WorldBegin"));
  expect(
      "MakeNamedMaterial \"a\" \"string type\" \"mix\" \"string materials\" [\"a\" \"a\"]\n"
      "NamedMaterial \"a\"\n" +
          kTriangle,
      "scene.pbrt:2: mixtures of materials nested deeper");
  expect("Material \"mix\" \"string materials\" [\"a\" \"b\"]\n" + kTriangle,
         "scene.pbrt:2: a mix of");
}

TEST_F(PbrtError, Pictures) {
  const auto use = [](const std::string& params) {
    return "Texture \"t\" \"spectrum\" \"imagemap\" " + params +
           "\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\nShape \"sphere\"";
  };
  expect(use("\"string filename\" \"no.png\""), "scene.pbrt:2: cannot find the file \"no.png\"");
  write_file(dir_ / "bad.png", "\x89PNG\r\n and then nothing");
  expect(use("\"string filename\" \"bad.png\""), "scene.pbrt:2: bad.png: ");
  write_file(dir_ / "bad.txt", "a poem");
  expect(use("\"string filename\" \"bad.txt\""), "scene.pbrt:2: bad.txt: none of PNG, JPEG");
  expect(use("\"string filename\" \"bad.png\" \"string encoding\" \"ebcdic\""),
         "scene.pbrt:2: Texture \"imagemap\": unknown encoding \"ebcdic\"");
  write_file(dir_ / "nan.pfm", std::string("PF\n1 1\n-1\n\0\0\xc0\x7f\0\0\0\0\0\0\0\0", 22));
  expect(use("\"string filename\" \"nan.pfm\""), "scene.pbrt:2: nan.pfm: pixel 0, 0 is not finite");
}

TEST_F(PbrtError, Includes) {
  write_file(dir_ / "a.pbrt", "\nInclude \"b.pbrt\"\n");
  write_file(dir_ / "b.pbrt", "Include \"a.pbrt\"\n");
  expect("Include \"a.pbrt\"", "b.pbrt:1: \"");
  EXPECT_THAT(error("WorldBegin\nInclude \"a.pbrt\""), HasSubstr("a.pbrt\" includes itself"));
  expect("Include \"scene.pbrt\"", "scene.pbrt:2: ");
  expect("Include \"none.pbrt\"", "scene.pbrt:2: cannot find the file \"none.pbrt\"");
  expect("Include \"\"", "scene.pbrt:2: expected the name of a file");
  expect("Include none", "scene.pbrt:2: Include: expected a quoted string");
  write_file(dir_ / "c.pbrt", "Translate 1 1 1\n\n Spehre\n");
  expect("Include \"c.pbrt\"", "c.pbrt:3: unknown directive");
}

TEST_F(PbrtError, IncludeBombs) {
  // Each file includes the next one twice: 2^40 in all.
  for (int i = 0; i < 40; ++i) {
    const std::string next = concat("Include \"f", i + 1, ".pbrt\"\n");
    write_file(dir_ / concat("f", i, ".pbrt"), next + next);
  }
  write_file(dir_ / "f40.pbrt", "Identity\n");
  LoadLimits limits;
  limits.includes = 1000;
  EXPECT_THAT(error("WorldBegin\nInclude \"f0.pbrt\"", limits), HasSubstr("more than 1000 files"));
  limits = {};
  limits.text_bytes = 2000;
  EXPECT_THAT(error("WorldBegin\nInclude \"f0.pbrt\"", limits),
              HasSubstr("limit \"text\" of 2000 bytes"));
}

TEST_F(PbrtError, NestingAndCountsHaveLimits) {
  std::string deep;
  for (int i = 0; i < 2000; ++i) deep += "AttributeBegin\n";
  EXPECT_THAT(error("WorldBegin\n" + deep),
              StartsWith("scene.pbrt:1026: blocks are nested deeper"));
  LoadLimits limits;
  limits.triangles = 100'000;
  expect("Shape \"loopsubdiv\" \"integer levels\" 2000000 \"point3 P\" [0 0 0 1 0 0 0 1 0]",
         "scene.pbrt:2: Shape \"loopsubdiv\": 2000000 levels make", limits);
  std::string many;
  for (int i = 0; i < 50; ++i) many += "Material \"diffuse\" Shape \"sphere\"\n";
  expect(many, "scene.pbrt:22: more than 100000 triangles", limits);
  std::string instances = "ObjectBegin \"o\" Shape \"sphere\" ObjectEnd\n";
  for (int i = 0; i < 50; ++i) instances += "ObjectInstance \"o\"\n";
  expect(instances, "scene.pbrt:23: instances have more than 100000 triangles", limits);
  // Textures of textures: 2^60 pictures in 60 lines.
  std::string textures = "Texture \"t0\" \"spectrum\" \"checkerboard\"\n";
  for (int i = 1; i < 60; ++i) {
    const std::string from = concat("\"t", i - 1, "\" ");
    textures += concat("Texture \"t", i, "\" \"spectrum\" \"scale\" \"texture tex\" ", from,
                       "\"texture scale\" ", from, "\n");
  }
  EXPECT_THAT(error("WorldBegin\n" + textures + kTriangle), HasSubstr("made of more than 1000"));
}

}  // namespace
}  // namespace lte::scene
