#include "lte/image/tone_curve.h"

namespace lte::image {
namespace {

float hable(float x) {
  constexpr float a = 0.15f, b = 0.50f, c = 0.10f, d = 0.20f, e = 0.02f, f = 0.30f;
  return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f;
}

}  // namespace

Rgb tone_map(ToneCurve curve, const Rgb& exposed) {
  constexpr float kBright = 1e6f;  // white by any curve, and far from where products overflow
  const Rgb light = min(max(exposed, {0, 0, 0}), {kBright, kBright, kBright});
  switch (curve) {
    case ToneCurve::Reinhard:
      return min(light * (1 / (1 + luminance(light))), {1, 1, 1});
    case ToneCurve::Filmic: {
      constexpr float kBefore = 2;  // middle gray stays about where the other curves have it
      const float white = 1 / hable(4 * kBefore);
      return min(
          Rgb{hable(kBefore * light.x), hable(kBefore * light.y), hable(kBefore * light.z)} * white,
          {1, 1, 1});
    }
    default:
      return min(light, {1, 1, 1});
  }
}

}  // namespace lte::image
