// The standard skies of the Commission Internationale de l'Éclairage: how bright a sky is by
// direction, from overcast to clear.
#pragma once

#include <array>
#include <memory>

#include "lte/base/math.h"
#include "lte/scene/environment.h"

namespace lte::datagen {

/// Gradation from the zenith to the horizon (a, b) and glow around the sun (c, d, e).
struct CieSky {
  double a, b, c, d, e;
};

/// CIE S 011/ISO 15469:2004, Spatial distribution of daylight: five overcast and cloudy skies, the
/// fifth and sixth alike from zenith to horizon, then partly cloudy to clear ones.
inline constexpr std::array<CieSky, 15> kCieSkies{{
    {4.0, -0.70, 0, -1.0, 0},
    {4.0, -0.70, 2, -1.5, 0.15},
    {1.1, -0.80, 0, -1.0, 0},
    {1.1, -0.80, 2, -1.5, 0.15},
    {0.0, -1.00, 0, -1.0, 0},
    {0.0, -1.00, 2, -1.5, 0.15},
    {0.0, -1.00, 5, -2.5, 0.30},
    {0.0, -1.00, 10, -3.0, 0.45},
    {-1.0, -0.55, 2, -1.5, 0.15},
    {-1.0, -0.55, 5, -2.5, 0.30},
    {-1.0, -0.55, 10, -3.0, 0.45},
    {-1.0, -0.32, 10, -3.0, 0.45},
    {-1.0, -0.32, 16, -3.0, 0.30},
    {-1.0, -0.15, 16, -3.0, 0.30},
    {-1.0, -0.15, 24, -2.8, 0.15},
}};

/// Luminance of the sky at `direction`, over that of the zenith.
/// @param direction  unit, Y up, not below the horizon
/// @param sun        likewise, towards the sun
double relative_luminance(const CieSky& sky, const Vec3& direction, const Vec3& sun);

/// A picture of a sky over an even ground. A roof gets the irradiance that it would get from a
/// radiance of 1 all around.
/// @param sun      unit, towards the sun, above the horizon
/// @param zenith   color of the sky overhead; `horizon` that far down
/// @param ground   radiance below the horizon
std::shared_ptr<const scene::EnvironmentMap> sky_picture(const CieSky& sky, const Vec3& sun,
                                                         const Rgb& zenith, const Rgb& horizon,
                                                         const Rgb& ground);

}  // namespace lte::datagen
