#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lte/image/flip.h"

namespace lte::image {
namespace {

/// Y of linear Rec.709 in the digits of FLIP's authors.
constexpr std::array<double, 3> kLuminance{2613072.0 / 12288897, 8788810.0 / 12288897,
                                           887015.0 / 12288897};
/// Narkowicz's rational fit of the ACES curve with 0.6 of the light:
/// (k0 x² + k1 x) / (k2 x² + k3 x + k4).
constexpr std::array<double, 5> kAces{0.36 * 2.51, 0.6 * 0.03, 0.36 * 2.43, 0.6 * 0.59, 0.14};

double aces(double x) {
  return (kAces[0] * x * x + kAces[1] * x) / (kAces[2] * x * x + kAces[3] * x + kAces[4]);
}

Image exposed(const Image& linear, double stops) {
  Image out = linear;
  const double factor = std::exp2(stops);
  for (float& value : out.pixels) {
    value = value > 0 ? static_cast<float>(std::min(aces(factor * value), 1.0)) : 0.0f;
  }
  return out;
}

}  // namespace

FlipExposures flip_exposures(const Image& reference, std::span<const uint8_t> mask) {
  LTE_CHECK(reference.channels == 3, "HDR-FLIP: expected 3 channels, got ", reference.channels);
  std::vector<double> values;
  for (size_t i = 0; i < reference.pixels.size() / 3; ++i) {
    if (!mask.empty() && mask[i] == 0) continue;
    const Rgb p = reference.rgb(i);
    values.push_back(kLuminance[0] * p.x + kLuminance[1] * p.y + kLuminance[2] * p.z);
  }
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  constexpr double kMin = 1e-37;        // of a black picture, so that logarithms stay finite
  constexpr double kDarkest = 0x1p-24;  // of the brightest: a picture that is black by half
  const double median = values[values.size() / 2];  // the upper of two, as the authors take it
  const double brightest = std::max(values.back(), kMin);
  // The exposures are those at which the curve reaches 0.85.
  constexpr double kTarget = 0.85;
  const double qa = kAces[0] - kTarget * kAces[2], qb = kAces[1] - kTarget * kAces[3],
               qc = -kTarget * kAces[4];
  const double place = -qb / (2 * qa) + std::sqrt(qb * qb / (4 * qa * qa) - qc / qa);
  FlipExposures out;
  out.start = std::log2(place / brightest);
  out.stop = std::log2(place / std::max(median, kDarkest * brightest));
  out.count = std::max(2, static_cast<int>(std::ceil(out.stop - out.start)));
  return out;
}

Image hdr_flip(const Image& a, const Image& reference, const FlipExposures& exposures,
               double pixels_per_degree) {
  LTE_CHECK(exposures.count >= 1, "HDR-FLIP: expected one exposure or more, got ", exposures.count);
  Image out(a.width, a.height, 1);
  for (int i = 0; i < exposures.count; ++i) {
    const double share = exposures.count > 1 ? static_cast<double>(i) / (exposures.count - 1) : 0;
    const double stops = exposures.start + share * (exposures.stop - exposures.start);
    const Image error = flip(exposed(a, stops), exposed(reference, stops), pixels_per_degree);
    for (size_t k = 0; k < out.pixels.size(); ++k)
      out.pixels[k] = std::max(out.pixels[k], error.pixels[k]);
  }
  return out;
}

}  // namespace lte::image
