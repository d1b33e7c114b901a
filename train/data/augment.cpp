#include "train/data/augment.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace lte::train {
namespace {

/// exp(uniform(−log most, log most)), which is above 1 as often as below.
float log_uniform(double most, Rng* rng) {
  return static_cast<float>(std::exp(std::log(most) * (2.0 * rng->uniform() - 1.0)));
}

using Rotation3 = std::array<Vec3, 3>;  // rows

/// Whether the axis-aligned box of `bounds` is at most `largest` wide after the turn.
bool fits(const Symmetry& symmetry, const Bounds& bounds, double largest) {
  Bounds turned;
  for (int corner = 0; corner < 8; ++corner) {
    turned.extend(symmetry.space({(corner & 1) != 0 ? bounds.high.x : bounds.low.x,
                                  (corner & 2) != 0 ? bounds.high.y : bounds.low.y,
                                  (corner & 4) != 0 ? bounds.high.z : bounds.low.z}));
  }
  return max_component(turned.extent()) <= largest;
}

Rotation3 about_vertical(float cosine, float sine) {
  return {{{cosine, 0, sine}, {0, 1, 0}, {-sine, 0, cosine}}};
}

/// By any angle if the scene fits afterwards, else by the nearest quarter turn.
void turn_about_vertical(Symmetry* symmetry, const Bounds& bounds, double largest, Rng* rng) {
  const double turns = rng->uniform();
  const double angle = 2 * std::numbers::pi * turns;
  symmetry->rotation =
      about_vertical(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
  if (bounds.empty() || fits(*symmetry, bounds, largest)) return;
  constexpr std::array<float, 4> kCosine = {1, 0, -1, 0};
  const auto quarter = static_cast<size_t>(std::lround(4 * turns)) % 4;
  symmetry->rotation = about_vertical(kCosine[quarter], kCosine[(quarter + 3) % 4]);
}

/// Every orientation is as likely as any other (Shoemake 1992, Uniform random rotations).
Rotation3 uniform_rotation(Rng* rng) {
  const double u = rng->uniform(), v = 2 * std::numbers::pi * rng->uniform(),
               t = 2 * std::numbers::pi * rng->uniform();
  const double x = std::sqrt(1 - u) * std::sin(v), y = std::sqrt(1 - u) * std::cos(v),
               z = std::sqrt(u) * std::sin(t), w = std::sqrt(u) * std::cos(t);
  const auto row = [](double a, double b, double c) {
    return Vec3{static_cast<float>(a), static_cast<float>(b), static_cast<float>(c)};
  };
  return {row(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
          row(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
          row(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y))};
}

/// The one of the cube's 24 rotations that is at the smallest angle from `rotation`: its product
/// with the inverse of `rotation` has the largest trace.
Rotation3 nearest_of_the_cube(const Rotation3& rotation) {
  Rotation3 nearest{};
  float most = -INFINITY;
  for (int x = 0; x < 3; ++x) {
    for (int step = 1; step <= 2; ++step) {
      const int y = (x + step) % 3;
      for (int signs = 0; signs < 4; ++signs) {
        Rotation3 candidate{};
        candidate[0][x] = (signs & 1) != 0 ? -1.0f : 1.0f;
        candidate[1][y] = (signs & 2) != 0 ? -1.0f : 1.0f;
        candidate[2] = cross(candidate[0], candidate[1]);  // never a mirror
        float trace = 0;
        for (size_t row = 0; row < 3; ++row) trace += dot(candidate[row], rotation[row]);
        if (trace <= most) continue;
        most = trace;
        nearest = candidate;
      }
    }
  }
  return nearest;
}

void turn_about_any_axis(Symmetry* symmetry, const Bounds& bounds, double largest, Rng* rng) {
  symmetry->rotation = uniform_rotation(rng);
  if (bounds.empty() || fits(*symmetry, bounds, largest)) return;
  symmetry->rotation = nearest_of_the_cube(symmetry->rotation);
}

}  // namespace

Symmetry identity_symmetry(int64_t light_groups) {
  Symmetry symmetry;
  symmetry.gains.assign(static_cast<size_t>(light_groups), Rgb{1, 1, 1});
  return symmetry;
}

Symmetry draw_symmetry(const AugmentConfig& config, int64_t light_groups, const Bounds& bounds,
                       double largest_extent, Rng* rng) {
  Symmetry symmetry = identity_symmetry(light_groups);
  if (config.rotate == Rotation::Vertical)
    turn_about_vertical(&symmetry, bounds, largest_extent, rng);
  if (config.rotate == Rotation::Any) turn_about_any_axis(&symmetry, bounds, largest_extent, rng);
  if (config.mirror) symmetry.mirror = rng->below(2) == 1;
  if (config.permute_colors) {
    for (size_t i = 2; i > 0; --i)
      std::swap(symmetry.channels[i], symmetry.channels[rng->below(i + 1)]);
  }
  for (Rgb& gain : symmetry.gains) {
    if (config.gain > 1) gain *= log_uniform(config.gain, rng);
    if (config.tint > 1) {
      for (int channel = 0; channel < 3; ++channel) gain[channel] *= log_uniform(config.tint, rng);
    }
  }
  if (config.single_light > 0 && light_groups > 1 && rng->uniform() < config.single_light) {
    const auto lit = static_cast<size_t>(rng->below(static_cast<uint64_t>(light_groups)));
    for (size_t group = 0; group < symmetry.gains.size(); ++group) {
      if (group != lit) symmetry.gains[group] = Rgb{};
    }
  }
  return symmetry;
}

}  // namespace lte::train
