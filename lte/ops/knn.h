// Exact k nearest neighbours in three dimensions.
#pragma once

#include <cstdint>
#include <memory>
#include <tuple>

#include "lte/tensor/tensor.h"

namespace lte::ops {

/// The k nearest points of every query by Euclidean distance, nearest first; of equal distances the
/// lower index comes first.
///
/// @param queries  [Q, 3] float32, contiguous, finite
/// @param points   [N, 3] float32, contiguous, finite, N >= 1 unless Q == 0
/// @param k        >= 1
/// @return  indices [Q, min(k, N)] int64 into `points`, and squared distances [Q, min(k, N)]
///          float32
/// @throws c10::Error on a wrong shape, dtype, layout, device or `k`, or, on the CPU, non-finite
///         input (naming the row); a GPU would have to be waited for
/// @note The result depends on neither the number of threads nor the order of queries. CPU and CUDA
///       agree bit for bit. Not differentiable.
std::tuple<at::Tensor, at::Tensor> knn(const at::Tensor& queries, const at::Tensor& points,
                                       int64_t k);

/// Points that are searched again and again: what knn() builds of them on the CPU, built once. Any
/// number of threads may search at the same time.
class KnnIndex {
 public:
  /// @param points  as knn()'s, on the CPU, at least one; they are copied
  /// @throws c10::Error as knn()
  KnnIndex(const at::Tensor& points, int64_t k);
  ~KnnIndex();

  /// What knn() gives for the points and k, to the last bit.
  /// @throws c10::Error as knn()
  std::tuple<at::Tensor, at::Tensor> search(const at::Tensor& queries) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace lte::ops
