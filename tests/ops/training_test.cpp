// The operators that training runs in one piece on the CPU, and their gradients, against their
// definitions in float64.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "lte/ops/neighbour_max.h"
#include "lte/ops/neighbour_sums.h"
#include "lte/ops/norm_layers.h"
#include "lte/ops/query_decoder.h"
#include "tests/ops/decoder_fixture.h"
#include "tests/ops/fixtures.h"
#include "tests/ops/training_fixture.h"

namespace lte::ops {
namespace {

using test::is_of_rounding;
using test::leaf;
using test::wide_leaf;

TEST(TrainedNeighbourMax, IsTheMaximumWithItsGradients) {
  // Sizes about a block of columns, a panel, a tile of rows and a part of them.
  for (const auto& [C, O, k, m] : {std::array<int64_t, 4>{16, 1, 1, 1},
                                   {16, 5, 3, 50},
                                   {48, 48, 32, 37},
                                   {144, 131, 7, 20},
                                   {32, 32, 5, 1100}}) {
    const std::vector<at::Tensor> in = {
        test::normal({60, C}, 1, at::kFloat), test::normal({m, C}, 2, at::kFloat),
        test::normal({O, C}, 3, at::kFloat), test::normal({O}, 4, at::kFloat)};
    const at::Tensor neighbour = test::integers(60, {m, k}, 5), weight = test::normal({m, O}, 6);
    std::vector<at::Tensor> exact, single;
    for (const at::Tensor& t : in) {
      exact.push_back(wide_leaf(t));
      single.push_back(leaf(t));
    }
    const at::Tensor pair = at::gelu(
        exact[0].index_select(0, neighbour.view({-1})).view({m, k, C}) + exact[1].unsqueeze(1));
    // Ties, of neighbours that come twice, go to the first.
    const at::Tensor expected = std::get<0>(at::linear(pair, exact[2], exact[3]).max(1));
    const at::Tensor got = neighbour_max(single[0], single[1], neighbour, {single[2], single[3]});
    EXPECT_LT(test::norm_error(got.detach(), expected.detach()), 1e-6);
    expected.backward(weight);
    got.backward(weight.to(at::kFloat));
    for (size_t i = 0; i < in.size(); ++i) {
      EXPECT_LT(test::norm_error(single[i].grad(), exact[i].grad()), 2e-6)
          << "argument " << i << " at C " << C << ", O " << O << ", k " << k << ", m " << m;
    }
  }
}

/// `w` as mixed precision reads it.
LinearWeights with_rounding(const LinearWeights& w) {
  return {w.weight, w.bias, w.weight.detach().to(at::kBFloat16)};
}

TEST(TrainedNeighbourMax, InMixedPrecisionIsThatOfInferenceInBfloat16) {
  const at::Tensor neighbour = test::integers(60, {300, 5}, 5),
                   grad = test::normal({300, 32}, 6, at::kFloat);
  const std::vector<at::Tensor> in = {
      leaf(test::normal({60, 48}, 1, at::kFloat)), leaf(test::normal({300, 48}, 2, at::kFloat)),
      leaf(test::normal({32, 48}, 3, at::kFloat)), leaf(test::normal({32}, 4, at::kFloat))};
  const LinearWeights layer = with_rounding({in[2], in[3]});
  const at::Tensor got = neighbour_max(in[0], in[1], neighbour, layer);
  EXPECT_TRUE(at::equal(
      got.detach(), neighbour_max_inference(in[0], in[1], neighbour, layer.rounded, layer.bias)));
  got.backward(grad);
  const at::Tensor by_weight = in[2].grad().clone();
  EXPECT_EQ(by_weight.scalar_type(), at::kFloat);
  in[2].mutable_grad().reset();
  neighbour_max(in[0], in[1], neighbour, {in[2], in[3]}).backward(grad);
  // Where two pairs are as large but for rounding, another one has the gradient.
  EXPECT_LT(test::norm_error(by_weight, in[2].grad()), 0.2);
  EXPECT_GT(test::norm_error(by_weight, in[2].grad()), 0);
}

TEST(TrainedNeighbourMax, DoesNotDependOnThreads) {
  const at::Tensor neighbour = test::integers(60, {2100, 5}, 5);
  const auto gradient = [&](int threads) {
    return test::with_threads(threads, [&] {
      const at::Tensor dense = leaf(test::normal({60, 16}, 1, at::kFloat)),
                       center = test::normal({2100, 16}, 2, at::kFloat),
                       weight = leaf(test::normal({16, 16}, 3, at::kFloat));
      neighbour_max(dense, center, neighbour, {weight, test::normal({16}, 4, at::kFloat)})
          .square()
          .sum()
          .backward();
      return at::cat({dense.grad(), weight.grad()});
    });
  };
  EXPECT_TRUE(at::equal(gradient(1), gradient(3)));
}

TEST(TrainedNeighbourMax, RefusesBadInput) {
  const at::Tensor x = test::normal({4, 3}, 1, at::kFloat), w = test::normal({3, 3}, 2, at::kFloat),
                   b = test::normal({3}, 3, at::kFloat);
  EXPECT_TRUE(test::throws_saying(
      [&] {
        neighbour_max(x, x, test::integers(4, {4, 2}, 4), {w, b});
      },
      "in multiples of 16"));
}

/// Queries about latents, and all that a decoder reads.
struct DecoderCase {
  int64_t Q, K, C, L, hidden;
  bool normals;

  static at::Tensor unit(int64_t count, uint64_t seed) {
    const at::Tensor v = test::normal({count, 3}, seed, at::kFloat);
    return v / v.norm(2, {1}, /*keepdim=*/true);
  }
  QueryNeighbourhood near() const {
    QueryNeighbourhood near{test::uniform({Q, 3}, 11), test::uniform({kLatents, 3}, 12),
                            test::integers(kLatents, {Q, K}, 13), 3.0, 2.0};
    if (normals) {
      near.normal = unit(Q, 14);
      near.anchor_normal = unit(kLatents, 15);
    }
    return near;
  }
  at::Tensor attributes() const { return test::normal({Q, 9}, 16, at::kFloat); }
  at::Tensor keys(uint64_t seed = 17) const {
    return test::normal({L, kLatents, C}, seed, at::kFloat);
  }
  DecoderWeights weights() const {
    return test::decoder_weights(9, C, L, hidden, normals ? kNormalInputs : kOffsetInputs);
  }

  static constexpr int64_t kLatents = 70;
};

/// keys and values as the operator's table, differentiable.
at::Tensor table_of(const at::Tensor& keys, const at::Tensor& values) {
  const int64_t L = keys.size(0), m = keys.size(1), C = keys.size(2);
  return at::stack({keys, values})
      .view({2, L, m, C / 16, 16})
      .permute({2, 3, 1, 0, 4})
      .contiguous();
}

TEST(TrainedQueryDecoder, HasTheGradientsOfItsDefinition) {
  for (const DecoderCase& c : {DecoderCase{1, 1, 16, 1, 16, false},
                               {50, 5, 16, 2, 40, true},
                               {97, 32, 48, 3, 192, true},
                               {20, 150, 32, 1, 128, false},  // more neighbours than a panel has
                               {30, 7, 144, 2, 150, true},    // channels of two panels
                               {1030, 3, 16, 1, 20, false}}) {
    const QueryNeighbourhood near = c.near();
    const at::Tensor attributes = c.attributes(), cotangent = test::normal({c.Q, 3}, 19);
    std::vector<at::Tensor> exact = {wide_leaf(c.keys()), wide_leaf(c.keys(18))},
                            single = {leaf(c.keys()), leaf(c.keys(18))};
    for (const at::Tensor& t : c.weights().to_list()) {
      exact.push_back(wide_leaf(t));
      single.push_back(leaf(t));
    }
    const auto weights = [&](const std::vector<at::Tensor>& of) {
      return DecoderWeights::from_list(at::TensorList(of).slice(2), c.L);
    };
    const at::Tensor expected =
        test::decoder_reference(attributes, near, exact[0], exact[1], weights(exact));
    const at::Tensor got =
        query_decoder(attributes, near, table_of(single[0], single[1]), weights(single));
    EXPECT_LT(test::norm_error(got.detach(), expected.detach()), 1e-5);
    expected.backward(cotangent);
    got.backward(cotangent.to(at::kFloat));
    for (size_t i = 0; i < exact.size(); ++i) {
      EXPECT_LT(test::norm_error(single[i].grad(), exact[i].grad()), 1e-4)
          << "tensor " << i << " of Q " << c.Q << ", K " << c.K << ", C " << c.C << ", L " << c.L;
    }
  }
}

TEST(TrainedQueryDecoder, DoesNotDependOnThreads) {
  const DecoderCase c{2100, 4, 16, 2, 32, false};
  const auto gradients = [&](int threads) {
    return test::with_threads(threads, [&] {
      std::vector<at::Tensor> all = {leaf(table_of(c.keys(), c.keys(18)))};
      for (const at::Tensor& t : c.weights().to_list()) all.push_back(leaf(t));
      query_decoder(c.attributes(), c.near(), all[0],
                    DecoderWeights::from_list(at::TensorList(all).slice(1), c.L))
          .square()
          .sum()
          .backward();
      for (at::Tensor& t : all) t = t.grad().flatten();
      return at::cat(all);
    });
  };
  EXPECT_TRUE(at::equal(gradients(1), gradients(3)));
}

TEST(TrainedQueryDecoder, AnswersAsInInference) {
  const DecoderCase c{130, 8, 32, 2, 64, true};
  const at::Tensor table = neighbour_table(c.keys(), c.keys(18));
  EXPECT_TRUE(at::equal(query_decoder(c.attributes(), c.near(), table, c.weights()),
                        query_decoder_inference(c.attributes(), c.near(), table, c.weights())));
}

TEST(TrainedQueryDecoder, InMixedPrecisionAnswersAsInferenceInBfloat16) {
  for (const DecoderCase& c : {DecoderCase{97, 16, 48, 3, 192, true}, {70, 9, 16, 2, 32, false}}) {
    const at::Tensor table = neighbour_table(c.keys(), c.keys(18)),
                     grad = test::normal({c.Q, 3}, 19, at::kFloat);
    const auto gradients = [&](bool rounds, int threads) {
      std::vector<at::Tensor> all = {leaf(table)};
      for (const at::Tensor& t : c.weights().to_list()) all.push_back(leaf(t));
      DecoderWeights weights = DecoderWeights::from_list(at::TensorList(all).slice(1), c.L);
      if (rounds) {
        weights.point.output = with_rounding(weights.point.output);
        weights.gamma.output = with_rounding(weights.gamma.output);
        weights.head = {with_rounding(weights.head.hidden), with_rounding(weights.head.output)};
        for (LayerWeights& layer : weights.layers) {
          layer.query = with_rounding(layer.query);
          layer.output = with_rounding(layer.output);
          layer.ffn = {with_rounding(layer.ffn.hidden), with_rounding(layer.ffn.output)};
        }
      }
      const at::Tensor got = test::with_threads(threads, [&] {
        const at::Tensor out = query_decoder(c.attributes(), c.near(), all[0], weights);
        out.backward(grad);
        return out.detach();
      });
      const DecoderWeights half = rounds ? test::in_bf16(c.weights()) : c.weights();
      EXPECT_TRUE(at::equal(got, query_decoder_inference(c.attributes(), c.near(), table, half)));
      for (at::Tensor& t : all) t = t.grad();
      return all;
    };
    const std::vector<at::Tensor> exact = gradients(false, 1), got = gradients(true, 1),
                                  threaded = gradients(true, 3);
    for (size_t i = 0; i < exact.size(); ++i) {
      EXPECT_TRUE(is_of_rounding(test::norm_error(got[i], exact[i]))) << "tensor " << i;
      EXPECT_TRUE(at::equal(got[i], threaded[i])) << "tensor " << i;
    }
  }
}

/// Weights of a norm, of a layer after it, of one after that, and of a projection.
std::vector<at::Tensor> block_weights(int64_t C, int64_t width, int64_t outputs) {
  return {test::normal({C}, 22, at::kFloat),
          test::normal({C}, 23, at::kFloat),
          test::normal({width, C}, 24, at::kFloat),
          test::normal({width}, 25, at::kFloat),
          test::normal({outputs, width}, 26, at::kFloat),
          test::normal({outputs}, 27, at::kFloat),
          test::normal({outputs, C}, 29, at::kFloat),
          test::normal({outputs}, 30, at::kFloat)};
}

using Formula = std::function<at::Tensor(const std::vector<at::Tensor>&)>;

/// The largest error of `got`'s values and gradients by its arguments against `exact`'s in float64.
double worst_error(const std::vector<at::Tensor>& in, const Formula& got, const Formula& exact) {
  std::vector<at::Tensor> single, wide;
  for (const at::Tensor& t : in) {
    single.push_back(leaf(t));
    wide.push_back(wide_leaf(t));
  }
  const at::Tensor y = got(single), expected = exact(wide);
  const at::Tensor cotangent = test::normal(expected.sizes(), 28);
  y.backward(cotangent.to(at::kFloat));
  expected.backward(cotangent);
  double worst = test::norm_error(y.detach(), expected.detach());
  for (size_t i = 0; i < in.size(); ++i) {
    worst = std::max(worst, test::norm_error(single[i].grad(), wide[i].grad()));
  }
  return worst;
}

at::Tensor normed_rows(const at::Tensor& x, const at::Tensor& gain, const at::Tensor& bias) {
  return at::layer_norm(x, {x.size(1)}, gain, bias);
}

/// project_feed_forward() of x, its eight weights, and what is attended to.
at::Tensor exact_feed_forward(const std::vector<at::Tensor>& t) {
  const at::Tensor h = t[0] + at::linear(t[9], t[7], t[8]);
  return h + at::linear(at::gelu(at::linear(normed_rows(h, t[1], t[2]), t[3], t[4])), t[5], t[6]);
}

TEST(TrainedNormLayers, HaveTheGradientsOfTheirDefinitions) {
  for (const auto& [n, C, width] : {std::array<int64_t, 3>{1, 16, 64},
                                    {97, 48, 144},
                                    {40, 13, 29},
                                    {30, 130, 260},
                                    {1100, 16, 20}}) {
    std::vector<at::Tensor> in = {test::normal({n, C}, 21, at::kFloat)};
    for (const at::Tensor& t : block_weights(C, width, C)) in.push_back(t);
    in.push_back(test::normal({n, C}, 31, at::kFloat));
    const Formula feed = [](const std::vector<at::Tensor>& t) {
      return project_feed_forward(t[0], t[9], {t[7], t[8]}, {t[1], t[2]},
                                  {{t[3], t[4]}, {t[5], t[6]}});
    };
    EXPECT_LT(worst_error(in, feed, exact_feed_forward), 5e-6) << "n " << n << ", C " << C;
    in.resize(5);
    const Formula linear = [](const std::vector<at::Tensor>& t) {
      return norm_linear(t[0], {t[1], t[2]}, {t[3], t[4]});
    };
    const Formula linear_exact = [](const std::vector<at::Tensor>& t) {
      return at::linear(normed_rows(t[0], t[1], t[2]), t[3], t[4]);
    };
    EXPECT_LT(worst_error(in, linear, linear_exact), 5e-6) << "n " << n << ", C " << C;
  }
}

/// r + N(W x + b) of x, W, b, gain, bias, share and r, where r and then share may be left out.
at::Tensor exact_linear_norm(const std::vector<at::Tensor>& t, const std::vector<int64_t>& counts) {
  at::Tensor y = at::linear(t[0], t[1], t[2]);
  if (t.size() > 5) {
    std::vector<at::Tensor> means;
    for (const at::Tensor& scene : y.split_with_sizes(counts))
      means.push_back(scene.mean(0, /*keepdim=*/true).expand_as(scene));
    y = y - at::cat(means) * t[5];
  }
  const at::Tensor normed = normed_rows(y, t[3], t[4]);
  return t.size() > 6 ? t[6] + normed : normed;
}

TEST(TrainedLinearNorm, HasTheGradientsOfItsDefinition) {
  struct Case {
    std::vector<int64_t> counts;
    int64_t C, O;
  };
  for (const auto& [counts, C, O] : {Case{{1}, 16, 16},
                                     {{97}, 48, 32},
                                     {{40, 0, 130}, 13, 29},
                                     {{96, 192}, 130, 144},
                                     {{1100, 300}, 16, 20}}) {
    const int64_t n = std::accumulate(counts.begin(), counts.end(), int64_t{0});
    std::vector<at::Tensor> in = {
        test::normal({n, C}, 41, at::kFloat), test::normal({O, C}, 42, at::kFloat),
        test::normal({O}, 43, at::kFloat),    test::normal({O}, 44, at::kFloat),
        test::normal({O}, 45, at::kFloat),    test::normal({O}, 46, at::kFloat),
        test::normal({n, O}, 47, at::kFloat)};
    if (n == 1) in[5].fill_(0.25);  // a row that is its own mean would be nothing
    for (const size_t arguments : {7, 6, 5}) {
      in.resize(arguments);
      const Formula got = [&](const std::vector<at::Tensor>& t) {
        return linear_norm(t[0], {t[1], t[2]}, {{t[3], t[4]}, t.size() > 5 ? t[5] : at::Tensor()},
                           counts, t.size() > 6 ? t[6] : at::Tensor());
      };
      const Formula exact = [&](const std::vector<at::Tensor>& t) {
        return exact_linear_norm(t, counts);
      };
      EXPECT_LT(worst_error(in, got, exact), 1e-5) << "n " << n << ", C " << C << ", " << arguments;
    }
  }
}

TEST(TrainedLinearNorm, DoesNotDependOnThreadsAndRoundsInMixedPrecision) {
  const std::vector<int64_t> counts = {700, 430};
  const std::vector<at::Tensor> in = {
      test::normal({1130, 48}, 41, at::kFloat), test::normal({32, 48}, 42, at::kFloat),
      test::normal({32}, 43, at::kFloat),       test::normal({32}, 44, at::kFloat),
      test::normal({32}, 45, at::kFloat),       test::normal({32}, 46, at::kFloat),
      test::normal({1130, 32}, 47, at::kFloat)};
  const auto layer = [&](const std::vector<at::Tensor>& t, bool rounds) {
    const LinearWeights linear = {t[1], t[2]};
    return linear_norm(t[0], rounds ? with_rounding(linear) : linear, {{t[3], t[4]}, t[5]}, counts,
                       t[6]);
  };
  const auto gradients = [&](int threads) {
    return test::with_threads(threads, [&] {
      std::vector<at::Tensor> all;
      for (const at::Tensor& t : in) all.push_back(leaf(t));
      layer(all, false).square().sum().backward();
      for (at::Tensor& t : all) t = t.grad().flatten();
      return at::cat(all);
    });
  };
  EXPECT_TRUE(at::equal(gradients(1), gradients(3)));
  const Formula rounded = [&](const std::vector<at::Tensor>& t) { return layer(t, true); };
  const Formula exact = [&](const std::vector<at::Tensor>& t) {
    return exact_linear_norm(t, counts);
  };
  EXPECT_TRUE(is_of_rounding(worst_error(in, rounded, exact)));
}

TEST(TrainedNormLayers, InMixedPrecisionRoundWhatProductsRead) {
  for (const auto& [n, C] : {std::array<int64_t, 2>{97, 48}, {40, 16}, {1100, 32}, {30, 144}}) {
    std::vector<at::Tensor> in = {test::normal({n, C}, 21, at::kFloat)};
    for (const at::Tensor& t : block_weights(C, 4 * C, C)) in.push_back(t);
    in.push_back(test::normal({n, C}, 31, at::kFloat));
    const Formula feed = [](const std::vector<at::Tensor>& t) {
      return project_feed_forward(t[0], t[9], with_rounding({t[7], t[8]}), {t[1], t[2]},
                                  {with_rounding({t[3], t[4]}), with_rounding({t[5], t[6]})});
    };
    EXPECT_TRUE(is_of_rounding(worst_error(in, feed, exact_feed_forward)))
        << "n " << n << ", C " << C;
    in.resize(5);
    const Formula linear = [](const std::vector<at::Tensor>& t) {
      return norm_linear(t[0], {t[1], t[2]}, with_rounding({t[3], t[4]}));
    };
    const auto round = [](const at::Tensor& t) {
      return t.detach().to(at::kBFloat16).to(at::kDouble);
    };
    std::vector<at::Tensor> single, wide;
    for (const at::Tensor& t : in) {
      single.push_back(leaf(t));
      wide.push_back(wide_leaf(t));
    }
    const at::Tensor grad = test::normal({n, 4 * C}, 28, at::kFloat), out = linear(single),
                     x = normed_rows(wide[0], wide[1], wide[2]);
    const at::Tensor exact = at::linear(round(x), round(wide[3]), wide[4].detach());
    out.backward(grad);
    x.backward(at::mm(round(grad), round(wide[3])));
    EXPECT_LT(test::norm_error(out.detach(), exact), 1e-4);
    for (const size_t i : {0, 1, 2}) {
      EXPECT_LT(test::norm_error(single[i].grad(), wide[i].grad()), 1e-4) << "argument " << i;
    }
    EXPECT_LT(test::norm_error(single[3].grad(), at::mm(round(grad).t(), round(x))), 1e-4);
    EXPECT_LT(test::norm_error(single[4].grad(), grad.to(at::kDouble).sum(0)), 1e-6)
        << "not rounded";
  }
}

TEST(TrainedNormLayers, RefuseBadInput) {
  const at::Tensor x = test::normal({6, 4}, 1, at::kFloat), v = test::normal({4}, 2, at::kFloat);
  EXPECT_TRUE(test::throws_saying(
      [&] {
        norm_linear(x, {v, v}, {test::normal({3, 5}, 3, at::kFloat), v});
      },
      "weight [O, C]"));
  const at::Tensor square = test::normal({4, 4}, 3, at::kFloat);
  EXPECT_TRUE(test::throws_saying(
      [&] {
        linear_norm(x, {square, v}, {{v, v}, v}, {2, 3});
      },
      "scenes of 5 rows in all for 6"));
  EXPECT_TRUE(test::throws_saying(
      [&] {
        linear_norm(x, {square, v}, {{v, v}, v}, {6}, x.narrow(0, 0, 5));
      },
      "residual must be [6, 4]"));
  EXPECT_TRUE(test::throws_saying(
      [&] {
        linear_norm(x, {square, v}, {{v, v}, v.narrow(0, 0, 3)}, {6});
      },
      "a norm must be [4]"));
}

}  // namespace
}  // namespace lte::ops
