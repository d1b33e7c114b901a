#include "lte/gi/expected_error.h"

#include <cmath>

namespace lte::gi {

double posterior_square(double square, double found, double noise) {
  const double doubt = 2 * square * square;
  return doubt + noise > 0 ? (found * doubt + square * noise) / (doubt + noise) : found;
}

double shifted_square(double off, double standard_error) {
  const double before = kSharedError * kSharedError, noise = standard_error * standard_error;
  const double known = before / (before + noise);
  return std::pow(known * off, 2) + known * noise;
}

}  // namespace lte::gi
