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
/// Standard errors of a power's estimate that believe half of it.
constexpr float kDoubt = 2;
/// Pixels of a wide surface that smoothing has made one, in each band: the sum of the squared
/// autocorrelation of its noise.
constexpr std::array<float, kPasses + 1> kAlike = {1.1f, 5.1f, 23, 96, 388, 2270};

int window(int pass) { return std::max(kWindow, 2 << pass); }

/// The share of a band that is the answer's error, per pixel.
/// @param alike  pixels that count as one where means are taken
std::vector<float> shares(const ResidualHalves& band, const BoxMean& mean, int radius, float alike,
                          std::span<const float> scale) {
  const size_t pixels = band.a.pixels.size() / 3;
  std::vector<float> power(pixels), square(pixels), noise(pixels), counts;
  for (size_t i = 0; i < pixels; ++i) {
    const float weight = scale.empty() ? 1 : scale[i] * scale[i];
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) {
      const float a = band.a.pixels[k], b = band.b.pixels[k];
      power[i] += weight * a * b;
      noise[i] += weight * (a - b) * (a - b) / 4;  // of the mean of both
    }
    square[i] = std::min(power[i] * power[i], std::numeric_limits<float>::max());
  }
  power = mean(power, radius, &counts);
  square = mean(square, radius);
  noise = mean(noise, radius);
  for (size_t i = 0; i < pixels; ++i) {
    const float variance = std::max(0.0f, noise[i]);
    // Of pure noise the product has a standard deviation of twice the mean's variance, or more
    // where some pixels are noisier than others.
    const float spread =
        std::max(2 * variance, std::sqrt(std::max(0.0f, square[i] - power[i] * power[i])));
    const float error = spread / std::sqrt(std::max(1.0f, counts[i] / alike));
    const float doubt = power[i] > 0 ? kDoubt * error / power[i] : 0;
    const float sure = power[i] / (1 + doubt * doubt);
    power[i] = sure > 0 ? sure / (sure + variance) : 0;
  }
  return mean(power, radius / 2);  // what chance has let through here, it has not beside
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
      add_share(shares(band, mean, window(pass), kAlike[static_cast<size_t>(pass)], {}), band,
                surfaces.mask, &out[r]);
    }
    if (pass < kPasses) residuals = std::move(coarse);
  }
  return out;
}

Image error_of_pixels(const ResidualHalves& residual, std::span<const uint8_t> mask,
                      std::span<const float> scale) {
  const BoxMean mean(residual.a.width, residual.a.height, mask);
  Image out(residual.a.width, residual.a.height, 3);
  add_share(shares(residual, mean, kWindow, 1, scale), residual, mask, &out);
  return out;
}

}  // namespace lte::infer
