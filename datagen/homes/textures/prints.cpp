// Paintings and book spines.
#include <cmath>

#include "datagen/common/textures.h"
#include "datagen/homes/textures/textures.h"

namespace lte::datagen::homes {
namespace {

Rgb any_color(Rng* rng, float saturation, float low, float high) {
  const float hue = rng->uniform(), s = rng->uniform(0.2f * saturation, saturation);
  return make_color(hue, s, rng->uniform(low, high));
}

/// Hills in layers under a sky, each paler the farther away it is.
std::function<Rgb(float, float)> landscape(Rng* rng) {
  const float dawn = rng->uniform(0.0f, 0.12f), sky_hue = rng->uniform(0.52f, 0.64f);
  const Rgb zenith = make_color(sky_hue, 0.7f, rng->uniform(0.2f, 0.5f)),
            horizon = make_color(dawn, 0.4f, 0.65f),
            near = make_color(rng->uniform(0.2f, 0.45f), 0.7f, 0.07f);
  const int layers = 3 + static_cast<int>(rng->below(3));
  std::vector<Noise> ridges;
  for (int i = 0; i < layers; ++i) ridges.emplace_back(3 + i, 1, 5, rng);
  const Noise clouds(3, 6, 5, rng), strokes(30, 90, 2, rng);
  const float sun_x = rng->uniform(0.2f, 0.8f), sun_y = rng->uniform(0.15f, 0.4f);
  return [=](float u, float v) {
    Rgb c = mix(zenith, horizon, std::min(1.0f, v / 0.6f));
    c = mix(c, Rgb{0.75f, 0.74f, 0.72f}, std::clamp(1.5f * clouds(u, v) - 0.1f, 0.0f, 0.8f));
    if (std::hypot(u - sun_x, v - sun_y) < 0.06f) c = {0.8f, 0.6f, 0.25f};
    for (int i = 0; i < layers; ++i) {
      const float t = static_cast<float>(i + 1) / static_cast<float>(layers);
      if (v > 0.35f + 0.5f * t + 0.22f * ridges[static_cast<size_t>(i)](u, 0.3f) - 0.1f)
        c = mix(horizon * 0.7f, near, t);
    }
    return c * (1 + 0.15f * strokes(u, v));
  };
}

/// Blocks of color between dark lines, or soft fields.
std::function<Rgb(float, float)> abstract(Rng* rng) {
  struct Disc {
    float x, y, rx, ry;
    Rgb color;
  };
  std::vector<Disc> discs(5 + rng->below(7));
  for (Disc& d : discs) {
    d.x = rng->uniform();
    d.y = rng->uniform();
    d.rx = rng->uniform(0.06f, 0.3f);
    d.ry = rng->uniform(0.06f, 0.3f);
    d.color = any_color(rng, 0.9f, 0.05f, 0.6f);
  }
  const Rgb ground = any_color(rng, 0.3f, 0.35f, 0.75f);
  const bool blocks = rng->below(2) == 0;
  const Noise strokes(20, 20, 4, rng);
  return [=](float u, float v) {
    Rgb c = ground;
    const float x = u + 0.02f * strokes(u, v), y = v + 0.02f * strokes(v, u);
    for (const Disc& d : discs) {
      const float dx = (x - d.x) / d.rx, dy = (y - d.y) / d.ry;
      if (blocks ? std::abs(dx) < 1 && std::abs(dy) < 1 : dx * dx + dy * dy < 1) c = d.color;
    }
    return c * (1 + 0.12f * strokes(u, v));
  };
}

/// A branch with leaves on pale paper.
std::function<Rgb(float, float)> botanical(Rng* rng) {
  const Rgb paper{0.7f, 0.66f, 0.58f};
  const Rgb leaf = make_color(rng->uniform(0.22f, 0.4f), 0.7f, rng->uniform(0.06f, 0.2f));
  const float lean = rng->uniform(-0.15f, 0.15f);
  const int pairs = 5 + static_cast<int>(rng->below(4));
  const Noise wash(12, 12, 3, rng);
  return [=](float u, float v) {
    const float stem = 0.5f + lean * std::sin(2.5f * (v - 0.5f));
    Rgb c = paper * (1 + 0.05f * wash(u, v));
    if (v < 0.12f || v > 0.92f) return c;
    if (std::abs(u - stem) < 0.006f) return leaf * 0.7f;
    for (int i = 0; i < pairs; ++i) {
      const float t = (static_cast<float>(i) + 0.5f) / static_cast<float>(pairs);
      const float y = 0.16f + 0.7f * t,
                  reach = 0.12f + 0.16f * std::sin(kPi * std::min(1.0f, t + 0.2f));
      const float side = u > stem ? 1.0f : -1.0f;
      const float along = side * (u - stem) / reach, up = v - y + 0.35f * side * (u - stem);
      if (along > 0 && along < 1 && std::abs(up) < 0.035f * std::sin(kPi * std::pow(along, 0.7f)))
        return leaf * (1 + 0.4f * wash(u, v)) * (std::abs(up) < 0.003f ? 1.5f : 1.0f);
    }
    return c;
  };
}

}  // namespace

TexturePtr painting(int size, Rng* rng) {
  const uint64_t kind = rng->below(3);
  const auto picture = kind == 0 ? landscape(rng) : kind == 1 ? abstract(rng) : botanical(rng);
  const float mat = rng->below(2) == 0 ? rng->uniform(0.06f, 0.14f) : 0.0f;
  const float shade = rng->uniform(0.65f, 0.8f);
  return rasterize(
      size,
      [&](float u, float v) {
        const float edge = std::min(std::min(u, 1 - u), std::min(v, 1 - v));
        if (edge < mat) return Rgb{1, 0.99f, 0.96f} * (edge > mat - 0.006f ? 0.4f : shade);
        const float span = 1 - 2 * mat;
        return picture((u - mat) / span, (v - mat) / span);
      },
      kAlbedo);
}

TexturePtr book_spines(int size, int count, Rng* rng) {
  struct Spine {
    Rgb cover, ink;
    float top, bottom, title_low, title_high;
  };
  std::vector<Spine> spines(static_cast<size_t>(count));
  for (Spine& s : spines) {
    s.cover = any_color(rng, 0.65f, 0.04f, 0.5f);
    s.ink = luminance(s.cover) > 0.25f ? Rgb{0.05f, 0.04f, 0.04f} : Rgb{0.7f, 0.6f, 0.35f};
    s.top = rng->uniform(0.04f, 0.12f);
    s.bottom = rng->uniform(0.86f, 0.96f);
    s.title_low = rng->uniform(0.2f, 0.35f);
    s.title_high = rng->uniform(0.5f, 0.75f);
  }
  const Noise cloth(200, 200, 1, rng), letters(64, 40, 1, rng);
  return rasterize(
      size,
      [&](float u, float v) {
        const float x = u * static_cast<float>(count);
        const auto i = std::min(static_cast<size_t>(x), spines.size() - 1);
        const float across = x - static_cast<float>(i);
        const Spine& s = spines[i];
        const bool band = std::abs(v - s.top) < 0.008f || std::abs(v - s.bottom) < 0.008f;
        const bool title = across > 0.35f && across < 0.65f && v > s.title_low &&
                           v < s.title_high && letters(u, v) > 0.1f;
        return (band || title ? s.ink : s.cover) * (1 + 0.1f * cloth(u, v));
      },
      kAlbedo);
}

}  // namespace lte::datagen::homes
