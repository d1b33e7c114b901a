// The mean of samples and its standard error.
#pragma once

#include <algorithm>
#include <cmath>

namespace lte::test {

struct Mean {
  int count = 0;
  double sum = 0, squares = 0;
  void add(double value) { ++count, sum += value, squares += value * value; }
  double value() const { return sum / count; }
  double variance() const { return std::max(0.0, squares - sum * sum / count) / (count - 1); }
  double error() const { return std::sqrt(variance() / count); }
};

}  // namespace lte::test
