#include "lte/render/way_regression.h"

#include "lte/gi/expected_error.h"

namespace lte::render {
std::vector<float> error_weights(std::vector<float> light) {
  double sum = 0;
  for (const float value : light) sum += double{value};
  const auto points = static_cast<double>(std::max<size_t>(1, light.size()));
  const auto dark = static_cast<float>(gi::kDark * sum / points) + 1e-30f;
  for (float& value : light) value = 1 / (value + dark);
  return light;
}

}  // namespace lte::render
