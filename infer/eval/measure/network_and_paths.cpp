#include "infer/eval/measure/network_and_paths.h"

#include <algorithm>
#include <cstdint>

#include "infer/eval/measure/scores.h"
#include "lte/base/check.h"
#include "lte/image/image.h"

namespace lte::infer {
namespace {

/// Denoised paths of the same weight as the network.
constexpr float kNetworkPaths = 2;

/// The mean around pixel (x, y) of the pixels whose mask is set, as (x, y) itself is.
Rgb mean_around(const image::Image& picture, std::span<const uint8_t> mask, int x, int y) {
  Rgb sum{};
  float total = 0;
  for (int v = std::max(0, y - 1); v <= std::min(picture.height - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(picture.width - 1, x + 1); ++u) {
      if (!mask[picture.number(u, v)]) continue;
      const float weight = (u == x ? 2.0f : 1.0f) * (v == y ? 2.0f : 1.0f);
      sum += weight * picture.rgb(u, v);
      total += weight;
    }
  }
  return sum * (1 / total);
}

}  // namespace

std::vector<Rgb> combine(const data::View& view, std::span<const Rgb> network,
                         std::span<const Rgb> clean, int paths) {
  LTE_CHECK(network.size() == clean.size() && paths > 0,
            "combining network and paths: ", network.size(), " and ", clean.size(), " pixels of ",
            paths, " paths");
  std::vector<Rgb> difference;
  for (size_t i = 0; i < network.size(); ++i) difference.push_back(clean[i] - network[i]);
  const image::Image change = fill_mask(difference, view.mask, view.width, view.height);
  const auto n = static_cast<float>(paths);
  const float share = n / (n + kNetworkPaths);
  std::vector<Rgb> out;
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      if (!view.mask[change.number(x, y)]) continue;
      out.push_back(
          max(network[out.size()] + share * mean_around(change, view.mask, x, y), Vec3{}));
    }
  }
  return out;
}

}  // namespace lte::infer
