#include "lte/gi/expected_error.h"

#include <cmath>

namespace lte::gi {

double shrunk(double found, double noise, double expected) {
  const double apart = found - expected;
  return expected + (apart * apart > noise ? apart - noise / apart : 0);
}

double shifted_square(double off, double standard_error) {
  const double before = kSharedError * kSharedError, noise = standard_error * standard_error;
  const double known = before / (before + noise);
  return std::pow(known * off, 2) + known * noise;
}

}  // namespace lte::gi
