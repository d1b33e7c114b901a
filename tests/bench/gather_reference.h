// The view, the reference and the errors of lte_gather_bench.
#pragma once

#include <filesystem>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::bench {

inline constexpr int kHalfPaths = 512;  ///< of each of the two halves of the reference
inline constexpr int kModelDepth = 5;   ///< that network and estimates have; a gather adds one

/// The reflecting pixels of a picture.
struct View {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;
  std::vector<float> spacing;  ///< metres between neighbouring pixels on the surface
};

/// From the scene's first camera, else the automatic one. @throws lte::Error if it sees nothing.
View look(const pathtrace::Bvh& bvh, int width, int height);

/// Two independent estimates of indirect irradiance, by the depth where paths end: the product of a
/// method's errors against both has no noise of theirs in its mean.
struct Reference {
  std::vector<Rgb> half[2][2];  ///< [half][0: depth 5, 1: depth 6]
};

/// Read from the file `cached` where it fits the view, else traced and written there.
Reference reference_of(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights, const View& view,
                       const std::filesystem::path& cached);

struct Score {
  double mse = 0, relmse = 0;
};

/// Errors without the reference's noise. @param one_more  the method's light has depth 6
Score score(const std::vector<Rgb>& values, const Reference& reference, bool one_more);
/// Errors of values that the first half went into, against the second, less its noise.
Score score_against_second(const std::vector<Rgb>& values, const Reference& reference);

}  // namespace lte::bench
