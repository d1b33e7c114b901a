// The operators that inference alone calls and that have no twin but the CPU's, against their
// definitions in float64.
#include <array>
#include <cmath>
#include <limits>

#include "lte/ops/neighbour_max.h"
#include "lte/ops/norm_layers.h"
#include "lte/ops/patch_attention.h"
#include "lte/ops/query_decoder.h"
#include "lte/ops/spatial_order.h"
#include "tests/ops/fixtures.h"

namespace lte::ops {
namespace {

TEST(NeighbourMax, IsTheMaximumOfThePerceptronOverPairs) {
  // Sizes about a block of columns, a panel and a tile of rows.
  for (const auto& [C, O, k, m] : {std::array<int64_t, 4>{1, 1, 1, 1},
                                   {17, 5, 3, 50},
                                   {128, 128, 32, 37},
                                   {130, 257, 7, 20},
                                   {16, 32, 200, 3}}) {
    const at::Tensor dense = test::floats({60, C}, 1), center = test::floats({m, C}, 2),
                     weight = test::floats({O, C}, 3), bias = test::floats({O}, 4),
                     neighbour = test::integers(60, {m, k}, 5);
    const at::Tensor pair =
        at::gelu((dense.index_select(0, neighbour.view({-1})).view({m, k, C}) + center.unsqueeze(1))
                     .to(at::kDouble));
    const at::Tensor expected =
        at::amax(at::linear(pair, weight.to(at::kDouble), bias.to(at::kDouble)), {1});
    const at::Tensor got = neighbour_max_inference(dense, center, neighbour, weight, bias);
    EXPECT_LT(test::norm_error(got, expected), 1e-6) << "C " << C << ", O " << O << ", k " << k;
    const at::Tensor one = test::with_threads(
        1, [&] { return neighbour_max_inference(dense, center, neighbour, weight, bias); });
    EXPECT_TRUE(at::equal(got, one));
  }
}

TEST(NeighbourMax, RefusesBadInput) {
  const at::Tensor x = test::floats({4, 3}, 1), w = test::floats({3, 3}, 2),
                   b = test::floats({3}, 3);
  EXPECT_TRUE(test::throws_saying(
      [&] {
        neighbour_max_inference(x, x, test::integers(4, {4, 2}, 4).add(4), w, b);
      },
      "outside the 4 latents"));
  EXPECT_TRUE(test::throws_saying(
      [&] {
        neighbour_max_inference(x, x, test::integers(4, {4, 0}, 4), w, b);
      },
      "over no neighbours"));
  EXPECT_TRUE(test::throws_saying(
      [&] {
        neighbour_max_inference(x, x, test::integers(4, {4, 2}, 4), test::floats({3, 5}, 2), b);
      },
      "dense and center"));
}

at::Tensor attention_reference(const at::Tensor& qkv, int64_t heads) {
  const int64_t n = qkv.size(0), C = qkv.size(1) / 3;
  const at::Tensor parts = qkv.to(at::kDouble).view({n, 3, heads, C / heads}).permute({1, 2, 0, 3});
  const double scale = 1 / std::sqrt(static_cast<double>(C / heads));
  const at::Tensor weight = at::softmax(at::matmul(parts[0], parts[1].transpose(1, 2)) * scale, -1);
  return at::matmul(weight, parts[2]).transpose(0, 1).reshape({n, C});
}

TEST(PatchAttention, IsSoftmaxAttentionInOnePatch) {
  for (const auto& [n, C, heads] : {std::array<int64_t, 3>{1, 4, 1},
                                    {15, 6, 2},
                                    {16, 32, 1},
                                    {17, 40, 2},
                                    {95, 128, 4},
                                    {129, 64, 2},
                                    {300, 128, 1}}) {
    const at::Tensor qkv = 2 * test::floats({n, 3 * C}, 6);
    const at::Tensor got = patch_attention_inference(qkv, {}, {}, heads, 1);
    EXPECT_LT(test::norm_error(got, attention_reference(qkv, heads)), 2e-6)
        << "n " << n << ", C " << C << ", heads " << heads;
  }
}

TEST(PatchAttention, TakesEachPointsOwnSlotOfItsPatch) {
  // Ten points in patches of four: slots 8 and 9 are the last points, 10 and 11 repeat slots 6, 7.
  const at::Tensor order = at::tensor({3, 1, 4, 0, 5, 9, 2, 6, 8, 7}, at::kLong);
  const at::Tensor gather = at::cat({order, order.slice(0, 6, 8)});
  const at::Tensor inverse = at::empty_like(order).scatter_(0, order, at::arange(10, at::kLong));
  const at::Tensor qkv = test::floats({10, 24}, 7);
  const at::Tensor got = patch_attention_inference(qkv, gather, inverse, 2, 4);
  for (int64_t patch = 0; patch < 3; ++patch) {
    const at::Tensor slots = gather.slice(0, 4 * patch, 4 * patch + 4);
    const at::Tensor expected = attention_reference(qkv.index_select(0, slots), 2);
    const int64_t own = patch < 2 ? 4 : 2;
    EXPECT_LT(
        test::norm_error(got.index_select(0, slots.slice(0, 0, own)), expected.slice(0, 0, own)),
        1e-6);
  }
}

TEST(PatchAttention, SurvivesScoresBeyondTheRangeOfExp) {
  const at::Tensor qkv = test::floats({70, 48}, 8);
  qkv.narrow(1, 0, 32).mul_(100);
  const at::Tensor got = patch_attention_inference(qkv, {}, {}, 1, 1);
  EXPECT_TRUE(got.isfinite().all().item<bool>());
  EXPECT_LT(test::norm_error(got, attention_reference(qkv, 1)),
            2e-3);  // rounding of scores of 10^4
}

TEST(PatchAttention, IsTheSameWhetherScoresAreKnownToBeSmallOrNot) {
  // Tiles of queries whose scores are small lie beside some whose are not, and beside the border.
  const at::Tensor qkv = test::floats({300, 96}, 11);
  for (const double gain : {0.01, 1.0, 3.0, 4.0, 6.0, 12.0}) {
    at::Tensor x = qkv.clone();
    x.narrow(1, 0, 32).mul_(gain);
    x.narrow(0, 100, 100).narrow(1, 0, 32).mul_(3);
    const at::Tensor got = patch_attention_inference(x, {}, {}, 2, 1);
    EXPECT_LT(test::norm_error(got, attention_reference(x, 2)), 3e-6 * std::max(1.0, gain)) << gain;
    EXPECT_TRUE(at::equal(
        test::with_threads(1, [&] { return patch_attention_inference(x, {}, {}, 2, 1); }), got));
  }
}

TEST(PatchAttention, KeepsWhatIsNotANumberInItsHeadAndPatch) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const int64_t part : {0, 1, 2}) {  // of a query, a key, a value
    at::Tensor x = test::floats({40, 96}, 12);
    x[7][part * 32 + 3] = nan;
    const at::Tensor got = patch_attention_inference(x, {}, {}, 2, 1);
    EXPECT_TRUE(got[7].slice(0, 0, 16).isnan().any().item<bool>() || part == 1) << part;
    EXPECT_TRUE(got.slice(1, 16).isfinite().all().item<bool>()) << "the other head";
  }
}

TEST(PatchAttention, RefusesBadInput) {
  const at::Tensor qkv = test::floats({4, 12}, 9), slots = at::arange(4, at::kLong);
  EXPECT_TRUE(test::throws_saying([&] { patch_attention_inference(qkv, {}, {}, 3, 1); }, "heads"));
  EXPECT_TRUE(
      test::throws_saying([&] { patch_attention_inference(qkv, slots, {}, 1, 4); }, "go together"));
  EXPECT_TRUE(test::throws_saying([&] { patch_attention_inference(qkv, slots, slots, 1, 3); },
                                  "no whole patches"));
  EXPECT_TRUE(test::throws_saying([&] { patch_attention_inference(qkv, slots + 1, slots, 1, 4); },
                                  "entry 3 of gather"));
}

TEST(ProjectFeedForward, IsThePerceptronAfterTheSum) {
  for (const auto& [n, C, inputs, width] : {std::array<int64_t, 4>{0, 16, 16, 64},
                                            {1, 16, 16, 64},
                                            {97, 48, 32, 144},
                                            {40, 13, 7, 29},
                                            {600, 130, 140, 260}}) {
    const at::Tensor x = test::floats({n, C}, 13), a = test::floats({n, inputs}, 14),
                     W = test::floats({C, inputs}, 15), b = test::floats({C}, 16),
                     gain = test::floats({C}, 17), shift = test::floats({C}, 18),
                     W1 = test::floats({width, C}, 19), b1 = test::floats({width}, 20),
                     W2 = test::floats({C, width}, 21), b2 = test::floats({C}, 22);
    const auto wide = [](const at::Tensor& t) { return t.to(at::kDouble); };
    const at::Tensor sum = wide(x) + at::linear(wide(a), wide(W), wide(b));
    const at::Tensor normed = at::layer_norm(sum, {C}, wide(gain), wide(shift));
    const at::Tensor hidden = at::gelu(at::linear(normed, wide(W1), wide(b1)));
    const at::Tensor expected = sum + at::linear(hidden, wide(W2), wide(b2));
    const auto run = [&] {
      return project_feed_forward(x, a, {W, b}, {gain, shift}, {{W1, b1}, {W2, b2}});
    };
    const at::Tensor got = run();
    EXPECT_EQ(got.sizes(), expected.sizes());
    if (n > 0) {
      EXPECT_LT(test::norm_error(got, expected), 2e-6) << "n " << n << ", C " << C;
    }
    EXPECT_TRUE(at::equal(test::with_threads(1, run), got));
  }
}

TEST(ProjectFeedForward, RefusesBadInput) {
  const at::Tensor x = test::floats({6, 4}, 1), v = test::floats({4}, 2),
                   square = test::floats({4, 4}, 3);
  const auto refused = [&](const at::Tensor& attended, const at::Tensor& W, const char* words) {
    return test::throws_saying(
        [&] {
          project_feed_forward(x, attended, {W, v}, {v, v}, {{square, v}, {square, v}});
        },
        words);
  };
  EXPECT_TRUE(refused(test::floats({5, 4}, 4), square, "attended must be [6, 4]"));
  EXPECT_TRUE(refused(test::floats({6, 3}, 4), square, "attended must be [6, 4]"));
  EXPECT_TRUE(refused(x, test::floats({5, 4}, 5), "bias"));
  EXPECT_TRUE(test::throws_saying(
      [&] {
        project_feed_forward(x, x, {square, v}, {v, v},
                             {{test::floats({8, 4}, 3), test::floats({8}, 4)},
                              {test::floats({5, 8}, 5), test::floats({5}, 6)}});
      },
      "must have 4 outputs"));
}

TEST(SpatialOrder, IsAPermutationThatKeepsNeighboursTogether) {
  for (const auto& [name, points] : test::awkward_points(3000)) {
    const at::Tensor order = spatial_order(points);
    EXPECT_TRUE(at::equal(std::get<0>(order.sort()), at::arange(3000, at::kLong))) << name;
  }
  EXPECT_EQ(spatial_order(at::empty({0, 3})).size(0), 0);
  const at::Tensor points = test::uniform({3000, 3}, 10);
  const auto path = [](const at::Tensor& p) {
    return (p.slice(0, 1) - p.slice(0, 0, -1)).norm(2, 1).sum().item<double>();
  };
  EXPECT_LT(path(points.index_select(0, spatial_order(points))), 0.2 * path(points));
  EXPECT_TRUE(test::throws_saying(
      [&] { spatial_order(points * std::numeric_limits<float>::infinity()); }, "not finite"));
}

}  // namespace
}  // namespace lte::ops
