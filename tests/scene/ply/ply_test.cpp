// PLY: every encoding, written byte by byte, and broken files.
#include "lte/scene/ply/ply.h"

#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/file.h"
#include "lte/image/tonemap.h"
#include "lte/scene/import/triangulate.h"
#include "lte/scene/load.h"
#include "lte/scene/scene.h"
#include "lte/scene/surface.h"
#include "tests/support/gzip.h"
#include "tests/support/temp_dir.h"

namespace lte::scene::ply {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Triangle = std::array<uint32_t, 3>;

template <typename T>
std::string bytes(T value, bool big) {
  std::string out(sizeof(T), '\0');
  std::memcpy(out.data(), &value, sizeof(T));
  if (big) out = {out.rbegin(), out.rend()};
  return out;
}

class Ply : public ::testing::Test {
 protected:
  PlyMesh read(const std::string& content, const LoadLimits& limits = {}) {
    test::write_text(dir_ / "m.ply", content);
    SceneFiles files(dir_ / "m.ply", limits);
    return read_ply(files.open_scene(), &files.budget());
  }
  std::string error(const std::string& content, const LoadLimits& limits = {}) {
    std::string message = test::error_of([&] { read(content, limits); });
    const std::string folder = dir_.path().string() + "/";
    if (message.starts_with(folder)) message.erase(0, folder.size());
    return message;
  }

  test::TempDir dir_;
};

/// A triangle and a quad with every kind of attribute, and things to be skipped.
std::string sample_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment made by hand\nobj_info none\nelement camera 2\nproperty float fov\n"
         "property list uchar short tags\nelement vertex 5\nproperty float x\nproperty double y\n"
         "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty int label\n"
         "property float u\nproperty float v\nelement face 2\nproperty uchar flag\n"
         "property list uchar int vertex_indices\nend_header\n";
}

void expect_sample(const PlyMesh& mesh) {
  EXPECT_THAT(mesh.positions, ElementsAre(Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0},
                                          Vec3{0, 1, 0}, Vec3{0.5f, 2, 0}));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{3, 2, 4}, Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  EXPECT_EQ(mesh.faces, 2);
  ASSERT_EQ(mesh.normals.size(), 5u);
  EXPECT_EQ(mesh.normals[4], (Vec3{0, 0, 1}));
  ASSERT_EQ(mesh.uvs.size(), 5u);
  EXPECT_EQ(mesh.uvs[4].x, 0.5f);
  EXPECT_EQ(mesh.uvs[4].y, 2);
  ASSERT_EQ(mesh.colors.size(), 5u);
  EXPECT_EQ(mesh.colors[2].x, 1);
  EXPECT_NEAR(mesh.colors[2].y, image::srgb_to_linear(51 / 255.f), 1e-6);
  EXPECT_EQ(mesh.colors[2].z, 0);
}

std::string strips(const std::string& lists, const std::string& type = "int") {
  return "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
         "property float z\nelement tristrips 1\nproperty list int " +
         type + " vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n" + lists;
}

TEST_F(Ply, ReadsStripsOfTriangles) {
  // All fronts are towards +z; −1 begins another strip, and two corners make none.
  const PlyMesh mesh = read(strips("12 0 1 2 3 4 -1 -1 3 -1 2 3 4\n"));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{2, 1, 3}, Triangle{2, 3, 4},
                                          Triangle{2, 3, 4}));
  EXPECT_EQ(mesh.faces, 4);
  EXPECT_THAT(error(strips("3 0 1 5\n")), HasSubstr("triangle strip 0: index 5"));
  EXPECT_THAT(error(strips("3 0 1 -2\n")), HasSubstr("index -2"));
  EXPECT_THAT(error(strips("2 0 1\n")), HasSubstr("no faces"));
  LoadLimits limits;
  limits.triangles = 2;
  EXPECT_THAT(error(strips("5 0 1 2 3 4\n"), limits), HasSubstr("beyond the limit"));
}

std::string ascii_sample() {
  std::string out = sample_header("ascii") + "45 2 7 8\n46 0\n";
  for (const char* p : {"0 0", "1 0", "1 1", "0 1", "0.5 2"})
    out += std::string(p) + " 0  0 0 1  255 51 0  -3  " + p + "\n";
  return out + "1 3 3 2 4\n0 4 0 1 2 3\n";
}

std::string binary_sample(bool big) {
  std::string out = sample_header(big ? "binary_big_endian" : "binary_little_endian");
  out += bytes(45.f, big) + "\2" + bytes<int16_t>(7, big) + bytes<int16_t>(8, big);
  out += bytes(46.f, big) + std::string(1, '\0');
  const float xs[] = {0, 1, 1, 0, 0.5f}, ys[] = {0, 0, 1, 1, 2};
  for (int i = 0; i < 5; ++i) {
    out += bytes(xs[i], big) + bytes(double{ys[i]}, big) + bytes(0.f, big);
    out += bytes(0.f, big) + bytes(0.f, big) + bytes(1.f, big) + "\xff\x33" + std::string(1, '\0');
    out += bytes<int32_t>(-3, big) + bytes(xs[i], big) + bytes(ys[i], big);
  }
  const auto face = [&](char flag, const std::vector<int32_t>& corners) {
    out += flag;
    out += static_cast<char>(corners.size());
    for (const int32_t corner : corners) out += bytes(corner, big);
  };
  face(1, {3, 2, 4});
  face(0, {0, 1, 2, 3});
  return out;
}

TEST_F(Ply, ReadsEveryEncoding) {
  for (const std::string& sample : {ascii_sample(), binary_sample(false), binary_sample(true)}) {
    SCOPED_TRACE(sample.substr(0, 30));
    expect_sample(read(sample));
    expect_sample(read(test::gzip(sample)));
  }
}

TEST_F(Ply, LinesMayEndAsTheyLike) {
  std::string sample = ascii_sample(), dos;
  for (const char c : sample) dos += c == '\n' ? "\r\n" : std::string(1, c);
  expect_sample(read(dos));
  sample.pop_back();  // no line break at the very end
  expect_sample(read(sample));
}

TEST_F(Ply, EveryScalarTypeServesAsIndexAndPosition) {
  const auto mesh = [&](const std::string& type, const auto value) {
    using T = decltype(value + 0);
    (void)sizeof(T);
    std::string out =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty " + type +
        " x\nproperty " + type + " y\nproperty " + type + " z\nelement face 1\nproperty list " +
        (type.starts_with("f") || type.starts_with("d") ? "uchar uchar" : type + " " + type) +
        " vertex_index\nend_header\n";
    using Value = std::remove_const_t<decltype(value)>;
    for (const int v : {0, 0, 0, 2, 0, 0, 0, 2, 0}) out += bytes(static_cast<Value>(v), false);
    const bool real = std::is_floating_point_v<Value>;
    for (const int v : {3, 0, 1, 2})
      out += real ? bytes(static_cast<uint8_t>(v), false) : bytes(static_cast<Value>(v), false);
    return read(out);
  };
  const auto expect = [](const PlyMesh& got) {
    EXPECT_THAT(got.positions, ElementsAre(Vec3{0, 0, 0}, Vec3{2, 0, 0}, Vec3{0, 2, 0}));
    EXPECT_THAT(got.triangles, ElementsAre(Triangle{0, 1, 2}));
  };
  expect(mesh("char", int8_t{}));
  expect(mesh("uint8", uint8_t{}));
  expect(mesh("short", int16_t{}));
  expect(mesh("ushort", uint16_t{}));
  expect(mesh("int32", int32_t{}));
  expect(mesh("uint", uint32_t{}));
  expect(mesh("float32", float{}));
  expect(mesh("double", double{}));
}

TEST_F(Ply, FloatColorsAreLinear) {
  const PlyMesh mesh = read(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "property float r\nproperty float g\nproperty float b\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 0 .5 .25 1\n1 0 0 .5 .25 1\n0 1 0 .5 .25 1\n3 0 1 2\n");
  EXPECT_EQ(mesh.colors[0], (Rgb{.5f, .25f, 1}));
}

TEST_F(Ply, LoadsAsAScene) {
  write_file(dir_ / "m.ply", ascii_sample());
  const Scene scene = load_scene(dir_ / "m.ply");
  EXPECT_EQ(scene.name, "m");
  EXPECT_EQ(scene.triangle_count(), 3);
  const Surface surface = evaluate_surface(scene, 0, 0, 0.3f, 0.3f, 0);
  EXPECT_NEAR(surface.albedo.y, image::srgb_to_linear(0.2f), 1e-5);
  EXPECT_EQ(surface.normal.z, 1);
  write_file(dir_ / "M.PLY.gz", test::gzip(ascii_sample()));
  EXPECT_EQ(load_scene(dir_ / "M.PLY.gz").triangle_count(), 3);
  EXPECT_EQ(load_scene(dir_ / "M.PLY.gz").name, "M");
}

double signed_area(const std::vector<Vec3>& p, const std::vector<Triangle>& triangles,
                   double* absolute) {
  double sum = 0;
  *absolute = 0;
  for (const auto& [a, b, c] : triangles) {
    const double twice = cross(p[b] - p[a], p[c] - p[a]).z;
    sum += twice / 2;
    *absolute += std::abs(twice) / 2;
  }
  return sum;
}

TEST(TriangulatePolygon, CoversConvexAndConcaveOnesOnce) {
  // An L, an arrow whose first corner is convex, and one that a fan from its first corner leaves.
  const std::vector<std::pair<std::vector<Vec3>, double>> polygons{
      {{{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}}, 5},
      {{{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {0.5f, 1, 0}}, 1.5},
      {{{4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {3, 3, 0}}, 4},
      {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}, 4}};
  for (const auto& [points, area] : polygons) {
    for (const bool mirrored : {false, true}) {
      std::vector<uint32_t> corners(points.size());
      for (uint32_t i = 0; i < corners.size(); ++i)
        corners[i] = mirrored ? static_cast<uint32_t>(points.size()) - 1 - i : i;
      std::vector<Triangle> triangles;
      triangulate_polygon(points, corners, &triangles);
      EXPECT_EQ(triangles.size(), points.size() - 2);
      double absolute = 0;
      EXPECT_NEAR(signed_area(points, triangles, &absolute), mirrored ? -area : area, 1e-6);
      EXPECT_NEAR(absolute, area, 1e-6) << "triangles overlap";
    }
  }
}

TEST(TriangulatePolygon, EndsOnNonsense) {
  const std::vector<Vec3> same(8, Vec3{1, 1, 1});
  std::vector<Triangle> triangles;
  triangulate_polygon(same, {0, 1, 2, 3, 4, 5, 6, 7}, &triangles);
  EXPECT_EQ(triangles.size(), 6u);
  const std::vector<Vec3> bow{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0.5f, 0}};
  triangulate_polygon(bow, {0, 1, 2, 3, 4}, &triangles);
  EXPECT_EQ(triangles.size(), 9u);
}

std::string small(const std::string& vertices, const std::string& faces,
                  const std::string& body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n") {
  return "ply\nformat ascii 1.0\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
         "\nproperty list uchar int vertex_indices\nend_header\n" + body;
}

TEST_F(Ply, BrokenHeaders) {
  EXPECT_THAT(error(""), HasSubstr("m.ply: not a PLY file"));
  EXPECT_THAT(error("plywood\n"), HasSubstr("not a PLY file"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\nelement"), HasSubstr("m.ply:2: the PLY header has no"));
  EXPECT_THAT(error("ply\nformat ascii 2.0\n"), HasSubstr("m.ply:2: expected \"format"));
  EXPECT_THAT(error("ply\nformat morse 1.0\n"), HasSubstr("m.ply:2: unknown PLY encoding"));
  EXPECT_THAT(error("ply\nproperty float x\n"), HasSubstr("m.ply:2: a property before"));
  EXPECT_THAT(error("ply\nelement vertex 1\nproperty half x\n"),
              HasSubstr("m.ply:3: unknown type"));
  EXPECT_THAT(error("ply\nelement vertex 1\nproperty list float int x\n"),
              HasSubstr("m.ply:3: the length"));
  EXPECT_THAT(error("ply\nelement vertex -1\n"), HasSubstr("m.ply:2: the count"));
  EXPECT_THAT(error("ply\nelement vertex 99999999999999999999\n"), HasSubstr("m.ply:2: the count"));
  EXPECT_THAT(error("ply\nhello\n"), HasSubstr("m.ply:2: unknown line"));
  EXPECT_THAT(error("ply\nend_header\n"), HasSubstr("has no \"format\""));
  EXPECT_THAT(error("ply\nformat ascii 1.0\nend_header\n"), HasSubstr("no element \"vertex\""));
}

TEST_F(Ply, TakesTheHeaderLineOfBlender247) {
  std::string text = small("3", "1");
  text.insert(text.find("element vertex"),
              "Created by Blender3D 247 - www.blender.org, source file:\n");
  EXPECT_EQ(read(text).faces, 1);
}

TEST_F(Ply, CountsThatTheFileCannotHold) {
  EXPECT_THAT(error(small("4000000000", "1")),
              HasSubstr("truncated, the header promises 4000000000"));
  EXPECT_THAT(error(small("3", "9000000000000000000")), HasSubstr("truncated"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\nelement void 9000000000000000000\nend_header\n"),
              HasSubstr("has no properties"));
  EXPECT_THAT(error(small("3", "1", "0 0 0\n1 0 0\n0 1 0\n200 0 1 2\n")), HasSubstr("truncated"));
  EXPECT_THAT(error(small("3", "1", "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n")), HasSubstr("a list of -3"));
  EXPECT_THAT(error(small("3", "1", "0 0 0\n1 0 0\n0 1 0\n3 0 1    ")), HasSubstr("truncated"));
  LoadLimits limits;
  limits.triangles = 2;
  EXPECT_THAT(error(small("3", "3", "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n3 0 1 2\n"), limits),
              HasSubstr("3 faces exceed the limit of 2"));
}

TEST_F(Ply, BrokenBodies) {
  EXPECT_THAT(error(small("3", "1", "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n")),
              HasSubstr("m.ply:13: face 0: index 3, but there are 3 vertices"));
  EXPECT_THAT(error(small("3", "1", "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n")), HasSubstr("index -1"));
  EXPECT_THAT(error(small("3", "1", "0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n")), HasSubstr("index 1.5"));
  EXPECT_THAT(error(small("3", "1", "0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n")),
              HasSubstr("m.ply:11: vertex 1 is not finite"));
  EXPECT_THAT(error(small("3", "1", "0 0 0\n1e99 0 0\n0 1 0\n3 0 1 2\n")), HasSubstr("not finite"));
  EXPECT_THAT(error(small("3", "1", "0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n")),
              HasSubstr("m.ply:11: expected a number"));
  EXPECT_THAT(error(small("3", "0", "0 0 0\n1 0 0\n0 1 0\n")), HasSubstr("no faces"));
  EXPECT_THAT(error(small("3", "1", "0 0 0\n1 0 0\n0 1 0\n2 0 1\n")), HasSubstr("no faces"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n"),
              HasSubstr("without x, y and z"));
  for (const bool big : {false, true}) {
    const std::string whole = binary_sample(big);
    for (size_t cut = whole.find("end_header\n") + 11; cut < whole.size(); ++cut)
      EXPECT_THAT(error(whole.substr(0, cut)), HasSubstr("truncated")) << cut;
  }
}

TEST_F(Ply, BrokenGzip) {
  const std::string packed = test::gzip(ascii_sample());
  EXPECT_THAT(error(packed.substr(0, packed.size() / 2)), HasSubstr("m.ply: truncated gzip"));
  std::string damaged = packed;
  damaged[packed.size() - 6] ^= 1;  // of the checksum
  EXPECT_THAT(error(damaged), HasSubstr("m.ply: damaged gzip"));
  const std::string half = ascii_sample();
  const size_t middle = half.size() / 2;
  expect_sample(
      read(test::gzip(half.substr(0, middle)) + test::gzip(half.substr(middle))));  // two members
}

}  // namespace
}  // namespace lte::scene::ply
