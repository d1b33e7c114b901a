// Weights for ops::query_decoder_inference().
#pragma once

#include <cmath>
#include <vector>

#include "tests/ops/fixtures.h"

namespace lte::ops::test {

/// Weights of a decoder of C channels, L layers, A attributes and one hidden width.
inline std::vector<at::Tensor> decoder_weights(int64_t A, int64_t C, int64_t L, int64_t hidden) {
  std::vector<at::Tensor> w;
  uint64_t seed = 100;
  const auto floats = [](at::IntArrayRef shape, uint64_t s) {
    return normal(shape, s, at::kFloat);
  };
  const auto linear = [&](int64_t in, int64_t out) {
    w.push_back(floats({out, in}, seed++) / std::sqrt(static_cast<double>(in)));
    w.push_back(floats({out}, seed++));
  };
  const auto norm = [&] {
    w.push_back(floats({C}, seed++));
    w.push_back(floats({C}, seed++));
  };
  linear(A, hidden), linear(hidden, C), linear(3, hidden), linear(hidden, C);
  for (int64_t l = 0; l < L; ++l) {
    norm(), linear(C, C), linear(C, C), norm(), linear(C, hidden), linear(hidden, C);
  }
  norm(), linear(C, hidden), linear(hidden, 3);
  return w;
}

}  // namespace lte::ops::test
