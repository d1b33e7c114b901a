#include "lte/bake/finish.h"

#include <algorithm>
#include <cmath>

#include "lte/base/parallel.h"
#include "lte/pathtrace/ray_offset.h"

namespace lte::bake {
namespace {

constexpr uint8_t kOutside = static_cast<uint8_t>(Texel::Outside);
constexpr uint8_t kLit = static_cast<uint8_t>(Texel::Lit);
constexpr uint8_t kFilled = static_cast<uint8_t>(Texel::Filled);
constexpr uint8_t kDarkTexel = static_cast<uint8_t>(Texel::Dark);

/// Calls use(pixel) for the up to eight pixels around one.
template <typename Use>
void for_pixels_around(const Atlas& atlas, uint32_t pixel, const Use& use) {
  const int x = static_cast<int>(pixel % static_cast<uint32_t>(atlas.width));
  const int y = static_cast<int>(pixel / static_cast<uint32_t>(atlas.width));
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int nx = x + dx, ny = y + dy;
      if ((dx == 0 && dy == 0) || nx < 0 || ny < 0 || nx >= atlas.width || ny >= atlas.height)
        continue;
      use(static_cast<uint32_t>(ny) * static_cast<uint32_t>(atlas.width) +
          static_cast<uint32_t>(nx));
    }
  }
}

std::vector<int32_t> chart_picture(const Atlas& atlas, const Texels& texels) {
  std::vector<int32_t> out(static_cast<size_t>(atlas.width) * static_cast<size_t>(atlas.height),
                           scene::kNone);
  for (size_t i = 0; i < texels.size(); ++i) out[texels.pixel[i]] = texels.chart[i];
  return out;
}

/// Whether a front face lies within a texel above.
bool is_covered(const pathtrace::Bvh& bvh, const Texels& texels, const TexelLight& light,
                size_t i) {
  const Vec3 normal =
      light.back[static_cast<size_t>(texels.chart[i])] != 0 ? -texels.normal[i] : texels.normal[i];
  pathtrace::Ray ray{pathtrace::offset_origin(texels.position[i], normal), normal};
  ray.t_max = texels.edge[i];
  const pathtrace::Hit hit = bvh.intersect(ray);
  return hit.valid() && dot(hit.normal, normal) < 0;
}

/// Makes the pixels within kDilation of a chart Filled.
void dilate(const Atlas& atlas, const Texels& texels, std::vector<uint8_t>* mask) {
  std::vector<uint32_t> border = texels.pixel;
  for (int round = 0; round < kDilation; ++round) {
    std::vector<uint32_t> next;
    for (const uint32_t pixel : border) {
      for_pixels_around(atlas, pixel, [&](uint32_t other) {
        if ((*mask)[other] != kOutside) return;
        (*mask)[other] = kFilled;
        next.push_back(other);
      });
    }
    border = std::move(next);
  }
}

std::vector<uint8_t> mask_of_texels(const Atlas& atlas, const Texels& texels,
                                    std::span<const uint8_t> dark) {
  std::vector<uint8_t> mask(static_cast<size_t>(atlas.width) * static_cast<size_t>(atlas.height),
                            kOutside);
  for (size_t i = 0; i < texels.size(); ++i)
    mask[texels.pixel[i]] = dark[i] != 0 ? kDarkTexel : kLit;
  return mask;
}

}  // namespace

std::vector<uint8_t> make_mask(const Atlas& atlas, const Texels& texels,
                               std::span<const uint8_t> dark) {
  std::vector<uint8_t> mask = mask_of_texels(atlas, texels, dark);
  dilate(atlas, texels, &mask);
  return mask;
}

std::vector<uint8_t> make_mask(const pathtrace::Bvh& bvh, const Atlas& atlas, const Texels& texels,
                               const TexelLight& light) {
  const std::vector<int32_t> chart = chart_picture(atlas, texels);
  std::vector<uint8_t> mask = mask_of_texels(atlas, texels, light.dark);
  std::vector<uint32_t> open;  // dark, and behind something
  for (size_t i = 0; i < texels.size(); ++i)
    if (light.dark[i] != 0 && !is_covered(bvh, texels, light, i)) open.push_back(texels.pixel[i]);
  for (int round = 0; round < kDilation; ++round) {
    std::vector<uint32_t> found;
    for (const uint32_t pixel : open) {
      bool beside = false;
      for_pixels_around(atlas, pixel, [&](uint32_t other) {
        beside = beside || (chart[other] == chart[pixel] && mask[other] != kDarkTexel);
      });
      if (beside) found.push_back(pixel);
    }
    for (const uint32_t pixel : found) mask[pixel] = kFilled;
    std::erase_if(open, [&](uint32_t pixel) { return mask[pixel] == kFilled; });
  }
  dilate(atlas, texels, &mask);
  return mask;
}

std::vector<float> paint(const Atlas& atlas, const Texels& texels, std::span<const Rgb> light,
                         const std::vector<uint8_t>& mask) {
  const std::vector<int32_t> chart = chart_picture(atlas, texels);
  std::vector<float> out(3 * mask.size());
  std::vector<uint8_t> known(mask.size());
  for (size_t i = 0; i < texels.size(); ++i) {
    const uint32_t pixel = texels.pixel[i];
    if (mask[pixel] == kFilled) continue;
    known[pixel] = 1;
    for (size_t c = 0; c < 3; ++c) out[3 * pixel + c] = light[i][static_cast<int>(c)];
  }
  // Inside charts first: what lies beyond takes after them.
  for (const bool inside : {true, false}) {
    std::vector<uint32_t> open;
    for (uint32_t pixel = 0; pixel < mask.size(); ++pixel)
      if (mask[pixel] == kFilled && (chart[pixel] != scene::kNone) == inside) open.push_back(pixel);
    for (int round = 0; round <= kDilation && !open.empty(); ++round) {
      std::vector<std::pair<uint32_t, Rgb>> found;
      for (const uint32_t pixel : open) {
        Rgb sum;
        float count = 0;
        for_pixels_around(atlas, pixel, [&](uint32_t other) {
          const bool takes =
              known[other] != 0 &&
              (!inside || (chart[other] == chart[pixel] && mask[other] != kDarkTexel));
          if (!takes) return;
          sum += Rgb{out[3 * other], out[3 * other + 1], out[3 * other + 2]};
          ++count;
        });
        if (count > 0) found.emplace_back(pixel, sum / count);
      }
      for (const auto& [pixel, value] : found) {
        known[pixel] = 1;
        for (size_t c = 0; c < 3; ++c) out[3 * pixel + c] = value[static_cast<int>(c)];
      }
      std::erase_if(open, [&](uint32_t pixel) { return known[pixel] != 0; });
    }
  }
  return out;
}

}  // namespace lte::bake
