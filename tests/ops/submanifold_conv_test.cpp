#include "lte/ops/submanifold_conv.h"

#include <array>
#include <map>
#include <vector>

#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "lte/ops/dispatch.h"
#include "tests/ops/fixtures.h"
#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

using test::throws_saying;

/// `count` distinct cells of a cube of `edge`, in random order.
at::Tensor distinct_cells(int64_t count, int64_t edge, uint64_t seed) {
  const at::Tensor code =
      test::uniform({edge * edge * edge}, seed).argsort().narrow(0, 0, count).to(at::kInt);
  const auto e = static_cast<int>(edge);
  return at::stack({code.div(e * e, "floor"), code.div(e, "floor").remainder(e), code.remainder(e)},
                   1)
      .contiguous();
}

/// Dense convolution of the scattered input, read back at the cells.
at::Tensor dense(const at::Tensor& cells, const at::Tensor& input, const at::Tensor& weight,
                 const at::Tensor& bias, int64_t kernel, int64_t edge) {
  const at::Tensor flat =
      cells.to(at::kLong).mul(at::tensor({edge * edge, edge, int64_t{1}})).sum(1);
  const at::Tensor volume = at::zeros({edge * edge * edge, input.size(1)}, input.options())
                                .index_add(0, flat, input)
                                .t()
                                .reshape({1, input.size(1), edge, edge, edge});
  const at::Tensor taps = weight.view({kernel, kernel, kernel, weight.size(1), weight.size(2)})
                              .permute({4, 3, 0, 1, 2});
  return at::conv3d(volume, taps, bias, 1, kernel / 2)
      .reshape({weight.size(2), edge * edge * edge})
      .t()
      .index_select(0, flat);
}

/// Every pair by looking up every tap in a map.
std::vector<std::array<int64_t, 3>> expected_pairs(const at::Tensor& cells, int64_t kernel) {
  std::map<std::array<int64_t, 3>, int64_t> first;
  const at::Tensor wide = cells.to(at::kLong);
  const auto* c = wide.const_data_ptr<int64_t>();
  for (int64_t i = 0; i < cells.size(0); ++i)
    first.insert({{c[3 * i], c[3 * i + 1], c[3 * i + 2]}, i});
  std::vector<std::array<int64_t, 3>> pairs;  // tap, output, input
  for (int64_t tap = 0; tap < kernel * kernel * kernel; ++tap) {
    const int64_t d[3] = {tap / (kernel * kernel) - kernel / 2, tap / kernel % kernel - kernel / 2,
                          tap % kernel - kernel / 2};
    for (int64_t i = 0; i < cells.size(0); ++i) {
      if (d[0] == 0 && d[1] == 0 && d[2] == 0) {
        pairs.push_back({tap, i, i});
        continue;
      }
      const auto found = first.find({c[3 * i] + d[0], c[3 * i + 1] + d[1], c[3 * i + 2] + d[2]});
      if (found != first.end()) pairs.push_back({tap, i, found->second});
    }
  }
  return pairs;
}

class ConvolutionPairs : public test::PerDevice {
 protected:
  /// The pairs of cells on this device, on the CPU.
  std::pair<at::Tensor, at::Tensor> pairs_of(const at::Tensor& cells, int64_t kernel) const {
    const auto [pairs, tap_begin] = convolution_pairs(put(cells), kernel);
    EXPECT_EQ(pairs.device().type(), GetParam());
    EXPECT_TRUE(tap_begin.is_cpu());
    return {pairs.cpu(), tap_begin};
  }

  void expect_pairs(const at::Tensor& cells, int64_t kernel, const std::string& what) const {
    const auto [pairs, tap_begin] = pairs_of(cells, kernel);
    const auto expected = expected_pairs(cells, kernel);
    ASSERT_EQ(pairs.size(1), static_cast<int64_t>(expected.size())) << what;
    ASSERT_EQ(tap_begin.size(0), kernel * kernel * kernel + 1) << what;
    const auto* rows = pairs.const_data_ptr<int32_t>();
    const auto* begin = tap_begin.const_data_ptr<int64_t>();
    for (int64_t i = 0; i < pairs.size(1); ++i) {
      const auto [tap, output, input] = expected[i];
      ASSERT_TRUE(begin[tap] <= i && i < begin[tap + 1]) << what << ", pair " << i;
      ASSERT_EQ(rows[i], output) << what << ", pair " << i;
      ASSERT_EQ(rows[pairs.size(1) + i], input) << what << ", pair " << i;
    }
  }
};
LTE_FOR_EACH_DEVICE(ConvolutionPairs);

TEST_P(ConvolutionPairs, MatchALookUpOfEveryTap) {
  for (const int64_t kernel : {1, 3, 5}) {
    for (const int64_t N : {0, 1, 2, 511, 512, 513}) {
      expect_pairs(distinct_cells(N, 9, 21), kernel, "N " + std::to_string(N));
    }
    expect_pairs(test::integers(6, {400, 3}, 22, at::kInt), kernel, "with shared cells");
  }
}

TEST_P(ConvolutionPairs, DoNotWrapAroundAtTheEndsOfTheRange) {
  const int32_t top = (1 << 20) - 1;
  const at::Tensor corners =
      at::cartesian_prod({at::tensor({0, top}, at::kInt), at::tensor({0, top}, at::kInt),
                          at::tensor({0, top}, at::kInt)})
          .contiguous();
  EXPECT_EQ(pairs_of(corners, 5).first.size(1), 8);  // each corner itself alone
  const at::Tensor edge = at::tensor({0, 0, top, 0, 1, 0}, at::kInt).view({2, 3});
  EXPECT_EQ(pairs_of(edge, 3).first.size(1), 2);
}

TEST_P(ConvolutionPairs, RefuseBadInput) {
  const auto refused = [](const at::Tensor& cells, int64_t kernel, const char* words) {
    return throws_saying([&] { convolution_pairs(cells, kernel); }, words);
  };
  const at::Tensor good = put(at::zeros({4, 3}, at::kInt));
  EXPECT_TRUE(refused(good, 2, "kernel must be odd"));
  EXPECT_TRUE(refused(good, -1, "kernel must be odd"));
  EXPECT_TRUE(refused(good, 33, "kernel must be odd"));
  EXPECT_TRUE(refused(good.to(at::kLong), 3, "Int"));
  EXPECT_TRUE(refused(good.narrow(1, 0, 2), 3, "[N, 3]"));
  EXPECT_TRUE(refused(put(at::zeros({3, 4}, at::kInt)).t(), 3, "contiguous"));
  at::Tensor bad = good.clone();
  bad[3][2] = 1 << 20;
  EXPECT_TRUE(refused(bad, 3, "row 3 of cells"));
  bad[1][1] = -1;
  EXPECT_TRUE(refused(bad, 3, "row 1 of cells"));
}

class SubmanifoldConv : public test::PerDevice {};
LTE_FOR_EACH_DEVICE(SubmanifoldConv);

TEST_P(SubmanifoldConv, EqualsDenseConvolutionWithItsGradients) {
  for (const int64_t kernel : {1, 3, 5}) {
    for (const int64_t N : {1, 511, 512, 513, 700}) {
      const int64_t Cin = 7, Cout = 5, edge = 9;
      const at::Tensor cells = distinct_cells(N, edge, 23);
      const auto [pairs, tap_begin] = convolution_pairs(put(cells), kernel);
      std::vector<at::Tensor> leaves[2];
      at::Tensor outputs[2];
      for (int version = 0; version < 2; ++version) {
        leaves[version] = {test::normal({N, Cin}, 24).requires_grad_(),
                           test::normal({kernel * kernel * kernel, Cin, Cout}, 25).requires_grad_(),
                           test::normal({Cout}, 26).requires_grad_()};
        const auto& [input, weight, bias] =
            std::tie(leaves[version][0], leaves[version][1], leaves[version][2]);
        outputs[version] =
            version == 0
                ? submanifold_conv(put(input), put(weight), put(bias), pairs, tap_begin).cpu()
                : dense(cells, input, weight, bias, kernel, edge);
        (outputs[version] * test::normal({N, Cout}, 27)).sum().backward();
      }
      EXPECT_LT(test::relative_error(outputs[0], outputs[1].detach()), 1e-12);
      for (int i = 0; i < 3; ++i) {
        EXPECT_LT(test::relative_error(leaves[0][i].grad(), leaves[1][i].grad()), 1e-12)
            << "gradient " << i << ", kernel " << kernel << ", N " << N;
      }
    }
  }
}

TEST_P(SubmanifoldConv, Float32IsCloseToFloat64) {
  const at::Tensor cells = distinct_cells(2000, 16, 28);
  const auto [pairs, tap_begin] = convolution_pairs(put(cells), 3);
  const at::Tensor input = put(test::normal({2000, 64}, 29)),
                   weight = put(test::normal({27, 64, 48}, 30)), bias = put(test::normal({48}, 31));
  const at::Tensor exact = submanifold_conv(input, weight, bias, pairs, tap_begin);
  const at::Tensor single = submanifold_conv(input.to(at::kFloat), weight.to(at::kFloat),
                                             bias.to(at::kFloat), pairs, tap_begin);
  EXPECT_LT(test::relative_error(single, exact), tolerance(1e-5));
}

TEST_P(SubmanifoldConv, Float32GradientsAreCloseToFloat64) {
  struct Case {
    int64_t N, edge, kernel, inputs, outputs;
    bool shared;
  };
  // One pair a tap and hundreds, channels of one panel and of several, cells with several points.
  for (const Case& c : {Case{1, 4, 3, 16, 16, false}, Case{2000, 16, 3, 64, 48, false},
                        Case{700, 9, 5, 32, 32, false}, Case{500, 5, 3, 160, 144, true}}) {
    const at::Tensor cells =
        c.shared ? test::integers(c.edge, {c.N, 3}, 28, at::kInt) : distinct_cells(c.N, c.edge, 28);
    const auto [pairs, tap_begin] = convolution_pairs(put(cells), c.kernel);
    const int64_t taps = c.kernel * c.kernel * c.kernel;
    std::vector<at::Tensor> gradients[2];
    for (const auto dtype : {at::kDouble, at::kFloat}) {
      at::Tensor input = put(test::normal({c.N, c.inputs}, 29).to(dtype)).requires_grad_(),
                 weight =
                     put(test::normal({taps, c.inputs, c.outputs}, 30).to(dtype)).requires_grad_();
      const at::Tensor probe = put(test::normal({c.N, c.outputs}, 31).to(dtype));
      (submanifold_conv(input, weight, {}, pairs, tap_begin) * probe).sum().backward();
      gradients[dtype == at::kFloat] = {input.grad(), weight.grad()};
    }
    for (const size_t i : {0, 1}) {
      EXPECT_LT(test::relative_error(gradients[1][i], gradients[0][i]), tolerance(1e-5))
          << "gradient " << i << " of " << c.N << " points, " << c.inputs << " channels";
    }
  }
}

TEST_P(SubmanifoldConv, GradientsAreFiniteDifferencesWithSharedCells) {
  const at::Tensor cells = test::integers(3, {30, 3}, 32, at::kInt);
  const auto [pairs, tap_begin] = convolution_pairs(put(cells), 3);
  const at::Tensor input = test::normal({30, 2}, 33).requires_grad_(),
                   weight = test::normal({27, 2, 3}, 34).requires_grad_(),
                   bias = test::normal({3}, 35).requires_grad_();
  const at::Tensor probe = test::normal({30, 3}, 36);
  const auto loss = [&](const at::Tensor& x, const at::Tensor& w, const at::Tensor& b) {
    return (submanifold_conv(put(x), put(w), put(b), pairs, tap_begin).cpu() * probe).sum();
  };
  loss(input, weight, bias).backward();
  const auto by_input =
      test::numerical_gradient([&](auto& x) { return loss(x, weight, bias); }, input);
  const auto by_weight =
      test::numerical_gradient([&](auto& w) { return loss(input, w, bias); }, weight);
  const auto by_bias =
      test::numerical_gradient([&](auto& b) { return loss(input, weight, b); }, bias);
  EXPECT_LT(test::relative_error(input.grad(), by_input), 1e-8);
  EXPECT_LT(test::relative_error(weight.grad(), by_weight), 1e-8);
  EXPECT_LT(test::relative_error(bias.grad(), by_bias), 1e-8);
}

TEST_P(SubmanifoldConv, WorksWithoutBiasAndWithoutPoints) {
  const at::Tensor weight = put(at::ones({27, 4, 6})), none;
  const auto [pairs, tap_begin] = convolution_pairs(put(at::empty({0, 3}, at::kInt)), 3);
  const at::Tensor nothing =
      submanifold_conv(put(at::empty({0, 4})), weight, none, pairs, tap_begin);
  EXPECT_EQ(nothing.sizes(), (at::IntArrayRef{0, 6}));
  const auto [one, one_begin] = convolution_pairs(put(at::zeros({1, 3}, at::kInt)), 3);
  const at::Tensor sum = submanifold_conv(put(at::ones({1, 4})), weight, none, one, one_begin);
  EXPECT_TRUE(at::equal(sum.cpu(), at::full({1, 6}, 4.0f)));
}

TEST_P(SubmanifoldConv, DoesNotDependOnThreadsAndRepeatsItsBits) {
  const at::Tensor cells = distinct_cells(3000, 20, 37);
  const auto [pairs, tap_begin] = convolution_pairs(put(cells), 3);
  const auto run = [&, &pairs = pairs, &tap_begin = tap_begin] {
    const at::Tensor input = put(test::normal({3000, 64}, 38, at::kFloat)).requires_grad_(),
                     weight = put(test::normal({27, 64, 64}, 39, at::kFloat)).requires_grad_();
    const at::Tensor out = submanifold_conv(input, weight, at::Tensor(), pairs, tap_begin);
    out.square().sum().backward();
    return std::vector<at::Tensor>{out.detach(), input.grad(), weight.grad()};
  };
  const auto one = test::with_threads(1, run), two = test::with_threads(2, run);
  for (size_t i = 0; i < one.size(); ++i) EXPECT_TRUE(at::equal(one[i], two[i])) << i;
}

TEST_P(SubmanifoldConv, RefusesBadInput) {
  const auto [pairs_, begin_] = convolution_pairs(put(at::zeros({1, 3}, at::kInt)), 3);
  const at::Tensor pairs = pairs_, begin = begin_, none;
  const at::Tensor input = put(at::ones({1, 4})), weight = put(at::ones({27, 4, 6})),
                   bias = put(at::ones({5}));
  const auto refused = [](const at::Tensor& x, const at::Tensor& w, const at::Tensor& b,
                          const at::Tensor& p, const at::Tensor& t, const char* words) {
    return throws_saying([&] { submanifold_conv(x, w, b, p, t); }, words);
  };
  EXPECT_TRUE(refused(input[0], weight, none, pairs, begin, "[N, Cin]"));
  EXPECT_TRUE(refused(put(at::ones({1, 5})), weight, none, pairs, begin, "Cin = 5"));
  EXPECT_TRUE(refused(input, weight.to(at::kDouble), none, pairs, begin, "float64"));
  EXPECT_TRUE(refused(input, weight, bias, pairs, begin, "bias must be [6]"));
  EXPECT_TRUE(refused(input, weight, none, pairs.to(at::kLong), begin, "int32"));
  EXPECT_TRUE(refused(input, weight, none, pairs, begin.narrow(0, 0, 27), "27 taps"));
  EXPECT_TRUE(refused(input, weight, none, pairs, begin + 1, "does not divide"));
  EXPECT_TRUE(
      refused(input, weight.to(at::kBFloat16), none, pairs, begin, "multiple of 16 output"));
  if (on_cpu()) return;
  EXPECT_TRUE(refused(input, weight.cpu(), none, pairs, begin, "weights on cpu"));
  EXPECT_TRUE(refused(input, weight, none, pairs.cpu(), begin, "pairs on cpu"));
  EXPECT_TRUE(refused(input, weight, none, pairs, put(begin), "int64 on the CPU"));
}

TEST_P(SubmanifoldConv, BackwardRefusesBadInput) {
  static const auto backward = find_operator<std::tuple<at::Tensor, at::Tensor>(
      const at::Tensor&, const at::Tensor&, const at::Tensor&, const at::Tensor&, const at::Tensor&,
      bool, bool)>("lte::submanifold_conv_backward");
  const auto [pairs_, begin_] = convolution_pairs(put(at::zeros({1, 3}, at::kInt)), 3);
  const at::Tensor pairs = pairs_, begin = begin_, input = put(at::ones({1, 4})),
                   weight = put(at::ones({27, 4, 6}));
  const auto refused = [&](const at::Tensor& grad, const at::Tensor& x, const char* words) {
    return throws_saying([&] { backward.call(grad, x, weight, pairs, begin, true, true); }, words);
  };
  EXPECT_TRUE(refused(put(at::ones({1, 5})), input, "grad must be [1, 6]"));
  EXPECT_TRUE(refused(put(at::ones({1, 6}, at::kDouble)), input, "grad must be [1, 6]"));
  EXPECT_TRUE(refused(put(at::ones({1, 6})), input.to(at::kDouble), "float64"));
  EXPECT_TRUE(refused(put(at::ones({1, 6})), input.to(at::kBFloat16), "bfloat16 weight"));
}

// On a GPU the host would have to wait for a look at the pairs.
TEST(SubmanifoldConvOnTheCpu, RefusesPairsThatNameNoRowOrAreOutOfOrder) {
  const at::Tensor cells = at::tensor({0, 0, 0, 0, 0, 2}, at::kInt).view({2, 3});
  const auto [pairs_, begin_] = convolution_pairs(cells, 3);
  const at::Tensor pairs = pairs_, begin = begin_;  // the centre tap alone: (0, 0), (1, 1)
  const at::Tensor input = at::ones({2, 4}), weight = at::ones({27, 4, 6});
  const auto refused = [&](const at::Tensor& p, const char* words) {
    return throws_saying([&] { submanifold_conv(input, weight, at::Tensor(), p, begin); }, words);
  };
  EXPECT_TRUE(refused(pairs + 1, "names row 2"));
  EXPECT_TRUE(refused(pairs - 1, "names row -1"));
  EXPECT_TRUE(refused(pairs.flip(1), "not sorted by output"));
}

}  // namespace
}  // namespace lte::ops
