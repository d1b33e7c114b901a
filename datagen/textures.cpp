#include "datagen/textures.h"

#include <cmath>
#include <functional>
#include <vector>

namespace lte::datagen {
namespace {

Rgb clamp_albedo(const Rgb& c) {
  return max(Rgb{0.01f, 0.01f, 0.01f}, min(c, Rgb{0.95f, 0.95f, 0.95f}));
}

Rgb mix(const Rgb& a, const Rgb& b, float t) { return a * (1 - t) + b * t; }

uint8_t to_srgb(float linear) {
  const float coded =
      linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
  return static_cast<uint8_t>(std::lround(std::clamp(coded, 0.0f, 1.0f) * 255));
}

/// The texture whose texel at (u, v) in [0, 1)², its centre, is `color(u, v)`.
TexturePtr rasterize(int size, const std::function<Rgb(float, float)>& color) {
  std::vector<uint8_t> texels;
  texels.reserve(static_cast<size_t>(size) * static_cast<size_t>(size) * 3);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(size);
      const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(size);
      const Rgb c = clamp_albedo(color(u, v));
      for (int channel = 0; channel < 3; ++channel) texels.push_back(to_srgb(c[channel]));
    }
  }
  return std::make_shared<scene::Texture>(size, size, std::move(texels), true);
}

/// Periodic value noise in [-1, 1]: `cells` lattice cells across, smoothly interpolated, `octaves`
/// summed.
class Noise {
 public:
  Noise(int cells_u, int cells_v, int octaves, Rng* rng) {
    for (int octave = 0; octave < octaves; ++octave) {
      Lattice lattice{cells_u << octave, cells_v << octave, {}};
      lattice.values.resize(static_cast<size_t>(lattice.width) *
                            static_cast<size_t>(lattice.height));
      for (float& value : lattice.values) value = rng->uniform(-1, 1);
      lattices_.push_back(std::move(lattice));
    }
  }

  float operator()(float u, float v) const {
    float sum = 0, weight = 1, total = 0;
    for (const Lattice& lattice : lattices_) {
      sum += weight * lattice.at(u, v);
      total += weight;
      weight *= 0.5f;
    }
    return sum / total;
  }

 private:
  struct Lattice {
    int width, height;
    std::vector<float> values;

    float value(int x, int y) const {
      return values[static_cast<size_t>(y % height) * static_cast<size_t>(width) +
                    static_cast<size_t>(x % width)];
    }
    float at(float u, float v) const {
      const float x = u * static_cast<float>(width), y = v * static_cast<float>(height);
      const int ix = static_cast<int>(x), iy = static_cast<int>(y);
      const auto smooth = [](float t) { return t * t * (3 - 2 * t); };
      const float fx = smooth(x - static_cast<float>(ix)), fy = smooth(y - static_cast<float>(iy));
      const float top = value(ix, iy) * (1 - fx) + value(ix + 1, iy) * fx;
      const float bottom = value(ix, iy + 1) * (1 - fx) + value(ix + 1, iy + 1) * fx;
      return top * (1 - fy) + bottom * fy;
    }
  };
  std::vector<Lattice> lattices_;
};

}  // namespace

TexturePtr make_planks(int size, const Rgb& wood, int planks, Rng* rng) {
  std::vector<float> tone(static_cast<size_t>(planks)), shift(static_cast<size_t>(planks));
  for (float& t : tone) t = rng->uniform(0.7f, 1.3f);
  for (float& s : shift) s = rng->uniform();
  const Noise grain(2, 8 * planks, 3, rng);
  return rasterize(size, [&](float u, float v) {
    const float row = v * static_cast<float>(planks);
    const auto plank = static_cast<size_t>(row);
    const float across = row - static_cast<float>(plank);
    const float along = std::fmod(u + shift[plank], 1.0f);
    if (across < 0.03f || along < 0.004f) return wood * 0.35f;  // the joint
    return wood * (tone[plank] * (1 + 0.25f * grain(along, v)));
  });
}

TexturePtr make_tiles(int size, const Rgb& tile, const Rgb& grout, int tiles, Rng* rng) {
  std::vector<float> tone(static_cast<size_t>(tiles) * static_cast<size_t>(tiles));
  for (float& t : tone) t = rng->uniform(0.85f, 1.15f);
  return rasterize(size, [&](float u, float v) {
    const float x = u * static_cast<float>(tiles), y = v * static_cast<float>(tiles);
    const auto ix = static_cast<size_t>(x), iy = static_cast<size_t>(y);
    const bool joint = x - static_cast<float>(ix) < 0.05f || y - static_cast<float>(iy) < 0.05f;
    return joint ? grout : tile * tone[iy * static_cast<size_t>(tiles) + ix];
  });
}

TexturePtr make_checker(int size, const Rgb& first, const Rgb& second, int cells) {
  return rasterize(size, [&](float u, float v) {
    const int x = static_cast<int>(u * static_cast<float>(cells));
    const int y = static_cast<int>(v * static_cast<float>(cells));
    return (x + y) % 2 ? second : first;
  });
}

TexturePtr make_noise(int size, const Rgb& base, float contrast, int cells, Rng* rng) {
  const Noise noise(cells, cells, 3, rng);
  return rasterize(size, [&](float u, float v) { return base * (1 + contrast * noise(u, v)); });
}

TexturePtr make_stripes(int size, const Rgb& first, const Rgb& second, int stripes) {
  return rasterize(size, [&](float u, float) {
    return static_cast<int>(u * static_cast<float>(2 * stripes)) % 2 ? second : first;
  });
}

TexturePtr make_picture(int size, Rng* rng) {
  struct Shape {
    float x, y, rx, ry;
    bool disc;
    Rgb color;
  };
  const auto color = [rng] {
    const float hue = rng->uniform(), saturation = rng->uniform(0, 0.9f);
    return make_color(hue, saturation, rng->uniform(0.03f, 0.7f));
  };
  std::vector<Shape> shapes(4 + rng->below(8));
  for (Shape& s : shapes) {
    s.x = rng->uniform(), s.y = rng->uniform();
    s.rx = rng->uniform(0.05f, 0.3f), s.ry = rng->uniform(0.05f, 0.3f);
    s.disc = rng->below(2) == 0;
    s.color = color();
  }
  const Rgb top = color(), bottom = color();
  return rasterize(size, [&](float u, float v) {
    Rgb c = mix(top, bottom, v);
    for (const Shape& s : shapes) {
      const float x = (u - s.x) / s.rx, y = (v - s.y) / s.ry;
      if (s.disc ? x * x + y * y < 1 : std::abs(x) < 1 && std::abs(y) < 1) c = s.color;
    }
    return c;
  });
}

Rgb make_color(float hue, float saturation, float target) {
  const auto channel = [&](float offset) {
    const float t = std::fmod(hue + offset, 1.0f) * 6;
    const float pure = std::clamp(std::abs(t - 3) - 1, 0.0f, 1.0f);
    return 1 - saturation * (1 - pure);
  };
  const Rgb color{channel(0), channel(2.0f / 3), channel(1.0f / 3)};
  return clamp_albedo(color * (target / luminance(color)));
}

}  // namespace lte::datagen
