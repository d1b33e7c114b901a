#include "infer/renderer/reflected_light.h"

#include <algorithm>

#include "lte/base/check.h"
#include "lte/pathtrace/incident/reflections.h"

namespace lte::infer {
namespace {

/// Places in a pixel: enough to smooth edges; each costs as much as many directions.
constexpr int kPlaces = 4;
/// Pixels whose draws are in memory at a time.
constexpr size_t kPixelsAtOnce = size_t{1} << 14;

}  // namespace

std::vector<Rgb> reflected_light(const pathtrace::Bvh& bvh, const EmbeddingDraws& draws,
                                 const scene::Camera& camera, const ReflectedSettings& settings,
                                 std::span<const int64_t> pixels) {
  LTE_CHECK(draws.network().config().predicts_radiance(),
            "--metal network: the model has no radiance decoder (its model.radiance_lobes is 0)");
  pathtrace::ReflectionOptions options;
  options.points = std::min(kPlaces, settings.directions);
  options.directions = settings.directions / options.points;
  options.seed = settings.seed;
  const float share = 1 / static_cast<float>(options.points * options.directions);
  std::vector<Rgb> out(pixels.size());
  for (size_t begin = 0; begin < pixels.size(); begin += kPixelsAtOnce) {
    const size_t count = std::min(kPixelsAtOnce, pixels.size() - begin);
    const pathtrace::Reflections drawn = pathtrace::draw_reflections(
        bvh, camera, settings.width, settings.height, pixels.subspan(begin, count), options);
    const std::vector<Rgb> radiance =
        draws.decode_radiance({drawn.position, drawn.normal, drawn.albedo}, drawn.direction);
    for (size_t i = 0; i < radiance.size(); ++i) {
      const size_t point = i / static_cast<size_t>(options.directions);
      out[begin + static_cast<size_t>(drawn.pixel[point])] += drawn.weight[i] * radiance[i] * share;
    }
  }
  return out;
}

}  // namespace lte::infer
