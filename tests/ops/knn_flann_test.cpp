// FLANN as a second opinion on neighbours.
#include <ATen/ATen.h>
#include <flann/flann.hpp>
#include <gtest/gtest.h>

#include "lte/ops/knn.h"
#include "tests/ops/fixtures.h"

namespace lte::ops {
namespace {

TEST(KnnOnTheCpu, AgreesWithFlann) {
  const at::Tensor points = test::uniform({5000, 3}, 1), queries = test::uniform({3000, 3}, 2);
  const auto [index, distance] = knn(queries, points, 32);
  flann::Matrix<float> data(points.data_ptr<float>(), 5000, 3);
  flann::Matrix<float> asked(queries.data_ptr<float>(), 3000, 3);
  flann::KDTreeSingleIndex<flann::L2_Simple<float>> tree(data);
  tree.buildIndex();
  at::Tensor flann_distance = at::empty({3000, 32}), flann_index = at::empty({3000, 32}, at::kInt);
  flann::Matrix<float> to(flann_distance.data_ptr<float>(), 3000, 32);
  flann::Matrix<int> ids(flann_index.data_ptr<int>(), 3000, 32);
  tree.knnSearch(asked, ids, to, 32, flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
  EXPECT_LT(test::relative_error(distance, flann_distance), 1e-6);
  // Equal up to exchanges of distances that differ by rounding.
  EXPECT_LT(index.ne(flann_index).sum().item<int64_t>(), 20);
}

}  // namespace
}  // namespace lte::ops
