#include "datagen/common/textures.h"

#include <cmath>
#include <vector>

namespace lte::datagen {

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
    s.x = rng->uniform();
    s.y = rng->uniform();
    s.rx = rng->uniform(0.05f, 0.3f);
    s.ry = rng->uniform(0.05f, 0.3f);
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
