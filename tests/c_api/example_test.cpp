// The C program's picture against the C++ library at the same points, and its room.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "lte/base/check.h"
#include "lte/runtime/embedding.h"

#include "examples/c/room.h"

namespace lte {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 64, kHeight = 48;
constexpr size_t kPixels = size_t{kWidth} * kHeight;
constexpr int kPaths = 32;  // of render_room

Vec3 vec(const float* v) { return {v[0], v[1], v[2]}; }

/// Rows from the top.
std::vector<Rgb> read_pfm(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  int width = 0, height = 0;
  double endian = 0;
  file >> magic >> width >> height >> endian;
  file.get();
  EXPECT_EQ(magic, "PF");
  EXPECT_EQ(width, kWidth);
  EXPECT_EQ(height, kHeight);
  EXPECT_EQ(endian, -1);
  std::vector<Rgb> out(kPixels);
  for (int y = kHeight - 1; y >= 0; --y) {
    file.read(reinterpret_cast<char*>(out.data() + y * kWidth), sizeof(Rgb) * kWidth);
  }
  EXPECT_TRUE(file.good());
  return out;
}

/// What the C++ library answers at the room's points; zero on the lamp.
std::vector<Rgb> predicted(const std::string& model) {
  const runtime::Network network(model);
  const auto M = static_cast<size_t>(network.metadata().scene_points);
  std::vector<Surfel> surfels(M);
  const std::vector<float> area(M, room_sample(surfels.data(), M, 1));
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo, emission, direct, indirect;
  std::vector<float> error;
  const bool lit = network.light_request().depth > 0;
  for (uint32_t i = 0; i < (lit ? M : 0); ++i) {
    float of_lamp[3], bounced[3];
    error.push_back(room_light(&surfels[i], kPaths, i, of_lamp, bounced));
    error.push_back(0);
    direct.push_back(vec(of_lamp));
    indirect.push_back(vec(bounced));
  }
  const std::vector<Rgb> behind(direct.size());
  for (const Surfel& s : surfels) {
    position.push_back(vec(s.position));
    normal.push_back(vec(s.normal));
    albedo.push_back(vec(s.albedo));
    emission.push_back(vec(s.emission));
  }
  const runtime::SceneEmbedding embedding(
      network, {position, normal, albedo, emission, area, direct, indirect, behind, behind, error});

  std::vector<Pixel> pixels(kPixels);
  room_gbuffer(pixels.data(), kWidth, kHeight);
  std::vector<Vec3> at, facing;
  std::vector<Rgb> color;
  for (const Pixel& p : pixels) {
    at.push_back(vec(p.hit.position));
    facing.push_back(vec(p.hit.normal));
    color.push_back(vec(p.hit.albedo));
  }
  std::vector<Rgb> out = embedding.decode({at, facing, color});
  for (size_t i = 0; i < kPixels; ++i) {
    if (pixels[i].reflects == 0) out[i] = {};
  }
  return out;
}

class CExample : public testing::TestWithParam<const char*> {};

TEST_P(CExample, ItsPictureIsTheCppLibrarys) {
  const std::string model = std::string("assets/models/") + GetParam() + ".safetensors";
  const fs::path stem =
      fs::temp_directory_path() / ("lte_render_room_" + std::to_string(::getpid()));
  const std::string ppm = stem.string() + ".ppm", pfm = stem.string() + ".pfm";
  const std::string command =
      concat(LTE_RENDER_ROOM, ' ', model, ' ', ppm, ' ', pfm, ' ', kWidth, ' ', kHeight);
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  EXPECT_EQ(fs::file_size(ppm), std::string("P6\n64 48\n255\n").size() + 3 * kPixels);
  const std::vector<Rgb> got = read_pfm(pfm), expected = predicted(model);
  float largest = 0, difference = 0;
  for (size_t i = 0; i < kPixels; ++i) {
    for (int c = 0; c < 3; ++c) {
      largest = std::max(largest, expected[i][c]);
      difference = std::max(difference, std::abs(got[i][c] - expected[i][c]));
    }
  }
  EXPECT_GT(largest, 0.1f);
  EXPECT_LE(difference, 1e-6f * largest);
  fs::remove(ppm);
  fs::remove(pfm);
  EXPECT_NE(std::system(concat(LTE_RENDER_ROOM, " README.md ", ppm, " 2>/dev/null").c_str()), 0);
  EXPECT_FALSE(fs::exists(ppm));
}

INSTANTIATE_TEST_SUITE_P(ShippedModels, CExample,
                         testing::Values("lte-paper", "lte", "lte-radiance"));

TEST(CExampleRoom, DirectLightIsTheSumOverTheLamp) {
  std::vector<Pixel> pixels(kPixels);
  room_gbuffer(pixels.data(), kWidth, kHeight);
  for (size_t i = 0; i < kPixels; i += 311) {
    const Vec3 at = vec(pixels[i].hit.position), normal = vec(pixels[i].hit.normal);
    constexpr int kGrid = 200;
    double sum = 0;
    for (int k = 0; k < kGrid * kGrid; ++k) {
      const float u = (static_cast<float>(k % kGrid) + 0.5f) / kGrid,
                  v = (static_cast<float>(k / kGrid) + 0.5f) / kGrid;
      const Vec3 to = Vec3{1.4f + 1.2f * u, 2.49f, 1.8f + 1.4f * v} - at;
      const double d2 = dot(to, to), here = dot(to, normal), there = to[1];
      if (here > 0 && there > 0) sum += here * there / (d2 * d2);
    }
    float direct[3];
    room_direct(&pixels[i].hit, direct);
    EXPECT_NEAR(direct[0], 12 * sum * 1.2 * 1.4 / (kGrid * kGrid), 1e-3) << i;
  }
}

}  // namespace
}  // namespace lte
