// Memory for time: what a part of the network computes on the way is thrown away, and computed
// again when the backward pass comes to it (Chen et al. 2016, Training Deep Nets with Sublinear
// Memory Cost).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "lte/tensor/tensor.h"

namespace lte::nn {

using TensorFunction = std::function<std::vector<at::Tensor>(const std::vector<at::Tensor>&)>;

/// function(inputs), of which only inputs and results are kept.
///
/// @param function    draws no random numbers, and reads nothing that needs a gradient but its
///                    arguments and `parameters`. It is kept until the backward pass has run.
/// @param parameters  leaves, which receive their gradients as usual
/// @return  as `function`; differentiable once. Without gradients it is a plain call.
std::vector<at::Tensor> recompute(TensorFunction function, const std::vector<at::Tensor>& inputs,
                                  const std::vector<at::Tensor>& parameters);

/// Whether what is computed now is differentiated, now or by recompute() later: gradients are on,
/// or this is the first run of a function that runs again with gradients.
bool is_differentiated();

/// Numbers that pairs of points and neighbours may hold between two layers: 16 MiB in float32, on a
/// GPU, where what is small waits for its launch, 256 MiB. What has more works in blocks of rows,
/// which training recomputes.
inline constexpr int64_t kPairNumbers = int64_t{1} << 22, kPairNumbersOnGpu = int64_t{1} << 26;

/// Rows of a block, at least 1, where each row has so many numbers.
inline int64_t rows_of_a_block(int64_t numbers_per_row, at::Device device) {
  const int64_t most = device.is_cpu() ? kPairNumbers : kPairNumbersOnGpu;
  return numbers_per_row >= most ? 1 : most / (numbers_per_row > 0 ? numbers_per_row : 1);
}

}  // namespace lte::nn
