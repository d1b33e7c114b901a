#include "lte/render/edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/parallel.h"

namespace lte::render {
namespace {

// What an eye sees as one surface stays one.
constexpr float kSameNormal = 0.97f;   // cosine, 14 degrees
constexpr float kColorStep = 0.15f;    // of the root of albedo, about that of display values
constexpr float kEmissionStep = 0.1f;  // relative
constexpr int64_t kRows = 8;

enum Kind : uint8_t { kSurface = 1, kColor = 2, kLamp = 4 };

bool same_surface(const Film& film, size_t a, size_t b, float pixel_size) {
  if (film.sees_surface(a) != film.sees_surface(b)) return false;
  if (!film.sees_surface(a)) return true;
  const Vec3 normal_a = film.normal.rgb(a), normal_b = film.normal.rgb(b);
  if (dot(normal_a, normal_b) < kSameNormal) return false;
  const Vec3 between = film.position.rgb(b) - film.position.rgb(a);
  const float tolerance = std::min(film.depth[a], film.depth[b]) * pixel_size;
  return std::abs(dot(between, normal_a)) <= tolerance &&
         std::abs(dot(between, normal_b)) <= tolerance;
}

bool same_color(const Rgb& a, const Rgb& b) {
  for (int c = 0; c < 3; ++c) {
    if (std::abs(std::sqrt(a[c]) - std::sqrt(b[c])) > kColorStep) return false;
  }
  return true;
}

bool same_emission(const Rgb& a, const Rgb& b) {
  for (int c = 0; c < 3; ++c) {
    if (std::abs(a[c] - b[c]) > kEmissionStep * std::max(a[c], b[c])) return false;
  }
  return true;
}

}  // namespace

Edges find_edges(const Film& film, float pixel_size) {
  LTE_CHECK(film.passes == 1, "edges are found after the first pass");
  constexpr std::array<std::pair<int, int>, 8> kAround = {
      {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
  std::vector<uint8_t> kinds(film.pixels());
  parallel_for(film.height, kRows, [&](int64_t begin, int64_t end) {
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < film.width; ++x) {
        const size_t i = film.number(x, y);
        for (const auto& [dx, dy] : kAround) {
          if (x + dx < 0 || x + dx >= film.width || y + dy < 0 || y + dy >= film.height) continue;
          const size_t j = film.number(x + dx, y + dy);
          if (!same_emission(film.emission.rgb(i), film.emission.rgb(j))) kinds[i] |= kLamp;
          if (dx * dy != 0) continue;
          if (!same_surface(film, i, j, pixel_size)) {
            kinds[i] |= kSurface;
          } else if (!same_color(film.albedo.rgb(i), film.albedo.rgb(j))) {
            kinds[i] |= kColor;
          }
        }
      }
    }
  });
  Edges out;
  for (size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i] & kSurface) {
      out.surface.push_back(i);
    } else if (kinds[i] & kColor) {
      out.color.push_back(i);
    }
    if (kinds[i] & kLamp) out.lamp.push_back(i);
  }
  return out;
}

}  // namespace lte::render
