// nanoflann beside knn: the tree built and queried on all threads that LibTorch has.
#pragma once

#include <ATen/ATen.h>
#include <ATen/Parallel.h>
#include <nanoflann.hpp>

namespace lte::bench {

struct NanoflannCloud {
  const float* points;
  size_t count;
  size_t kdtree_get_point_count() const { return count; }
  float kdtree_get_pt(size_t i, size_t axis) const { return points[3 * i + axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

/// Builds the tree and answers every query with its k nearest.
inline void nanoflann_knn(const at::Tensor& queries, const at::Tensor& points, int64_t k,
                          size_t leaf_size) {
  using Tree =
      nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, NanoflannCloud>,
                                          NanoflannCloud, 3, uint32_t>;
  const NanoflannCloud cloud{points.const_data_ptr<float>(), static_cast<size_t>(points.size(0))};
  Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(leaf_size));
  tree.buildIndex();
  at::Tensor index = at::empty({queries.size(0), k}, at::kInt),
             distance = at::empty({queries.size(0), k});
  const auto* from = queries.const_data_ptr<float>();
  auto* ids = reinterpret_cast<uint32_t*>(index.data_ptr<int32_t>());
  auto* to = distance.data_ptr<float>();
  at::parallel_for(0, queries.size(0), 512, [&](int64_t begin, int64_t end) {
    for (int64_t q = begin; q < end; ++q) {
      tree.knnSearch(from + 3 * q, static_cast<size_t>(k), ids + q * k, to + q * k);
    }
  });
}

}  // namespace lte::bench
