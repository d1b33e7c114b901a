#include "lte/render/way_regression.h"

#include <algorithm>

namespace lte::render {
std::vector<float> error_weights(std::vector<float> light) {
  double sum = 0;
  for (const float value : light) sum += double{value};
  const auto points = static_cast<double>(std::max<size_t>(1, light.size()));
  const auto dark = static_cast<float>(gi::kDark * sum / points) + 1e-30f;
  for (float& value : light) value = 1 / (value + dark);
  return light;
}

double WayRegression::expected_share(const std::vector<float>& noise) const {
  // Of an error of kSharedError in each of three channels, seen by two halves.
  constexpr double kShared = 6 * gi::kSharedError * gi::kSharedError;
  double found = 0, way = 0, variance = 0, points = 0;
  for (size_t i = 0; i < along.size(); ++i) {
    found += double{along[i]};
    way += double{square[i]};
    variance += double{noise[i]};
    points += square[i] > 0 ? 1 : 0;
  }
  if (!(way > 0)) return 0;
  return std::clamp(gi::shrunk(found, variance, kShared * points) / way, 0.0, 1.0);
}

}  // namespace lte::render
