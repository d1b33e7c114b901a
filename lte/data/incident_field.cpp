#include "lte/data/incident_field.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"

namespace lte::data {

size_t IncidentField::size_bytes() const {
  size_t bytes = 0;
  for_each_incident_tensor(*this, 0, [&bytes](const TensorRule&, const auto& values) {
    bytes += values.size() * sizeof(values[0]);
  });
  return bytes;
}

float half_scale(float largest) {
  LTE_CHECK(std::isfinite(largest) && largest >= 0,
            "radiance must be finite and not negative, got ", largest);
  if (largest == 0) return 1;
  int exponent = 0;
  std::frexp(largest, &exponent);
  return std::ldexp(1.0f, std::max(exponent - 15, -126));
}

}  // namespace lte::data
