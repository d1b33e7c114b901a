#include "lte/bake/probes.h"

#include <cmath>

#include <gmock/gmock.h>

#include "lte/bake/formats/probe_files.h"
#include "lte/image/exr.h"
#include "lte/pathtrace/irradiance.h"
#include "tests/support/closed_forms.h"
#include "tests/support/room.h"
#include "tests/support/temp_dir.h"

namespace lte::bake {
namespace {

using test::error_of;
using test::TempDir;
using testing::HasSubstr;

const std::vector<Vec3> kDirections{{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                    {0, -1, 0}, {0, 0, 1},  {0.48f, -0.6f, 0.64f}};

/// A black triangle far off, so that there is a BVH; lights are the caller's.
scene::Scene empty_space() {
  scene::Scene scene;
  const int black = test::add_material(&scene, {0, 0, 0});
  test::add_quad(&scene, {1000, 1000, 1000}, {1e-3f, 0, 0}, {0, 1e-3f, 0}, black);
  return scene;
}

ProbeGrid one_probe(const Vec3& position) {
  ProbeGrid grid;
  grid.bounds.extend(position - Vec3{0.5f, 0.5f, 0.5f});
  grid.bounds.extend(position + Vec3{0.5f, 0.5f, 0.5f});
  return grid;
}

Probe bake_one(const scene::Scene& scene, const Vec3& position, const ProbeOptions& options = {}) {
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  return bake_probes(bvh, lights, one_probe(position), options).probes[0];
}

TEST(ProbeGrid, AutoCutsTheLongestSideInto16) {
  Bounds room;
  room.extend({0, 0, 0});
  room.extend({8, 2.5f, 4});
  const ProbeGrid grid = parse_probe_grid("auto", room);
  EXPECT_EQ(grid.counts, (std::array{16, 5, 8}));
  EXPECT_EQ(grid.size(), 640);
  EXPECT_EQ(grid.position(0), (Vec3{0.25f, 0.25f, 0.25f}));
  EXPECT_EQ(grid.position(639), (Vec3{7.75f, 2.25f, 3.75f}));
  EXPECT_EQ(parse_probe_grid("3x1x256", room).counts, (std::array{3, 1, 256}));
  for (const char* wrong : {"", "3", "3x3", "3x3x0", "3x3x257", "3x3x3x3", "axbxc", "-1x2x3"}) {
    EXPECT_THAT(error_of([&] { parse_probe_grid(wrong, room); }),
                HasSubstr("--probes: expected auto or NXxNYxNZ"))
        << wrong;
  }
}

TEST(SphericalHarmonics, AreOrthonormal) {
  constexpr int kRows = 200, kColumns = 100;
  std::array<std::array<double, kShCoefficients>, kShCoefficients> products{};
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const double z = 1 - (2 * row + 1.0) / kRows, angle = 2 * M_PI * (column + 0.5) / kColumns;
      const double radius = std::sqrt(1 - z * z);
      const auto basis =
          sh_basis({static_cast<float>(radius * std::cos(angle)),
                    static_cast<float>(radius * std::sin(angle)), static_cast<float>(z)});
      for (size_t a = 0; a < basis.size(); ++a) {
        for (size_t b = 0; b < basis.size(); ++b)
          products[a][b] += 4 * M_PI / (kRows * kColumns) * basis[a] * basis[b];
      }
    }
  }
  for (size_t a = 0; a < products.size(); ++a) {
    for (size_t b = 0; b < products.size(); ++b)
      EXPECT_NEAR(products[a][b], a == b ? 1 : 0, 1e-3) << a << ' ' << b;
  }
}

TEST(Probes, AConstantSkyHasItsFirstCoefficientAlone) {
  scene::Scene scene = empty_space();
  scene.environment.emplace();
  scene.environment->radiance = {2, 1, 0.5f};
  scene.environment->light_group = 0;
  scene.light_groups = {"sky"};
  const Probe probe = bake_one(scene, {0, 0, 0}, {.rays = 4096});
  EXPECT_NEAR(probe.radiance[0].x, std::sqrt(4 * M_PI) * 2, 1e-3);
  EXPECT_NEAR(probe.radiance[0].z, std::sqrt(4 * M_PI) * 0.5, 1e-3);
  for (size_t k = 1; k < kShCoefficients; ++k) EXPECT_NEAR(probe.radiance[k].x, 0, 5e-3) << k;
  for (const Vec3& n : kDirections) EXPECT_NEAR(sh_irradiance(probe, n).x, 2 * M_PI, 1e-2);
  for (const Rgb& side : probe.irradiance) EXPECT_NEAR(side.y, M_PI, 1e-2);
  EXPECT_TRUE(probe.valid);
  EXPECT_EQ(probe.back_faces, 0);
}

TEST(Probes, ADistantLightHasTheHarmonicsOfItsDirection) {
  scene::Scene scene = empty_space();
  scene::PunctualLight sun;
  sun.kind = scene::LightKind::Directional;
  sun.direction = -normalize(Vec3{0.48f, -0.6f, 0.64f});
  sun.intensity = {3, 2, 1};
  sun.light_group = 0;
  scene.lights.push_back(sun);
  scene.light_groups = {"sun"};
  const Probe probe = bake_one(scene, {0, 0, 0}, {.rays = 64});
  const auto basis = sh_basis(-sun.direction);
  for (size_t k = 0; k < basis.size(); ++k)
    EXPECT_NEAR(probe.radiance[k].x, 3 * basis[k], 1e-4) << k;
  // The cube has the cosine itself, without the ringing of nine coefficients.
  const std::array<double, kCubeSides> cosines{0, 0.48, 0.6, 0, 0, 0.64};
  for (size_t side = 0; side < kCubeSides; ++side)
    EXPECT_NEAR(probe.irradiance[side].y, 2 * cosines[side], 1e-4) << side;
  const Probe indirect = bake_one(scene, {0, 0, 0}, {.rays = 64, .direct = false});
  for (const Rgb& value : indirect.radiance) EXPECT_EQ(value, Rgb{});
}

// In a closed room of albedo a that emits Le everywhere, radiance is Le (1 + a + ... + a^(d-1)).
TEST(Probes, AFurnaceIsTheSameInAllDirections) {
  scene::Scene scene;
  const int wall = test::add_material(&scene, {0.5f, 0.5f, 0.5f}, {1, 1, 1});
  test::add_instance(&scene, test::box_mesh({0, 0, 0}, {4, 2, 3}, wall, /*inwards=*/true));
  const Probe probe = bake_one(scene, {1, 0.7f, 2}, {.rays = 16384, .max_depth = 5});
  const double radiance = test::geometric_sum(0.5, 5);
  EXPECT_NEAR(probe.radiance[0].x, std::sqrt(4 * M_PI) * radiance, 0.01 * radiance);
  for (size_t k = 1; k < kShCoefficients; ++k) EXPECT_NEAR(probe.radiance[k].y, 0, 0.05) << k;
  for (const Rgb& side : probe.irradiance)
    EXPECT_NEAR(side.z, M_PI * radiance, 0.02 * M_PI * radiance);
}

TEST(Probes, DepthMomentsOfABallAreItsRadius) {
  scene::Scene scene;
  const int wall = test::add_material(&scene, {0.5f, 0.5f, 0.5f});
  test::add_instance(&scene, test::inward_sphere_mesh(3, 5, wall));
  const Probe probe = bake_one(scene, {0, 0, 0}, {.rays = 512});
  for (size_t side = 0; side < kCubeSides; ++side) {
    EXPECT_NEAR(probe.distance[side], 3, 0.01);
    EXPECT_NEAR(probe.distance2[side], 9, 0.06);
  }
}

TEST(Probes, CubeSidesAreThePathTracersIrradiance) {
  const test::Room room;
  const Vec3 place{2, 1.6f, 1.5f};
  const Probe probe =
      bake_probes(room.bvh, room.lights, one_probe(place), {.rays = 65536, .seed = 3}).probes[0];
  const std::vector<Vec3> normals{{-1, 0, 0}, {1, 0, 0},  {0, -1, 0},
                                  {0, 1, 0},  {0, 0, -1}, {0, 0, 1}};
  const std::vector<Vec3> positions(normals.size(), place);
  pathtrace::IrradianceOptions options;
  options.by_group = false;
  options.rays = 65536;
  const pathtrace::Irradiance truth =
      pathtrace::estimate_irradiance(room.bvh, room.lights, positions, normals, options);
  for (size_t side = 0; side < kCubeSides; ++side) {
    const Rgb expected = truth.direct[side] + truth.indirect[side];
    EXPECT_NEAR(luminance(probe.irradiance[side]), luminance(expected), 0.02 * luminance(expected))
        << side;
    // Nine coefficients are off by some per cent of the brightest direction (Ramamoorthi and
    // Hanrahan 2001).
    EXPECT_NEAR(luminance(sh_irradiance(probe, normals[side])), luminance(expected),
                0.04 * luminance(probe.irradiance[3]))
        << side;
  }
}

TEST(Probes, IndirectLeavesOutWhatNoSurfaceHasReflected) {
  const test::Room room;
  const Vec3 place{2, 1.6f, 1.5f};
  const Probe probe =
      bake_probes(room.bvh, room.lights, one_probe(place), {.rays = 16384, .direct = false})
          .probes[0];
  const std::vector<Vec3> positions{place}, normals{{0, 1, 0}};
  pathtrace::IrradianceOptions options;
  options.by_group = false;
  options.rays = 16384;
  const Rgb truth =
      pathtrace::estimate_irradiance(room.bvh, room.lights, positions, normals, options)
          .indirect[0];
  EXPECT_NEAR(luminance(probe.irradiance[3]), luminance(truth), 0.03 * luminance(truth));
}

TEST(Probes, ThoseInWallsAreInvalidAndTakeTheirNeighborsLight) {
  const test::Room room;
  // The second probe along x stands in the red box, [0.5, 1.3] x [0, 1.1] x [0.5, 1.4].
  ProbeGrid grid;
  grid.counts = {3, 1, 1};
  grid.bounds.extend({0, 0.2f, 0.8f});
  grid.bounds.extend({3, 0.8f, 1});
  grid.bounds.low.x = -0.4f;
  grid.bounds.high.x = 2.2f;
  const ProbeVolume volume = bake_probes(room.bvh, room.lights, grid, {.rays = 256});
  EXPECT_EQ(volume.invalid, 1);
  EXPECT_FALSE(volume.probes[1].valid);
  EXPECT_GT(volume.probes[1].back_faces, 0.9f);
  for (size_t k = 0; k < kShCoefficients; ++k) {
    const Rgb mean = (volume.probes[0].radiance[k] + volume.probes[2].radiance[k]) * 0.5f;
    EXPECT_NEAR(volume.probes[1].radiance[k].x, mean.x, 1e-5) << k;
  }
  const auto in_wall = [&] {
    bake_probes(room.bvh, room.lights, one_probe({0.9f, 0.5f, 0.9f}), {.rays = 64});
  };
  EXPECT_THAT(error_of(in_wall), HasSubstr("--probes: all 1 probes are in walls"));
}

TEST(Probes, TheSameForAnySplitOfTheWork) {
  const test::Room room;
  ProbeGrid grid = parse_probe_grid("3x2x2", room.scene.bounds());
  const auto bytes = [&] {
    const ProbeVolume volume = bake_probes(room.bvh, room.lights, grid, {.rays = 64});
    const TempDir folder;
    FileSet files(folder.path());
    write_probes(volume, &files);
    files.commit();
    return read_file(folder / "probes.json");
  };
  EXPECT_EQ(bytes(), bytes());
}

TEST(ProbeFiles, HaveAPixelAProbe) {
  const test::Room room;
  const ProbeVolume volume = bake_probes(
      room.bvh, room.lights, parse_probe_grid("3x2x2", room.scene.bounds()), {.rays = 64});
  const TempDir folder;
  FileSet files(folder.path());
  write_probes(volume, &files);
  files.commit();
  const image::Image sh = image::read_exr(folder / "probes.exr", "sh3");
  EXPECT_EQ(sh.width, 3);
  EXPECT_EQ(sh.height, 4);
  // Probe (2, 1, 1).
  EXPECT_EQ(sh.rgb(2, 3), volume.probes[11].radiance[3]);
  EXPECT_EQ(image::read_exr(folder / "probes.exr", "depth_py").rgb(1, 2).y,
            volume.probes[7].distance2[3]);
}

// By the shader's own reading of the texture (crates/bevy_pbr/src/light_probe/
// irradiance_volume.wgsl): a normal below 0 looks half a texture further along y.
TEST(ProbeFiles, BevysShaderFindsTheSides) {
  ProbeVolume volume;
  volume.grid.counts = {3, 2, 4};
  for (int i = 0; i < volume.grid.size(); ++i) {
    Probe probe;
    for (int side = 0; side < kCubeSides; ++side)
      probe.irradiance[static_cast<size_t>(side)] = Rgb{1, 1, 1} * (kPi * (8 * i + side));
    volume.probes.push_back(probe);
  }
  const image::Ktx2 texture = bevy_volume(volume);
  EXPECT_EQ(texture.width, 3);
  EXPECT_EQ(texture.height, 4);
  EXPECT_EQ(texture.depth, 12);
  for (int i = 0; i < volume.grid.size(); ++i) {
    const int x = i % 3, y = i / 3 % 2, z = i / 6;
    for (int side = 0; side < kCubeSides; ++side) {
      const int axis = side / 2;
      const bool negative = side % 2 == 0;
      const double v = (y + 0.5) / texture.height + (negative ? 0.5 : 0);
      const double w = (z + 0.5) / texture.depth + axis / 3.0;
      const auto row = static_cast<size_t>(v * texture.height);
      const auto slice = static_cast<size_t>(w * texture.depth);
      const Rgb texel = texture.texels[(slice * 4 + row) * 3 + static_cast<size_t>(x)];
      EXPECT_NEAR(texel.x, 8 * i + side, 1e-3);
    }
  }
}

}  // namespace
}  // namespace lte::bake
