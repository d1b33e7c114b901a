// Parameters that are spectra, as linear Rec.709.
#pragma once

#include <optional>

#include "lte/scene/pbrt/files.h"
#include "lte/scene/pbrt/params.h"
#include "lte/scene/pbrt/spectrum.h"

namespace lte::scene::pbrt {

/// A reflectance, albedo or factor: rgb, float, spectrum (pairs, a file of pairs).
/// @throws lte::Error with file and line for other types, wrong numbers of values, negative values.
Rgb to_reflectance(const Parameter& parameter, const Files& files, IgnoredFeatures* ignored);

/// Emitted light: rgb and float as they are; blackbody and spectra at luminance 1, as pbrt-v4
/// normalizes them.
Rgb to_illuminant(const Parameter& parameter, const Files& files, IgnoredFeatures* ignored);

/// Reflectance of a conductor with these "eta" and "k"; copper for one that is missing, as in pbrt.
Rgb to_conductor(const Parameter* eta, const Parameter* k, const Files& files,
                 IgnoredFeatures* ignored);

}  // namespace lte::scene::pbrt
