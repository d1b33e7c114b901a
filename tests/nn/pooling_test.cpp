#include "lte/nn/encoder/pooling.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/nn/support.h"

namespace lte::nn {
namespace {

/// A stage of one scene, of which nothing but its points' number is known.
StagePlan stage_of(int64_t points) {
  StagePlan stage;
  stage.scenes = {{0, points, {{}}}};
  return stage;
}

TEST(ClusterArgmax, MatchesLoopsAndGivesTiesToTheLowestRow) {
  torch::manual_seed(6);
  const int64_t n = 60, C = 5, clusters = 9;
  const at::Tensor x = torch::randint(4, {n, C}).to(at::kFloat);  // many ties
  at::Tensor cluster = torch::randint(clusters, {n});
  cluster.narrow(0, 0, clusters).copy_(torch::arange(clusters));
  const at::Tensor got = cluster_argmax(x, cluster, clusters);
  EXPECT_TRUE(at::equal(cluster_max(x, cluster, clusters), x.gather(0, got)));
  for (int64_t c = 0; c < clusters; ++c) {
    for (int64_t j = 0; j < C; ++j) {
      int64_t best = -1;
      for (int64_t i = 0; i < n; ++i) {
        if (cluster[i].item<int64_t>() != c) continue;
        if (best < 0 || x[i][j].item<float>() > x[best][j].item<float>()) best = i;
      }
      EXPECT_EQ(got[c][j].item<int64_t>(), best) << "cluster " << c << " channel " << j;
    }
  }
}

TEST(Pooling, ANaNStaysWhateverStandsBesideIt) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = INFINITY;
  const at::Tensor cluster = torch::tensor({0, 0, 1, 1});
  for (const float other : {1.0f, -inf, inf, nan}) {
    const at::Tensor x = torch::tensor({{other, nan}, {nan, other}, {2.0f, 3.0f}, {5.0f, 3.0f}});
    const at::Tensor row = cluster_argmax(x, cluster, 2);
    const at::Tensor top = x.gather(0, row);
    EXPECT_TRUE(cluster_max(x, cluster, 2).allclose(top, 0, 0, /*equal_nan=*/true)) << other;
    EXPECT_TRUE(top[0].isnan().all().item<bool>()) << other;
    EXPECT_TRUE(torch::equal(top[1], torch::tensor({5.0f, 3.0f}))) << "another cluster";
    EXPECT_EQ(row[1][1].item<int64_t>(), 2) << "ties go to the lowest row";
  }
}

class PoolingWith : public testing::TestWithParam<bool> {};

TEST_P(PoolingWith, GradientsMatchFiniteDifferencesDownAndUp) {
  Pooling pool(6, 8, GetParam());
  Unpooling unpool(8, 6, 5, GetParam());
  test::randomize(*pool, 9);
  test::randomize(*unpool, 10);
  pool->to(at::kDouble);
  unpool->to(at::kDouble);
  StagePlan coarse = stage_of(3);
  coarse.cells = torch::zeros({3, 3}, at::kInt);
  coarse.cluster = torch::tensor({0, 2, 1, 1, 0, 2, 2});
  const at::Tensor x = torch::randn({7, 6}, at::kDouble).requires_grad_();
  std::vector<at::Tensor> inputs = pool->parameters();
  for (const at::Tensor& p : unpool->parameters()) inputs.push_back(p);
  inputs.push_back(x);
  const at::Tensor weight = torch::randn({7, 5}, at::kDouble);
  test::expect_gradients_match(
      [&] {
        const at::Tensor up = unpool->forward(pool->forward(x, coarse), x, coarse, stage_of(7));
        return (up * weight).sum();
      },
      inputs);
}

INSTANTIATE_TEST_SUITE_P(Centerings, PoolingWith, testing::Bool());

}  // namespace
}  // namespace lte::nn
