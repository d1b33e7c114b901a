// Ranges that configurations draw from.
#pragma once

#include <cstdint>

namespace lte::datagen {

struct Range {
  double low = 0, high = 0;
};
struct CountRange {
  int64_t low = 0, high = 0;
};

}  // namespace lte::datagen
