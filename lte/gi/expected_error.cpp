#include "lte/gi/expected_error.h"

#include <cmath>

namespace lte::gi {

double shifted_square(double off, double standard_error) {
  const double before = kSharedError * kSharedError, noise = standard_error * standard_error;
  const double known = before / (before + noise);
  return std::pow(known * off, 2) + known * noise;
}

}  // namespace lte::gi
