// Views, copies and arithmetic, of whichever tensors the build has.
#include "lte/tensor/tensor.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/random.h"
#include "lte/tensor/functions.h"

namespace lte {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

template <typename T>
std::vector<T> numbers(const at::Tensor& t) {
  const at::Tensor dense = t.contiguous();
  const auto* values = dense.const_data_ptr<T>();
  return std::vector<T>(values, values + dense.numel());
}

std::vector<int64_t> shape(const at::Tensor& t) { return t.sizes().vec(); }

/// 0, 1, 2, ... in float32.
at::Tensor counted(const std::vector<int64_t>& sizes) {
  int64_t count = 1;
  for (const int64_t size : sizes) count *= size;
  return at::arange(count, at::TensorOptions(at::kFloat)).view(sizes);
}

TEST(Tensor, ViewsShareMemory) {
  const at::Tensor t = counted({2, 3});
  t.select(1, 1).fill_(9);
  t.narrow(1, 2, 1).copy_(t.narrow(1, 0, 1));
  EXPECT_THAT(numbers<float>(t), ElementsAre(0, 9, 0, 3, 9, 3));
  EXPECT_THAT(numbers<float>(t.t()), ElementsAre(0, 3, 9, 9, 0, 3));
  EXPECT_THAT(numbers<float>(t[1]), ElementsAre(3, 9, 3));
  EXPECT_EQ(t[1][1].item<double>(), 9);
}

TEST(Tensor, ViewsOfViewsReadWhatTheirIndicesSay) {
  const at::Tensor t = counted({2, 3, 4});
  const auto at = [](int64_t i, int64_t j, int64_t k) {
    return static_cast<float>(12 * i + 4 * j + k);
  };
  const at::Tensor p = t.permute({2, 0, 1});
  EXPECT_EQ(shape(p), (std::vector<int64_t>{4, 2, 3}));
  EXPECT_FALSE(p.is_contiguous());
  for (int64_t k = 0; k < 4; ++k)
    for (int64_t i = 0; i < 2; ++i)
      for (int64_t j = 0; j < 3; ++j) ASSERT_EQ(p[k][i][j].item<float>(), at(i, j, k));
  // Axes that lie one behind the other are one in a view; others are none.
  EXPECT_THAT(numbers<float>(t.transpose(0, 1).view({3, 2, 2, 2})[2]),
              ElementsAre(8, 9, 10, 11, 20, 21, 22, 23));
  EXPECT_ANY_THROW(p.view({8, 3}).sizes()) << "needs a copy";
  EXPECT_THAT(numbers<float>(p.reshape({-1, 3})[7]), ElementsAre(15, 19, 23));
  EXPECT_EQ(shape(t.unsqueeze(1).unsqueeze(-1)), (std::vector<int64_t>{2, 1, 3, 4, 1}));
  EXPECT_EQ(shape(t.unsqueeze(1).squeeze(1)), shape(t));
  EXPECT_EQ(shape(t.squeeze(0)), shape(t));
  EXPECT_EQ(shape(t.flatten(1)), (std::vector<int64_t>{2, 12}));
  EXPECT_THAT(numbers<float>(counted({3, 1}).expand({3, 2})), ElementsAre(0, 0, 1, 1, 2, 2));
  EXPECT_EQ(shape(at::zeros({0, 3}).view({-1, 1, 3})), (std::vector<int64_t>{0, 1, 3}));
}

TEST(Tensor, PartsCoverTheWhole) {
  const at::Tensor t = counted({5, 2});
  const std::vector<at::Tensor> parts = t.split_with_sizes({1, 0, 4});
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_EQ(parts[1].size(0), 0);
  EXPECT_THAT(numbers<float>(parts[2]), ElementsAre(2, 3, 4, 5, 6, 7, 8, 9));
  EXPECT_THAT(numbers<float>(t.unbind(1)[1]), ElementsAre(1, 3, 5, 7, 9));
  EXPECT_THAT(numbers<float>(t.chunk(2, 1)[0]), ElementsAre(0, 2, 4, 6, 8));
}

TEST(Tensor, TypesAreConvertedAsByLanguage) {
  const at::Tensor t = at::tensor({-1.75, 0.0, 3.9}, at::TensorOptions(at::kDouble));
  EXPECT_THAT(numbers<int64_t>(t.to(at::kLong)), ElementsAre(-1, 0, 3));
  EXPECT_THAT(numbers<bool>(t.to(at::kBool)), ElementsAre(true, false, true));
  EXPECT_THAT(numbers<float>(t.to(at::kFloat)), ElementsAre(-1.75F, 0, 3.9F));
  EXPECT_EQ(t.to(at::kDouble).const_data_ptr(), t.const_data_ptr()) << "nothing to convert";
}

TEST(Tensor, Bfloat16RoundsToNearestEven) {
  // Steps are 1/128 above 1: halves go to the even neighbour.
  const at::Tensor t =
      at::tensor({1 + 1 / 256.F, 1 + 3 / 256.F, 1 + 1.01F / 256, -1e-40F, INFINITY},
                 at::TensorOptions(at::kFloat));
  const std::vector<float> back = numbers<float>(t.to(at::kBFloat16).to(at::kFloat));
  EXPECT_EQ(back[0], 1);
  EXPECT_EQ(back[1], 1 + 4 / 256.F);
  EXPECT_EQ(back[2], 1 + 2 / 256.F);
  EXPECT_EQ(back[4], INFINITY);
  EXPECT_TRUE(std::isnan(at::full({1}, kNaN).to(at::kBFloat16).item<float>()));
}

TEST(Tensor, ArithmeticBroadcasts) {
  const at::Tensor row = counted({3}), column = counted({2, 1});
  EXPECT_THAT(numbers<float>(row + column), ElementsAre(0, 1, 2, 1, 2, 3));
  EXPECT_THAT(numbers<float>(column - row), ElementsAre(0, -1, -2, 1, 0, -1));
  EXPECT_THAT(numbers<float>(1 - row), ElementsAre(1, 0, -1));
  EXPECT_THAT(numbers<float>(row.mul(0.1)), ElementsAre(0, 0.1F, 2 * 0.1F)) << "in float32";
  EXPECT_THAT(numbers<float>(row.div(3)), ElementsAre(0, 1 / 3.F, 2 / 3.F));
  EXPECT_THAT(numbers<int64_t>(at::arange(-3, 3).div(2, "floor")),
              ElementsAre(-2, -1, -1, 0, 0, 1));
  EXPECT_THAT(numbers<int64_t>(at::arange(5).bitwise_right_shift(1)), ElementsAre(0, 0, 1, 1, 2));
  EXPECT_THAT(numbers<float>(row.clamp(0.5, 1.5)), ElementsAre(0.5F, 1, 1.5F));
  EXPECT_ANY_THROW(counted({2}) + counted({3}));
}

TEST(Tensor, WhatIsNotANumberComparesAsNothing) {
  const at::Tensor t = at::tensor({kNaN, 1.F, 2.F}, at::TensorOptions(at::kFloat));
  EXPECT_THAT(numbers<bool>(t > 1), ElementsAre(false, false, true));
  EXPECT_THAT(numbers<bool>(t <= 1), ElementsAre(false, true, false));
  EXPECT_THAT(numbers<bool>(t >= 1), ElementsAre(false, true, true));
  EXPECT_THAT(numbers<bool>(t.eq(t)), ElementsAre(false, true, true));
  EXPECT_THAT(numbers<bool>(t.ne(1)), ElementsAre(true, false, true));
  EXPECT_TRUE(std::isnan(t.clamp(0, 1)[0].item<float>()));
  EXPECT_TRUE(std::isnan(t.clamp_min(0)[0].item<float>()));
  EXPECT_TRUE(std::isnan(t.max().item<float>()) && std::isnan(t.min().item<float>()));
  EXPECT_THAT(numbers<bool>(at::isfinite(t)), ElementsAre(false, true, true));
  EXPECT_THAT(numbers<float>(at::where(t > 1, t, 7)), ElementsAre(7, 7, 2));
}

TEST(Tensor, SumsAndExtremesAlongAnyAxis) {
  const at::Tensor t = counted({2, 3, 2});
  EXPECT_THAT(numbers<float>(t.sum(1)), ElementsAre(6, 9, 24, 27));
  EXPECT_EQ(shape(t.mean(0, /*keepdim=*/true)), (std::vector<int64_t>{1, 3, 2}));
  EXPECT_THAT(numbers<float>(t.mean(2)), ElementsAre(0.5F, 2.5F, 4.5F, 6.5F, 8.5F, 10.5F));
  EXPECT_EQ(t.sum().item<float>(), 66);
  const at::Tensor ties = at::tensor({3.F, 1.F, 3.F, 1.F}, at::TensorOptions(at::kFloat));
  EXPECT_EQ(std::get<1>(ties.max(0)).item<int64_t>(), 0);
  EXPECT_EQ(std::get<1>(ties.min(0)).item<int64_t>(), 1);
  EXPECT_THAT(numbers<float>(std::get<0>(t.min(1))), ElementsAre(0, 1, 6, 7));
  EXPECT_THAT(numbers<float>(t.amax(0)), ElementsAre(6, 7, 8, 9, 10, 11));
  EXPECT_THAT(numbers<bool>((t > 9).any(2).view({-1})),
              ElementsAre(false, false, false, false, false, true));
  EXPECT_THAT(numbers<int64_t>((t > 9).nonzero()), ElementsAre(1, 2, 0, 1, 2, 1));
  EXPECT_FALSE((t > 99).any().item<bool>());
  EXPECT_TRUE((t >= 0).all().item<bool>());
}

TEST(Tensor, RowsAreTakenAndPut) {
  const at::Tensor t = counted({3, 2}), rows = at::tensor({2, 0, 2}, at::TensorOptions(at::kLong));
  EXPECT_THAT(numbers<float>(t.index_select(0, rows)), ElementsAre(4, 5, 0, 1, 4, 5));
  EXPECT_THAT(numbers<float>(t.t().index_select(1, rows)), ElementsAre(4, 0, 4, 5, 1, 5));
  const at::Tensor to = at::zeros({3, 2});
  to.index_copy_(0, rows.narrow(0, 0, 2), t.narrow(0, 0, 2));
  EXPECT_THAT(numbers<float>(to), ElementsAre(2, 3, 0, 0, 0, 1));
  const at::Tensor columns = at::zeros({2, 3});
  columns.index_add_(1, rows, at::ones({2, 3}));
  EXPECT_THAT(numbers<float>(columns), ElementsAre(1, 0, 2, 1, 0, 2));
  EXPECT_THAT(numbers<float>(t.gather(0, rows.view({3, 1}).expand({3, 2}))),
              ElementsAre(4, 5, 0, 1, 4, 5));
  const at::Tensor place = at::empty_like(rows.narrow(0, 0, 2));
  place.scatter_(0, at::tensor({1, 0}, at::TensorOptions(at::kLong)), at::arange(2));
  EXPECT_THAT(numbers<int64_t>(place), ElementsAre(1, 0));
  EXPECT_ANY_THROW(t.index_select(0, at::tensor({3}, at::TensorOptions(at::kLong))));
}

TEST(Tensor, StridedOperationsAgreeWithLoops) {
  Rng rng(1);
  for (int round = 0; round < 200; ++round) {
    std::vector<int64_t> axes = {0, 1, 2, 3};
    for (size_t i = axes.size() - 1; i > 0; --i) std::swap(axes[i], axes[rng.below(i + 1)]);
    at::Tensor a = counted({3, 4, 2, 5}).permute(axes);
    for (int64_t axis = 0; axis < 4; ++axis) {
      const auto begin = static_cast<int64_t>(rng.below(static_cast<uint64_t>(a.size(axis))));
      a = a.narrow(axis, begin, a.size(axis) - begin);
    }
    const at::Tensor b = a.select(0, 0).mul(2), sum = a - b, copy = at::empty_like(a.contiguous());
    copy.copy_(a);
    for (int64_t i = 0; i < a.size(0); ++i)
      for (int64_t j = 0; j < a.size(1); ++j)
        for (int64_t k = 0; k < a.size(2); ++k)
          for (int64_t l = 0; l < a.size(3); ++l) {
            const auto x = a[i][j][k][l].item<float>();
            ASSERT_EQ(copy[i][j][k][l].item<float>(), x);
            ASSERT_EQ(sum[i][j][k][l].item<float>(), x - 2 * a[0][j][k][l].item<float>());
          }
  }
}

TEST(Tensor, MistakesAreNamed) {
  EXPECT_ANY_THROW(counted({2}).item<float>());
  EXPECT_ANY_THROW(counted({2}).select(0, 2));
  EXPECT_ANY_THROW(counted({2}).narrow(0, 1, 2));
  EXPECT_ANY_THROW(counted({2}).view({3}));
  EXPECT_ANY_THROW(counted({2}).data_ptr<double>());
  EXPECT_ANY_THROW(counted({2}).expand({3}));
}

}  // namespace
}  // namespace lte
