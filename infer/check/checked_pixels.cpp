#include "infer/check/checked_pixels.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lte/base/random.h"
#include "lte/pathtrace/gbuffer.h"

namespace lte::infer {
namespace {

constexpr double kMaxPixels = 1 << 16;
constexpr float kMetallic = 0.05f, kMinAlbedo = 1e-3f;
/// Cosine between the geometric normal through a pixel's middle and the mean shading normal of the
/// pixel, below which several surfaces share it or a normal map bends it.
constexpr float kSameNormal = 0.99f;

}  // namespace

AnsweredLight checked_pixels(const pathtrace::Bvh& bvh, const scene::Camera& camera,
                             const render::Frame& frame, uint64_t seed) {
  AnsweredLight out;
  const int width = frame.albedo.width, height = frame.albedo.height;
  if (frame.gathered_indirect.width != width || width == 0) return out;
  const int square = static_cast<int>(
      std::ceil(std::sqrt(std::max(1.0, double{1} * width * height / kMaxPixels))));
  std::vector<Vec2> points;
  std::vector<size_t> pixels;
  for (int top = 0; top < height; top += square) {
    for (int left = 0; left < width; left += square) {
      Rng rng(seed, frame.albedo.number(left, top));
      const int y = top + static_cast<int>(rng.below(static_cast<uint64_t>(square)));
      const int x = left + static_cast<int>(rng.below(static_cast<uint64_t>(square)));
      if (y >= height || x >= width) continue;
      points.push_back({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
      pixels.push_back(frame.albedo.number(x, y));
    }
  }
  pathtrace::GBuffer hits;
  pathtrace::append_image_points(bvh, camera, width, height, points, &hits);
  for (size_t i = 0; i < pixels.size(); ++i) {
    const bool metal = !hits.metallic.empty() && hits.metallic[i] > kMetallic;
    if (!hits.mask[i] || metal || max_component(hits.albedo[i]) < kMinAlbedo ||
        dot(hits.geometric(i), frame.normal.rgb(pixels[i])) < kSameNormal)
      continue;
    out.add(hits.position[i], hits.geometric(i), frame.gathered_indirect.rgb(pixels[i]));
  }
  return out;
}

}  // namespace lte::infer
