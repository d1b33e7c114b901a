#include "lte/scene/pbrt/spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lte::scene::pbrt {
namespace {

constexpr int kFirst = 380, kLast = 780;  // nm; integrals go in steps of 1 nm

/// CIE standard illuminant D65, every 10 nm from 380 nm (CIE 15).
constexpr std::array<double, 41> kD65 = {
    49.9755, 54.6482, 82.7549, 91.486,  93.4318, 86.6823, 104.865, 117.008, 117.812,
    114.861, 115.923, 108.811, 109.354, 107.802, 104.790, 107.689, 104.405, 104.046,
    100.0,   96.3342, 95.788,  88.6856, 90.0062, 89.5991, 87.6987, 83.2886, 83.6992,
    80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349,  61.604,  69.8856,
    75.087,  63.5927, 46.4182, 66.8054, 63.3828};

struct Color {
  double r = 0, g = 0, b = 0;
};

double d65(double wavelength) {
  const double place = (wavelength - kFirst) / 10;
  const auto index = std::min(static_cast<size_t>(place), kD65.size() - 2);
  const double t = place - static_cast<double>(index);
  return kD65[index] * (1 - t) + kD65[index + 1] * t;
}

double lobe(double wavelength, double mean, double below, double above) {
  const double t = (wavelength - mean) / (wavelength < mean ? below : above);
  return std::exp(-0.5 * t * t);
}

/// XYZ (D65 white) to linear Rec.709, IEC 61966-2-1.
Color to_rec709(double x, double y, double z) {
  return {3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
          -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
          0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
}

template <typename Radiance>
Color integrate(const Radiance& radiance) {
  double x = 0, y = 0, z = 0;
  for (int wavelength = kFirst; wavelength <= kLast; ++wavelength) {
    const double l = wavelength, value = radiance(l);
    x += value * (1.056 * lobe(l, 599.8, 37.9, 31.0) + 0.362 * lobe(l, 442.0, 16.0, 26.7) -
                  0.065 * lobe(l, 501.1, 20.4, 26.2));
    y += value * (0.821 * lobe(l, 568.8, 46.9, 40.5) + 0.286 * lobe(l, 530.9, 16.3, 31.1));
    z += value * (1.217 * lobe(l, 437.0, 11.8, 36.0) + 0.681 * lobe(l, 459.0, 26.0, 13.8));
  }
  return to_rec709(x, y, z);
}

const Color& white() {
  static const Color color = integrate(d65);
  return color;
}

Rgb over_white(const Color& c) {
  return {static_cast<float>(std::max(0.0, c.r / white().r)),
          static_cast<float>(std::max(0.0, c.g / white().g)),
          static_cast<float>(std::max(0.0, c.b / white().b))};
}

Rgb unit_luminance(const Rgb& color) {
  const float scale = luminance(color);
  return scale > 0 ? color / scale : Rgb{};
}

double at(const Spectrum& spectrum, double wavelength, bool extend) {
  if (spectrum.empty()) return 0;
  if (wavelength < spectrum.front().wavelength) return extend ? spectrum.front().value : 0;
  if (wavelength > spectrum.back().wavelength) return extend ? spectrum.back().value : 0;
  const auto next = std::upper_bound(
      spectrum.begin(), spectrum.end(), wavelength,
      [](double value, const SpectrumSample& sample) { return value < sample.wavelength; });
  if (next == spectrum.end()) return spectrum.back().value;
  const SpectrumSample &a = *(next - 1), &b = *next;
  const double t = (wavelength - a.wavelength) / (b.wavelength - a.wavelength);
  return a.value * (1 - t) + b.value * t;
}

struct NamedChromaticity {
  std::string_view name;
  double x, y;
};

/// CIE 15:2004, tables T.3 and T.8.2 (2 degree observer); D60 as in SMPTE ST 2065-1.
constexpr std::array<NamedChromaticity, 16> kIlluminants = {{{"stdillum-A", 0.44757, 0.40745},
                                                             {"stdillum-D50", 0.34567, 0.35850},
                                                             {"stdillum-D65", 0.31272, 0.32903},
                                                             {"illum-acesD60", 0.32168, 0.33767},
                                                             {"stdillum-F1", 0.31310, 0.33727},
                                                             {"stdillum-F2", 0.37208, 0.37529},
                                                             {"stdillum-F3", 0.40910, 0.39430},
                                                             {"stdillum-F4", 0.44018, 0.40329},
                                                             {"stdillum-F5", 0.31379, 0.34531},
                                                             {"stdillum-F6", 0.37790, 0.38835},
                                                             {"stdillum-F7", 0.31292, 0.32933},
                                                             {"stdillum-F8", 0.34588, 0.35875},
                                                             {"stdillum-F9", 0.37417, 0.37281},
                                                             {"stdillum-F10", 0.34609, 0.35986},
                                                             {"stdillum-F11", 0.38052, 0.37713},
                                                             {"stdillum-F12", 0.43695, 0.40441}}};

struct NamedReflectance {
  std::string_view name;
  Rgb rgb;
};

/// Normal-incidence reflectance, weighted as in reflectance_to_rgb(). Ag, Au, Cu and Al from the n
/// and k of Palik's Handbook of Optical Constants and its relatives as tabulated for spectral
/// renderers (gold's red lies outside the gamut at 1.02 and is clamped); MgO and TiO2 from the same
/// tables, k = 0 in the visible; brass (CuZn) from the "Physically Based" database of materials.
constexpr std::array<NamedReflectance, 7> kConductors = {{{"Ag", {0.9712f, 0.9601f, 0.9150f}},
                                                          {"Al", {0.9133f, 0.9214f, 0.9244f}},
                                                          {"Au", {1.0f, 0.7830f, 0.3442f}},
                                                          {"Cu", {0.9527f, 0.6391f, 0.5378f}},
                                                          {"CuZn", {0.9100f, 0.7780f, 0.4230f}},
                                                          {"MgO", {0.0721f, 0.0731f, 0.0749f}},
                                                          {"TiO2", {0.2323f, 0.2449f, 0.2729f}}}};

}  // namespace

Rgb reflectance_to_rgb(const Spectrum& reflectance) {
  return over_white(integrate(
      [&](double wavelength) { return d65(wavelength) * at(reflectance, wavelength, false); }));
}

Rgb illuminant_to_rgb(const Spectrum& radiance) {
  return unit_luminance(
      over_white(integrate([&](double wavelength) { return at(radiance, wavelength, false); })));
}

Rgb blackbody_to_rgb(double kelvin) {
  // Planck's law up to a factor, which the unit luminance takes out; hc/k = 1.4387769e7 nm K. The
  // exponential is taken relative to that of 780 nm, as it underflows for a few hundred kelvin.
  const double c2 = 1.4387769e7 / kelvin;
  return unit_luminance(over_white(integrate([&](double wavelength) {
    const double reference = c2 / kLast, x = c2 / wavelength;
    return std::pow(wavelength / kLast, -5) * std::exp(reference - x) * -std::expm1(-reference) /
           -std::expm1(-x);
  })));
}

Rgb chromaticity_to_rgb(double x, double y) {
  const Color c = to_rec709(x / y, 1, (1 - x - y) / y);
  return unit_luminance({static_cast<float>(std::max(0.0, c.r)),
                         static_cast<float>(std::max(0.0, c.g)),
                         static_cast<float>(std::max(0.0, c.b))});
}

double conductor_reflectance(double eta, double k) {
  return ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
}

Rgb conductor_to_rgb(const Spectrum& eta, const Spectrum& k) {
  const Rgb rgb = over_white(integrate([&](double wavelength) {
    return d65(wavelength) *
           conductor_reflectance(at(eta, wavelength, true), at(k, wavelength, true));
  }));
  return min(rgb, {1, 1, 1});
}

std::optional<Rgb> named_illuminant(std::string_view name) {
  for (const NamedChromaticity& entry : kIlluminants) {
    if (entry.name == name) return chromaticity_to_rgb(entry.x, entry.y);
  }
  return std::nullopt;
}

std::optional<Rgb> named_conductor(std::string_view substance) {
  for (const NamedReflectance& entry : kConductors) {
    if (entry.name == substance) return entry.rgb;
  }
  return std::nullopt;
}

}  // namespace lte::scene::pbrt
