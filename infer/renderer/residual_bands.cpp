#include "infer/renderer/residual_bands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "infer/picture/box_mean.h"
#include "lte/image/bilateral.h"

namespace lte::infer {
namespace {

using image::Image;

/// Bands beside the mean over what lies around: 5 passes reach 62 pixels to each side.
constexpr int kPasses = 5;
/// Half an edge of the square over which powers are estimated; at least twice the band's width.
constexpr int kWindow = 16;
/// The same of the narrow square in which what stands out is found; at least the band's width.
constexpr int kNear = 4;
/// Standard errors of a power's estimate that believe half of it. There are many narrow squares,
/// and chance stands out in some.
constexpr float kDoubt = 2, kNearDoubt = 12;
/// Of what lies around, the least that residuals are measured by.
constexpr float kLeastEnergy = 0.01f;
constexpr float kMostEnergy = 1e30f;  // sums of it stay finite
/// Pixels of a wide surface that smoothing has made one, in each band: the sum of the squared
/// autocorrelation of its noise.
constexpr std::array<float, kPasses + 1> kAlike = {1.1f, 5.1f, 23, 96, 388, 2270};

int window(int pass) { return std::max(kWindow, 2 << pass); }

/// Statistics of a band that are summed over a window.
struct Statistics {
  std::vector<float> power, square, noise;  ///< per pixel
};

Statistics statistics(const ResidualHalves& band, std::span<const float> scale) {
  const size_t pixels = band.a.pixels.size() / 3;
  Statistics out;
  out.power.resize(pixels);
  out.square.resize(pixels);
  out.noise.resize(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    const float weight = scale.empty() ? 1 : scale[i] * scale[i];
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) {
      const float a = band.a.pixels[k], b = band.b.pixels[k];
      out.power[i] += weight * a * b;
      out.noise[i] += weight * (a - b) * (a - b) / 4;  // of the mean of both
    }
    out.square[i] = std::min(out.power[i] * out.power[i], std::numeric_limits<float>::max());
  }
  return out;
}

/// The share of a band that is the answer's error, by the window around each pixel.
/// @param alike   pixels that count as one where means are taken
/// @param doubts  standard errors of a power that believe half of it
std::vector<float> shares(const Statistics& sums, const BoxMean& mean, int radius, float alike,
                          float doubts) {
  std::vector<float> counts;
  std::vector<float> power = mean(sums.power, radius, &counts);
  const std::vector<float> square = mean(sums.square, radius);
  const std::vector<float> noise = mean(sums.noise, radius);
  for (size_t i = 0; i < power.size(); ++i) {
    const float variance = std::max(0.0f, noise[i]);
    // Of pure noise the product has a standard deviation of twice the mean's variance, or more
    // where some pixels are noisier than others.
    const float spread =
        std::max(2 * variance, std::sqrt(std::max(0.0f, square[i] - power[i] * power[i])));
    const float error = spread / std::sqrt(std::max(1.0f, counts[i] / alike));
    const float doubt = power[i] > 0 ? doubts * error / power[i] : 0;
    const float sure = power[i] / (1 + doubt * doubt);
    power[i] = sure > 0 ? sure / (sure + variance) : 0;
  }
  return mean(power, radius / 2);  // what chance has let through here, it has not beside
}

/// What brings the residuals of all pixels to one size, that of what lies around: the few that are
/// wrong by far, or the noisiest, would rule a window in which they are, and grain be let in there.
std::vector<float> scale_of(const ResidualHalves& band, const BoxMean& mean, int near, int far) {
  std::vector<float> energy(band.a.pixels.size() / 3);
  for (size_t i = 0; i < energy.size(); ++i) {
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) {
      const float a = band.a.pixels[k], b = band.b.pixels[k];
      energy[i] += std::min((a * a + b * b) / 2, kMostEnergy);
    }
  }
  std::vector<float> scale = mean(energy, near);
  const std::vector<float> around = mean(scale, far);
  for (size_t i = 0; i < scale.size(); ++i) {
    const float own = scale[i] + kLeastEnergy * around[i];
    scale[i] = own > 0 ? 1 / std::sqrt(own) : 0;
  }
  return scale;
}

/// Shares by two windows: what stands out by far in a narrow one decides there alone, and does not
/// count in the wide one of those around.
std::vector<float> shares_of(const ResidualHalves& band, const BoxMean& mean, int pass) {
  const int far = window(pass), near = std::max(kNear, 1 << pass);
  const float alike = kAlike[static_cast<size_t>(pass)];
  Statistics sums = statistics(band, scale_of(band, mean, near, far));
  const std::vector<float> alone = shares(sums, mean, near, alike, kNearDoubt);
  for (size_t i = 0; i < alone.size(); ++i) {
    sums.power[i] *= 1 - alone[i];
    sums.square[i] *= 1 - alone[i];
    sums.noise[i] *= 1 - alone[i];
  }
  std::vector<float> out = shares(sums, mean, far, alike, kDoubt);
  for (size_t i = 0; i < out.size(); ++i) out[i] = alone[i] + (1 - alone[i]) * out[i];
  return out;
}

void add_share(const std::vector<float>& share, const ResidualHalves& band,
               std::span<const uint8_t> mask, Image* sum) {
  for (size_t i = 0; i < share.size(); ++i) {
    if (!mask[i]) continue;
    for (size_t k = 3 * i; k < 3 * i + 3; ++k)
      sum->pixels[k] += share[i] * (band.a.pixels[k] + band.b.pixels[k]) / 2;
  }
}

void subtract(const Image& other, Image* image) {
  for (size_t k = 0; k < image->pixels.size(); ++k) image->pixels[k] -= other.pixels[k];
}

}  // namespace

std::vector<Image> error_of(std::vector<ResidualHalves> residuals, const ResidualSurfaces& surfaces,
                            const std::function<void()>& check) {
  const Image& position = surfaces.position;
  Image normal = surfaces.normal;  // nothing from outside of the mask is to be mixed in
  for (size_t i = 0; i < surfaces.mask.size(); ++i) {
    if (!surfaces.mask[i]) normal.set_rgb(i, {0, 0, 0});
  }
  const BoxMean mean(position.width, position.height, surfaces.mask);
  std::vector<Image> out(residuals.size(), Image(position.width, position.height, 3));
  for (int pass = 0; pass <= kPasses; ++pass) {
    if (check) check();
    std::vector<ResidualHalves> coarse;
    if (pass < kPasses) {
      coarse = residuals;
      std::vector<Image*> pictures;
      for (ResidualHalves& halves : coarse) {
        pictures.push_back(&halves.a);
        pictures.push_back(&halves.b);
      }
      image::surface_means(normal, position, 1 << pass, pictures);
    }
    for (size_t r = 0; r < residuals.size(); ++r) {
      ResidualHalves& band = residuals[r];
      if (pass < kPasses) {
        subtract(coarse[r].a, &band.a);
        subtract(coarse[r].b, &band.b);
      }
      add_share(shares_of(band, mean, pass), band, surfaces.mask, &out[r]);
    }
    if (pass < kPasses) residuals = std::move(coarse);
  }
  return out;
}

Image error_of_pixels(const ResidualHalves& residual, std::span<const uint8_t> mask,
                      std::span<const float> scale) {
  const BoxMean mean(residual.a.width, residual.a.height, mask);
  Image out(residual.a.width, residual.a.height, 3);
  add_share(shares(statistics(residual, scale), mean, kWindow, 1, kDoubt), residual, mask, &out);
  return out;
}

}  // namespace lte::infer
