#include "lte/render/edges.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lte/base/check.h"
#include "lte/base/parallel.h"

namespace lte::render {
namespace {

// What an eye sees as one surface stays one.
constexpr float kSameNormal = 0.97f;   // cosine, 14 degrees
constexpr float kSharedNormal = 0.9f;  // cosine, 26 degrees: one light for both
constexpr float kColorStep = 0.15f;    // of the root of albedo, about that of display values
constexpr float kEmissionStep = 0.1f;  // relative
constexpr int64_t kRows = 8;

enum Kind : uint8_t { kSurface = 1, kColor = 2, kLamp = 4 };

bool same_plane(const SurfacePlace& a, const SurfacePlace& b) {
  const Vec3 between = b.position - a.position;
  const float tolerance = std::min(a.tolerance, b.tolerance);
  return std::abs(dot(between, a.normal)) <= tolerance &&
         std::abs(dot(between, b.normal)) <= tolerance;
}

bool same_surface(const Film& film, size_t a, size_t b) {
  if (film.sees_surface(a) != film.sees_surface(b)) return false;
  return !film.sees_surface(a) || same_surface(film.center(a), film.center(b));
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

bool same_surface(const SurfacePlace& a, const SurfacePlace& b) {
  return dot(a.normal, b.normal) >= kSameNormal && same_plane(a, b);
}

bool shares_light(const SurfacePlace& a, const SurfacePlace& b) {
  return dot(a.normal, b.normal) >= kSharedNormal && same_plane(a, b);
}

int light_source(const Film& film, size_t pixel, const SurfacePlace& hit) {
  int best = -1;
  float best_distance = INFINITY;
  for (size_t k = 0; k < kNearPixels.size(); ++k) {
    const size_t source = film.near_pixel(pixel, k);
    if (source == Film::kNoPixel || !film.is_lit(source)) continue;
    SurfacePlace center = film.center(source);
    center.tolerance = hit.tolerance;
    const Vec3 between = center.position - hit.position;
    const float distance = dot(between, between);
    if (!(distance < best_distance) || !shares_light(center, hit)) continue;
    best = static_cast<int>(k);
    best_distance = distance;
  }
  return best;
}

Edges find_edges(const Film& film) {
  LTE_CHECK(film.passes == 1, "edges are found after the first pass");
  std::vector<uint8_t> kinds(film.pixels());
  parallel_for(film.height, kRows, [&](int64_t begin, int64_t end) {
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < film.width; ++x) {
        const size_t i = film.number(x, y);
        for (size_t k = 1; k < kNearPixels.size(); ++k) {
          const size_t j = film.near_pixel(i, k);
          if (j == Film::kNoPixel) continue;
          if (!same_emission(film.emission.rgb(i), film.emission.rgb(j))) kinds[i] |= kLamp;
          if (kNearPixels[k].first * kNearPixels[k].second != 0) continue;
          if (!same_surface(film, i, j)) {
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
