// The CUDA twins against the CPU's: integers bit for bit, sums to 1e-4 of the largest value.
//
// Without a GPU these tests skip; LTE_REQUIRE_CUDA=1 makes that a failure.
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "lte/ops/curve_codes.h"
#include "lte/ops/farthest_point.h"
#include "lte/ops/knn.h"
#include "lte/ops/linear.h"
#include "lte/ops/neighbour_sums.h"
#include "lte/ops/query_decoder.h"
#include "lte/ops/submanifold_conv.h"
#include "tests/ops/decoder_weights.h"
#include "tests/ops/fixtures.h"

namespace lte::ops {
namespace {

constexpr double kTolerance = 1e-4;

class Cuda : public ::testing::Test {
 protected:
  void SetUp() override {
    if (at::hasCUDA()) return;
    const char* required = std::getenv("LTE_REQUIRE_CUDA");
    ASSERT_FALSE(required != nullptr && required[0] == '1') << "LTE_REQUIRE_CUDA=1, and no device";
    GTEST_SKIP() << "no CUDA device";
  }

  static at::Tensor up(const at::Tensor& t) { return t.to(at::kCUDA); }

  static std::vector<at::Tensor> up(std::vector<at::Tensor> tensors) {
    for (at::Tensor& t : tensors) t = up(t);
    return tensors;
  }

  static void expect_close(const at::Tensor& cuda, const at::Tensor& cpu) {
    ASSERT_TRUE(cuda.is_cuda());
    ASSERT_EQ(cuda.sizes(), cpu.sizes());
    EXPECT_LT(test::relative_error(cuda.cpu(), cpu), kTolerance);
  }
};

TEST_F(Cuda, PointSearchesAndCodesAreTheCpusBitForBit) {
  for (const int64_t N : {1, 127, 128, 129, 3000}) {
    for (const auto& [name, points] : test::awkward_points(N)) {
      const auto picks = farthest_point_sampling(points, (N + 1) / 2),
                 cuda_picks = farthest_point_sampling(up(points), (N + 1) / 2);
      EXPECT_TRUE(at::equal(std::get<0>(cuda_picks).cpu(), std::get<0>(picks))) << name << ' ' << N;
      EXPECT_TRUE(at::equal(std::get<1>(cuda_picks).cpu(), std::get<1>(picks))) << name << ' ' << N;
      const auto near = knn(points, points, 33), cuda_near = knn(up(points), up(points), 33);
      EXPECT_TRUE(at::equal(std::get<0>(cuda_near).cpu(), std::get<0>(near))) << name << ' ' << N;
      EXPECT_TRUE(at::equal(std::get<1>(cuda_near).cpu(), std::get<1>(near))) << name << ' ' << N;
    }
    const at::Tensor cells = test::integers(1 << 16, {N, 3}, 1, at::kInt);
    for (const Curve curve : {Curve::Z, Curve::HilbertTransposed}) {
      EXPECT_TRUE(at::equal(curve_codes(up(cells), curve).cpu(), curve_codes(cells, curve)));
    }
  }
}

TEST_F(Cuda, ConvolutionAndItsGradientsAreTheCpus) {
  const at::Tensor cells = test::integers(9, {400, 3}, 2, at::kInt);  // some share a cell
  const auto [pairs, begin] = convolution_pairs(cells, 3);
  const auto [cuda_pairs, cuda_begin] = convolution_pairs(up(cells), 3);
  EXPECT_TRUE(at::equal(cuda_pairs.cpu(), pairs));
  std::vector<at::Tensor> cpu = {test::normal({400, 20}, 3, at::kFloat),
                                 test::normal({27, 20, 12}, 4, at::kFloat),
                                 test::normal({12}, 5, at::kFloat)};
  std::vector<at::Tensor> cuda = up(cpu);
  for (auto* inputs : {&cpu, &cuda}) {
    for (at::Tensor& t : *inputs) t.requires_grad_();
  }
  const at::Tensor out = submanifold_conv(cpu[0], cpu[1], cpu[2], pairs, begin),
                   cuda_out = submanifold_conv(cuda[0], cuda[1], cuda[2], cuda_pairs, cuda_begin);
  expect_close(cuda_out, out);
  out.square().sum().backward();
  cuda_out.square().sum().backward();
  for (size_t i = 0; i < cpu.size(); ++i) expect_close(cuda[i].grad(), cpu[i].grad());
}

TEST_F(Cuda, MixedPrecisionIsTheCpus) {
  const at::Tensor cells = test::integers(9, {400, 3}, 2, at::kInt);
  const auto [pairs, begin] = convolution_pairs(cells, 3);
  const auto [cuda_pairs, cuda_begin] = convolution_pairs(up(cells), 3);
  std::vector<at::Tensor> cpu = {
      test::normal({400, 32}, 3, at::kFloat), test::normal({27, 32, 48}, 4, at::kFloat),
      test::normal({48}, 5, at::kFloat), test::normal({40, 32}, 6, at::kFloat),
      test::normal({40}, 7, at::kFloat)};
  std::vector<at::Tensor> cuda = up(cpu);
  for (auto* inputs : {&cpu, &cuda}) {
    for (at::Tensor& t : *inputs) t.requires_grad_();
  }
  const at::Tensor dense = linear_autocast(cpu[0], cpu[3], cpu[4]),
                   cuda_dense = linear_autocast(cuda[0], cuda[3], cuda[4]);
  expect_close(cuda_dense, dense);
  const at::Tensor out = submanifold_conv_autocast(cpu[0], cpu[1], cpu[2], pairs, begin),
                   cuda_out =
                       submanifold_conv_autocast(cuda[0], cuda[1], cuda[2], cuda_pairs, cuda_begin);
  expect_close(cuda_out, out);
  // Given gradients, so that both round the same.
  const at::Tensor grad = test::normal({400, 48}, 8, at::kFloat),
                   dense_grad = test::normal({400, 40}, 9, at::kFloat);
  out.backward(grad);
  dense.backward(dense_grad);
  cuda_out.backward(up(grad));
  cuda_dense.backward(up(dense_grad));
  for (size_t i = 0; i < cpu.size(); ++i) expect_close(cuda[i].grad(), cpu[i].grad());
}

TEST_F(Cuda, NeighbourSumsAndTheirGradientsAreTheCpus) {
  const int64_t L = 3, m = 50, C = 40, Q = 77, K = 9;
  std::vector<at::Tensor> cpu = {test::normal({L, m, C}, 6, at::kFloat),
                                 test::normal({L, m, C}, 7, at::kFloat),
                                 test::normal({Q, K, C}, 8, at::kFloat)};
  const at::Tensor index = test::integers(m, {Q, K}, 9);
  const at::Tensor hidden = test::normal({Q, K, 13}, 10, at::kFloat),
                   weight = test::normal({C, 13}, 11, at::kFloat),
                   bias = test::normal({C}, 12, at::kFloat);
  const auto fused =
      neighbour_sums_inference(neighbour_table(cpu[0], cpu[1]), hidden, weight, bias, index);
  std::vector<at::Tensor> cuda = up(cpu);
  const auto cuda_fused = neighbour_sums_inference(neighbour_table(cuda[0], cuda[1]), up(hidden),
                                                   up(weight), up(bias), up(index));
  expect_close(std::get<0>(cuda_fused), std::get<0>(fused));
  expect_close(std::get<1>(cuda_fused), std::get<1>(fused));
  for (auto* inputs : {&cpu, &cuda}) {
    for (at::Tensor& t : *inputs) t.requires_grad_();
  }
  const auto [sum1, sum2] = neighbour_sums(cpu[0], cpu[1], cpu[2], index);
  const auto [cuda1, cuda2] = neighbour_sums(cuda[0], cuda[1], cuda[2], up(index));
  expect_close(cuda1, sum1);
  expect_close(cuda2, sum2);
  (sum1.square() + sum2).sum().backward();
  (cuda1.square() + cuda2).sum().backward();
  for (size_t i = 0; i < cpu.size(); ++i) expect_close(cuda[i].grad(), cpu[i].grad());
}

TEST_F(Cuda, TheFusedQueryDecoderIsTheCpus) {
  struct Sizes {
    int64_t Q, m, K, C, L, hidden;
  };
  // About a warp and a block of channels, a run of neighbours, of activations, and of queries.
  for (const Sizes& s : {Sizes{0, 5, 3, 16, 1, 8}, Sizes{1, 1, 1, 1, 1, 1},
                         Sizes{250, 40, 9, 20, 3, 150}, Sizes{100, 90, 33, 33, 2, 64},
                         Sizes{70, 200, 70, 257, 2, 65}, Sizes{20'000, 500, 32, 128, 6, 64}}) {
    const auto weights = test::decoder_weights(9, s.C, s.L, s.hidden);
    const at::Tensor keys = test::normal({s.L, s.m, s.C}, 11, at::kFloat),
                     values = test::normal({s.L, s.m, s.C}, 12, at::kFloat),
                     attributes = test::normal({s.Q, 9}, 13, at::kFloat);
    const QueryNeighbourhood near{test::uniform({s.Q, 3}, 14), test::uniform({s.m, 3}, 15),
                                  test::integers(s.m, {s.Q, s.K}, 16), 10, 4};
    const QueryNeighbourhood cuda_near{up(near.position), up(near.anchor), up(near.index),
                                       near.scale, near.limit};
    const at::Tensor expected =
        query_decoder_inference(attributes, near, neighbour_table(keys, values), weights);
    const at::Tensor got = query_decoder_inference(
        up(attributes), cuda_near, neighbour_table(up(keys), up(values)), up(weights));
    expect_close(got, expected);
    // In bfloat16 a sum in another order may round to the other neighbour: far fewer than all do.
    std::vector<at::Tensor> half = weights;
    for (size_t i = 0; i < half.size(); ++i) {
      if (half[i].dim() == 2 && i != 4) half[i] = half[i].to(at::kBFloat16);
    }
    const at::Tensor rounded =
        query_decoder_inference(attributes, near, neighbour_table(keys, values), half);
    const at::Tensor cuda_rounded = query_decoder_inference(
        up(attributes), cuda_near, neighbour_table(up(keys), up(values)), up(half));
    ASSERT_EQ(cuda_rounded.sizes(), rounded.sizes());
    EXPECT_LT(test::relative_error(cuda_rounded.cpu(), rounded), 5e-3);
  }
}

TEST_F(Cuda, DenseLayersOfBfloat16WeightsAreTheCpus) {
  const at::Tensor x = test::normal({3, 70, 48}, 1, at::kFloat),
                   bias = test::normal({40}, 2, at::kFloat),
                   weight = test::normal({40, 48}, 3, at::kFloat).to(at::kBFloat16);
  expect_close(linear(up(x), up(weight), up(bias)), linear(x, weight, bias));
  // The CPU's GELU is to 2e-4 where a rounding follows.
  EXPECT_LT(test::relative_error(linear_gelu(up(x), up(weight), up(bias)).cpu(),
                                 linear_gelu(x, weight, bias)),
            1e-3);
}

TEST_F(Cuda, RefusesTensorsOfTwoDevices) {
  const at::Tensor points = test::uniform({10, 3}, 17);
  EXPECT_TRUE(test::throws_saying([&] { knn(up(points), points, 2); }, "points on cpu"));
}

}  // namespace
}  // namespace lte::ops
