#include "lte/render/way_regression.h"

namespace lte::render {
namespace {

/// Of the mean: what is darker counts like that where errors are compared.
constexpr double kDark = 0.1;

}  // namespace

std::vector<float> error_weights(std::vector<float> light) {
  double sum = 0;
  for (const float value : light) sum += double{value};
  const auto points = static_cast<double>(std::max<size_t>(1, light.size()));
  const auto dark = static_cast<float>(kDark * sum / points) + 1e-30f;
  for (float& value : light) value = 1 / (value + dark);
  return light;
}

}  // namespace lte::render
