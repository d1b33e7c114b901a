// Muon's step against singular value decompositions.
#include "lte/ops/orthogonal.h"

#include <gtest/gtest.h>
#include <torch/types.h>
#include <torch/utils.h>

#include "tests/ops/fixtures.h"

namespace lte::ops {
namespace {

TEST(Orthogonal, SingularValuesComeNearOneAndSingularVectorsStay) {
  torch::manual_seed(5);
  for (const auto& [rows, columns] : std::vector<std::pair<int64_t, int64_t>>{
           {48, 48}, {192, 48}, {48, 192}, {300, 16}, {7, 5}, {260, 200}, {1, 30}}) {
    const at::Tensor matrices = torch::randn({3, rows, columns}) * 1e-4;
    const at::Tensor found = orthogonal(matrices);
    ASSERT_EQ(found.sizes(), matrices.sizes());
    const auto [u, s, v] = torch::linalg_svd(matrices, /*full_matrices=*/false);
    // In the basis of the matrices' own singular vectors it is diagonal.
    const at::Tensor inside = u.mT().matmul(found).matmul(v.mT());
    const at::Tensor values = inside.diagonal(0, 1, 2);
    const at::Tensor large = values.masked_select(s > 0.05 * s.amax(-1, true));
    EXPECT_GT(large.min().item<double>(), 0.6) << rows << " x " << columns;
    EXPECT_LT(values.max().item<double>(), 1.25) << rows << " x " << columns;
    const at::Tensor beside = inside - torch::diag_embed(values);
    EXPECT_LT(beside.abs().max().item<double>(), 1e-3) << rows << " x " << columns;
  }
}

TEST(Orthogonal, MatricesOfABatchDoNotTouchEachOther) {
  torch::manual_seed(6);
  const at::Tensor matrices = torch::randn({4, 20, 32});
  const at::Tensor together = orthogonal(matrices);
  for (int64_t i = 0; i < 4; ++i) {
    const at::Tensor alone = orthogonal(matrices.slice(0, i, i + 1));
    EXPECT_TRUE(torch::equal(together.slice(0, i, i + 1), alone));
  }
  EXPECT_TRUE(torch::equal(test::with_threads(1, [&] { return orthogonal(matrices); }), together));
}

TEST(Orthogonal, RefusesWhatIsNoBatchOfMatrices) {
  EXPECT_TRUE(test::throws_saying([] { orthogonal(torch::randn({4, 4})); }, "[B, N, M]"));
  EXPECT_TRUE(test::throws_saying(
      [] {
        orthogonal(torch::randn({1, 4, 4}, torch::kDouble));
      },
      "float32"));
  EXPECT_EQ(orthogonal(torch::zeros({0, 4, 3})).sizes(), (at::IntArrayRef{0, 4, 3}));
}

TEST(Orthogonal, ItsLengthDoesNotCountAndZerosStay) {
  torch::manual_seed(7);
  const at::Tensor matrix = torch::randn({1, 24, 16});
  EXPECT_TRUE(torch::allclose(orthogonal(matrix * 1e-6), orthogonal(matrix * 1e6), 1e-3, 1e-4));
  const at::Tensor zeros = orthogonal(torch::zeros({1, 24, 16}));
  EXPECT_EQ(zeros.abs().max().item<double>(), 0);
}

}  // namespace
}  // namespace lte::ops
