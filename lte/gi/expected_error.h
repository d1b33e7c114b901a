// The error to expect of light that a cache or a network tells: the error column of points, the
// check of light and the expected error of light maps read it.
//
// Rays tell their own noise. What all rays of a point share, faults of the records that they read,
// shows in paths alone, and few paths see it barely: until they do, it is what wild rooms have had
// (docs/points.md).
#pragma once

namespace lte::gi {

/// Standard error that rays share, relative to ErrorUnit. Found over wild rooms, so that two thirds
/// of the points lie within the error that is expected and 95 % within twice that.
inline constexpr double kSharedError = 0.03;

/// Errors are relative to the light at a place and so much of the mean: where light hardly reaches,
/// they are those of the light around.
inline constexpr double kDark = 0.1;

/// The light that errors at a place are relative to.
class ErrorUnit {
 public:
  /// @param mean_light  over all places
  explicit ErrorUnit(double mean_light) : dark_(kDark * mean_light) {}
  double operator()(double light) const { return light + dark_; }

 private:
  double dark_;
};

/// Empirical Bayes (Efron and Morris 1973): what light is expected to be off by, squared, of which
/// kSharedError is known before and `off`, to a standard error, was found. Normal errors.
double shifted_square(double off, double standard_error);

}  // namespace lte::gi
