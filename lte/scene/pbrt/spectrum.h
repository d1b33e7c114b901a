// Conversion of spectra to linear Rec.709.
//
// Color matching functions are the multi-lobe fits of Wyman, Sloan and Shirley, "Simple Analytic
// Approximations to the CIE XYZ Color Matching Functions", JCGT 2(2), 2013. Results are divided by
// those of CIE D65, so that D65 is exactly white whatever the error of the fits.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "lte/base/math.h"

namespace lte::scene::pbrt {

struct SpectrumSample {
  double wavelength = 0;  ///< nm
  double value = 0;
};

/// A spectrum is linear between its samples and 0 outside them. Wavelengths ascend.
using Spectrum = std::vector<SpectrumSample>;

/// Color of a reflectance spectrum under D65: a constant 1 gives (1, 1, 1). Components outside the
/// gamut are clamped at 0.
Rgb reflectance_to_rgb(const Spectrum& reflectance);

/// Color of emitted light, scaled to luminance 1 and clamped at 0; black for a spectrum without
/// visible light.
Rgb illuminant_to_rgb(const Spectrum& radiance);

/// Color of a black body, by Planck's law, likewise.
/// @param kelvin  positive
Rgb blackbody_to_rgb(double kelvin);

/// Color of light of a CIE 1931 chromaticity, at luminance 1 and clamped at 0.
Rgb chromaticity_to_rgb(double x, double y);

/// Color of a conductor at normal incidence: the Fresnel reflectance for n = eta and k goes through
/// reflectance_to_rgb(). Outside their samples eta and k keep the last value.
Rgb conductor_to_rgb(const Spectrum& eta, const Spectrum& k);

/// Fresnel reflectance at normal incidence for one wavelength.
double conductor_reflectance(double eta, double k);

/// Color, at luminance 1, of pbrt's "stdillum-A", "stdillum-D50", "-D65", "-F1" to "-F12" and
/// "illum-acesD60".
std::optional<Rgb> named_illuminant(std::string_view name);

/// Normal-incidence reflectance of the substances of pbrt's "metal-Cu-eta" and "metal-Cu-k"; the
/// name is what stands between the two hyphens, e.g. "Cu".
std::optional<Rgb> named_conductor(std::string_view substance);

}  // namespace lte::scene::pbrt
