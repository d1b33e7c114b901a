#include "datagen/common/raster.h"

#include <cmath>

#include "lte/base/interruption.h"

namespace lte::datagen {
namespace {

uint8_t to_srgb(float linear) {
  const float coded =
      linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
  return static_cast<uint8_t>(std::lround(std::clamp(coded, 0.0f, 1.0f) * 255));
}

}  // namespace

Rgb clamp_albedo(const Rgb& color, const AlbedoRange& range) {
  return max(Rgb{range.low, range.low, range.low},
             min(color, Rgb{range.high, range.high, range.high}));
}

TexturePtr rasterize(int size, const std::function<Rgb(float, float)>& color,
                     const AlbedoRange& range) {
  std::vector<uint8_t> texels;
  texels.reserve(static_cast<size_t>(size) * static_cast<size_t>(size) * 3);
  for (int y = 0; y < size; ++y) {
    Interruption::check();
    for (int x = 0; x < size; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(size);
      const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(size);
      const Rgb c = clamp_albedo(color(u, v), range);
      for (int channel = 0; channel < 3; ++channel) texels.push_back(to_srgb(c[channel]));
    }
  }
  return std::make_shared<scene::Texture>(size, size, std::move(texels), true);
}

Noise::Noise(int cells_u, int cells_v, int octaves, Rng* rng) {
  for (int octave = 0; octave < octaves; ++octave) {
    Lattice lattice{cells_u << octave, cells_v << octave, {}};
    lattice.values.resize(static_cast<size_t>(lattice.width) * static_cast<size_t>(lattice.height));
    for (float& value : lattice.values) value = rng->uniform(-1, 1);
    lattices_.push_back(std::move(lattice));
  }
}

float Noise::operator()(float u, float v) const {
  float sum = 0, weight = 1, total = 0;
  for (const Lattice& lattice : lattices_) {
    sum += weight * lattice.at(u, v);
    total += weight;
    weight *= 0.5f;
  }
  return sum / total;
}

float Noise::Lattice::value(int x, int y) const {
  return values[static_cast<size_t>(y % height) * static_cast<size_t>(width) +
                static_cast<size_t>(x % width)];
}

float Noise::Lattice::at(float u, float v) const {
  const float x = u * static_cast<float>(width), y = v * static_cast<float>(height);
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  const auto smooth = [](float t) { return t * t * (3 - 2 * t); };
  const float fx = smooth(x - static_cast<float>(ix)), fy = smooth(y - static_cast<float>(iy));
  const float top = value(ix, iy) * (1 - fx) + value(ix + 1, iy) * fx;
  const float bottom = value(ix, iy + 1) * (1 - fx) + value(ix + 1, iy + 1) * fx;
  return top * (1 - fy) + bottom * fy;
}

}  // namespace lte::datagen
