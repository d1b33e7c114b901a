// The room of the example in C, and its picture by the shipped model, against the path tracer.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lte/pathtrace/irradiance.h"
#include "tests/support/scenes.h"
#include "tests/support/temp_dir.h"

#include "examples/c/room.h"

namespace lte {
namespace {

constexpr int kWidth = 32, kHeight = 24;

/// The room of examples/c/room.c.
scene::Scene room_scene() {
  scene::Scene room;
  const auto wall = [&](const Vec3& corner, const Vec3& a, const Vec3& b, const Rgb& albedo,
                        const Rgb& emission = {}) {
    test::add_quad(&room, corner, a, b, test::add_material(&room, albedo, emission));
  };
  const Vec3 x{4, 0, 0}, y{0, 2.5f, 0}, z{0, 0, 5};
  wall({}, z, x, {0.55f, 0.45f, 0.35f});
  wall(y, x, z, {0.8f, 0.8f, 0.8f});
  wall({}, y, z, {0.65f, 0.1f, 0.1f});
  wall(x, z, y, {0.1f, 0.5f, 0.15f});
  wall({}, x, y, {0.75f, 0.75f, 0.75f});
  wall(z, y, x, {0.75f, 0.75f, 0.75f});
  wall({1.4f, 2.49f, 1.8f}, {1.2f, 0, 0}, {0, 0, 1.4f}, {0, 0, 0}, {12, 11, 9});
  return room;
}

Vec3 vec(const float* v) { return {v[0], v[1], v[2]}; }

pathtrace::Irradiance traced(const std::vector<Surfel>& at, int rays) {
  const scene::Scene scene = room_scene();
  std::vector<Vec3> position, normal;
  for (const Surfel& surfel : at) {
    position.push_back(vec(surfel.position));
    normal.push_back(vec(surfel.normal));
  }
  return pathtrace::estimate_irradiance(pathtrace::Bvh(scene), pathtrace::Lights(scene), position,
                                        normal, {.rays = rays, .max_depth = 5, .seed = 3});
}

TEST(ExampleRoom, LightAtItsSamplesIsThePathTracers) {
  std::vector<Surfel> drawn(60), at;
  room_sample(drawn.data(), drawn.size(), 7);
  for (const Surfel& surfel : drawn) {
    float direct[3], indirect[3];
    room_light(&surfel, 1, 1, direct, indirect);
    // Close above the lamp its edge decides, and the closed form knows nothing of the gap there.
    const float* const p = surfel.position;
    const bool above = p[1] > 2.4f && p[0] > 1 && p[0] < 3 && p[2] > 1.4f && p[2] < 3.6f;
    if (surfel.emission[0] > 0) {
      EXPECT_EQ(direct[0] + indirect[0], 0);
    } else if (!above) {
      at.push_back(surfel);
    }
  }
  ASSERT_GT(at.size(), 40u);
  const pathtrace::Irradiance expected = traced(at, 4096);
  Rgb direct_sum, indirect_sum, wanted_direct, wanted_indirect;
  for (size_t i = 0; i < at.size(); ++i) {
    float direct[3], indirect[3];
    room_light(&at[i], 20'000, static_cast<uint32_t>(i), direct, indirect);
    const auto point = static_cast<int64_t>(i);
    const Rgb traced_direct = expected.direct_sum(point),
              traced_indirect = expected.indirect_sum(point);
    EXPECT_NEAR(direct[0], traced_direct.x, 0.05 * direct[0] + 0.02) << i;
    EXPECT_NEAR(indirect[0], traced_indirect.x, 0.08 * indirect[0]) << i;
    direct_sum += vec(direct);
    indirect_sum += vec(indirect);
    wanted_direct += traced_direct;
    wanted_indirect += traced_indirect;
  }
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(direct_sum[c], wanted_direct[c], 0.01 * wanted_direct[c]);
    EXPECT_NEAR(indirect_sum[c], wanted_indirect[c], 0.015 * wanted_indirect[c]);
  }
}

/// Rows from the top.
std::vector<Rgb> read_pfm(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string line;
  for (int i = 0; i < 3; ++i) std::getline(file, line);
  std::vector<Rgb> out(size_t{kWidth} * kHeight);
  for (int y = kHeight - 1; y >= 0; --y)
    file.read(reinterpret_cast<char*>(out.data() + y * kWidth), sizeof(Rgb) * kWidth);
  EXPECT_TRUE(file.good());
  return out;
}

TEST(ExampleRoom, TheShippedModelsPictureIsThePathTracers) {
  const test::TempDir folder;
  const std::string pfm = (folder.path() / "room.pfm").string(),
                    command =
                        concat(LTE_BINARY_DIR "/bin/render_room assets/models/lte.safetensors '",
                               (folder.path() / "room.ppm").string(), "' '", pfm, "' ", kWidth, ' ',
                               kHeight);
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  const std::vector<Rgb> found = read_pfm(pfm);
  std::vector<Pixel> pixels(found.size());
  room_gbuffer(pixels.data(), kWidth, kHeight);
  std::vector<Surfel> at;
  for (const Pixel& pixel : pixels) at.push_back(pixel.hit);
  const pathtrace::Irradiance expected = traced(at, 256);
  double sum = 0, wanted_sum = 0, square = 0, wanted_square = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    if (!pixels[i].reflects) continue;
    const Rgb wanted = expected.indirect_sum(static_cast<int64_t>(i));
    const float a = luminance(found[i]), b = luminance(wanted);
    sum += a;
    wanted_sum += b;
    square += (a - b) * (a - b);
    wanted_square += b * b;
  }
  EXPECT_NEAR(sum, wanted_sum, 0.12 * wanted_sum);
  EXPECT_LT(std::sqrt(square / wanted_square), 0.15);
}

}  // namespace
}  // namespace lte
