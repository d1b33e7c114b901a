#include "lte/gi/contacts.h"

#include <algorithm>

#include "lte/base/parallel.h"

namespace lte::gi {
namespace {

/// Points of a contact lie within so many edges of a pixel: pixels at a glancing angle are long.
constexpr float kReach = 4;
/// A surface that is bent by less than this has no crease: cosine, 26°.
constexpr float kCrease = 0.9f;

bool touch(const PixelSurfaces& surfaces, size_t a, size_t b) {
  if (!surfaces.mask[a] || !surfaces.mask[b]) return false;
  const Vec3 &normal_a = surfaces.normal[a], &normal_b = surfaces.normal[b];
  if (dot(normal_a, normal_b) > kCrease) return false;
  const Vec3 between = surfaces.position[b] - surfaces.position[a];
  if (dot(between, normal_a) <= 0 || dot(between, normal_b) >= 0) return false;
  const float reach = kReach * surfaces.pixel_size * std::min(surfaces.depth[a], surfaces.depth[b]);
  return dot(between, between) <= reach * reach;
}

}  // namespace

std::vector<uint8_t> find_contacts(const PixelSurfaces& surfaces, int radius) {
  if (radius < 0) return {};
  const int width = surfaces.width, height = surfaces.height;
  std::vector<uint8_t> at(surfaces.size());
  parallel_for(height, 8, [&](int64_t begin, int64_t end) {
    for (int y = static_cast<int>(begin); y < end; ++y) {
      for (int x = 0; x < width; ++x) {
        const size_t i = surfaces.at(x, y);
        const bool meets = (x > 0 && touch(surfaces, i, i - 1)) ||
                           (x + 1 < width && touch(surfaces, i, i + 1)) ||
                           (y > 0 && touch(surfaces, i, surfaces.at(x, y - 1))) ||
                           (y + 1 < height && touch(surfaces, i, surfaces.at(x, y + 1)));
        at[i] = meets ? 1 : 0;
      }
    }
  });
  if (radius == 0) return at;
  // A square grows by its columns, then by its rows.
  std::vector<uint8_t> wide(at.size()), out(at.size());
  parallel_for(height, 8, [&](int64_t begin, int64_t end) {
    for (int y = static_cast<int>(begin); y < end; ++y) {
      for (int x = 0; x < width; ++x) {
        if (!at[surfaces.at(x, y)]) continue;
        const int last = std::min(x + radius, width - 1);
        for (int near = std::max(x - radius, 0); near <= last; ++near)
          wide[surfaces.at(near, y)] = 1;
      }
    }
  });
  parallel_for(height, 8, [&](int64_t begin, int64_t end) {
    for (int y = static_cast<int>(begin); y < end; ++y) {
      const int last = std::min(y + radius, height - 1);
      for (int near = std::max(y - radius, 0); near <= last; ++near) {
        for (int x = 0; x < width; ++x) out[surfaces.at(x, y)] |= wide[surfaces.at(x, near)];
      }
    }
  });
  return out;
}

}  // namespace lte::gi
