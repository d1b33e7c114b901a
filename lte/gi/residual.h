// Residual correction: what unbiased estimates say about the error of an answer, smoothed over the
// surfaces.
//
// At points, batches of unbiased estimates are compared with the answer there (a network's, say).
// The mean difference of a point is its error plus noise. Neighbours on the same surface share the
// error and not the noise, so differences are averaged over a radius, the one that Stein's unbiased
// risk estimate finds best for the noise of now: far for few paths, the point alone for many. What
// is left is shrunk, in every neighbourhood, by its signal against its own variance (empirical
// Bayes with a normal prior of mean 0). So at its points the corrected answer converges to what the
// estimates converge to.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/gi/surface_index.h"

namespace lte::gi {

class ResidualField {
 public:
  /// @param normals  unit, of the side that is asked about
  /// @param spacing  metres to the next points on the surface, one a point
  /// @throws lte::Error if sizes differ, a value is not finite or a spacing not positive.
  ResidualField(std::vector<Vec3> positions, std::vector<Vec3> normals, std::vector<float> spacing);

  /// Adds one batch: an estimate a point, independent of all batches before, and what was answered
  /// there. Batches count alike, so each has as many paths.
  /// @throws lte::Error if sizes differ or a value is not finite.
  void add(std::span<const Rgb> estimates, std::span<const Rgb> answers);

  int64_t size() const { return static_cast<int64_t>(positions_.size()); }
  int64_t batches() const { return batches_; }

  /// The correction to add at the points. Chooses the radius, radius_in_spacings() from then on.
  std::vector<Rgb> correct_points();
  /// The correction to add elsewhere, from the points around; 0 where there are none. At least
  /// kLeastRadius wide. Signal here is what different points have in common: an error that a point
  /// has for itself says nothing of the places between.
  /// @note correct_points() has to come first after each add().
  std::vector<Rgb> correct(std::span<const Vec3> positions, std::span<const Vec3> normals) const;

  /// Of the last correct_points(); 0 for each point by itself.
  float radius_in_spacings() const { return radius_; }

  static constexpr float kLeastRadius = 2;

 private:
  struct Smooth;
  const SurfaceIndex& index(float radius) const;
  Smooth smooth(const SurfaceIndex& index, const Vec3& position, const Vec3& normal) const;
  Rgb shrunk(const Smooth& wide, const Smooth& smooth) const;
  void estimate_noise();
  double risk(float radius) const;
  Smooth own(size_t i) const;

  std::vector<Vec3> positions_, normals_;
  std::vector<float> spacing_;
  std::vector<Rgb> mean_, squares_;  ///< Welford's: mean, and sum of squared deviations from it
  std::vector<Rgb> noise_;           ///< variance of mean_, pooled over neighbours
  int64_t batches_ = 0;
  float radius_ = 0;
  std::vector<SurfaceIndex> indices_;  ///< one for each radius of the ladder
};

}  // namespace lte::gi
