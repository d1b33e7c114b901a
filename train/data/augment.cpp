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
  return symmetry;
}

}  // namespace lte::train
