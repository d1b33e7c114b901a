// Tools to draw procedural textures: periodic noise and the rasterizer.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "lte/base/math.h"
#include "lte/base/random.h"
#include "lte/scene/texture.h"

namespace lte::datagen {

using TexturePtr = std::shared_ptr<const scene::Texture>;

/// Linear albedos that a texel may have.
struct AlbedoRange {
  float low = 0.01f, high = 0.95f;
};

Rgb clamp_albedo(const Rgb& color, const AlbedoRange& range = {});

inline Rgb mix(const Rgb& a, const Rgb& b, float t) { return a * (1 - t) + b * t; }

inline float fraction(float x) { return x - std::floor(x); }

/// Makes a texture. The texel whose centre is (u, v) in [0, 1)² is `color(u, v)`, a linear albedo.
TexturePtr rasterize(int size, const std::function<Rgb(float, float)>& color,
                     const AlbedoRange& range = {});

/// Periodic value noise in [-1, 1]: `cells` lattice cells across, smoothly interpolated, `octaves`
/// summed.
class Noise {
 public:
  Noise(int cells_u, int cells_v, int octaves, Rng* rng);

  /// @param u, v  not negative
  float operator()(float u, float v) const;

 private:
  struct Lattice {
    int width, height;
    std::vector<float> values;

    float value(int x, int y) const;
    float at(float u, float v) const;
  };
  std::vector<Lattice> lattices_;
};

}  // namespace lte::datagen
