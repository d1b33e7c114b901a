#include "lte/ops/neighbour_sums.h"

#include <vector>

#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "lte/ops/dispatch.h"
#include "tests/ops/fixtures.h"
#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

using test::throws_saying;

struct Sizes {
  int64_t L, m, C, Q, K;
};

struct Inputs {
  at::Tensor keys, values, position, index;
};

Inputs make_inputs(const Sizes& s, at::ScalarType dtype = at::kDouble) {
  return {test::normal({s.L, s.m, s.C}, 41, dtype), test::normal({s.L, s.m, s.C}, 42, dtype),
          test::normal({s.Q, s.K, s.C}, 43, dtype), test::integers(s.m, {s.Q, s.K}, 44)};
}

/// The paper's sum over neighbours, layer by layer, from gathered copies: nothing factored.
at::Tensor attention(const Inputs& in, const at::Tensor& query) {
  std::vector<at::Tensor> layers;
  for (int64_t l = 0; l < in.keys.size(0); ++l) {
    const auto gathered = [&](const at::Tensor& table) {
      return table[l].index_select(0, in.index.reshape({-1})).reshape(in.position.sizes());
    };
    const at::Tensor score = query[l].unsqueeze(1) - gathered(in.keys) + in.position;
    layers.push_back((score * (gathered(in.values) + in.position)).sum(1));
  }
  return at::stack(layers);
}

class NeighbourSums : public test::PerDevice {
 protected:
  /// The sums made on this device, on the CPU.
  std::pair<at::Tensor, at::Tensor> sums_of(const at::Tensor& keys, const at::Tensor& values,
                                            const at::Tensor& position,
                                            const at::Tensor& index) const {
    const auto [sum1, sum2] = neighbour_sums(put(keys), put(values), put(position), put(index));
    EXPECT_EQ(sum1.device().type(), GetParam());
    return {sum1.cpu(), sum2.cpu()};
  }

  std::pair<at::Tensor, at::Tensor> sums_of(const Inputs& in) const {
    return sums_of(in.keys, in.values, in.position, in.index);
  }
};
LTE_FOR_EACH_DEVICE(NeighbourSums);

const Sizes kSizes[] = {{1, 1, 1, 1, 1},    {6, 50, 128, 40, 32}, {2, 9, 16, 15, 5},
                        {3, 9, 17, 16, 4},  {5, 9, 33, 17, 3},    {7, 9, 8, 33, 2},
                        {13, 20, 24, 5, 8}, {4, 5, 48, 0, 3},     {6, 30, 64, 100, 32}};

TEST_P(NeighbourSums, GiveTheUnfactoredAttention) {
  for (const Sizes& s : kSizes) {
    const Inputs in = make_inputs(s);
    const at::Tensor query = test::normal({s.L, s.Q, s.C}, 45);
    const auto [sum1, sum2] = sums_of(in);
    ASSERT_EQ(sum1.sizes(), (at::IntArrayRef{s.L, s.Q, s.C}));
    EXPECT_LT(test::relative_error(query * sum1 + sum2, attention(in, query)), 1e-13)
        << "L " << s.L << " C " << s.C;
  }
}

TEST_P(NeighbourSums, HaveTheGradientsOfTheUnfactoredAttention) {
  for (const Sizes& s : kSizes) {
    const at::Tensor query = test::normal({s.L, s.Q, s.C}, 45);
    const at::Tensor probe = test::normal({s.L, s.Q, s.C}, 46);
    Inputs versions[2] = {make_inputs(s), make_inputs(s)};
    for (int version = 0; version < 2; ++version) {
      Inputs& in = versions[version];
      for (at::Tensor* t : {&in.keys, &in.values, &in.position}) t->requires_grad_();
      at::Tensor out;
      if (version == 0) {
        const auto [sum1, sum2] = sums_of(in);
        out = query * sum1 + sum2;
      } else {
        out = attention(in, query);
      }
      (out * probe).sum().backward();
    }
    const auto& [ours, exact] = versions;
    EXPECT_LT(test::relative_error(ours.keys.grad(), exact.keys.grad()), 1e-12) << "C " << s.C;
    EXPECT_LT(test::relative_error(ours.values.grad(), exact.values.grad()), 1e-12) << "C " << s.C;
    EXPECT_LT(test::relative_error(ours.position.grad(), exact.position.grad()), 1e-12)
        << "C " << s.C;
  }
}

TEST_P(NeighbourSums, GradientsAreFiniteDifferences) {
  Inputs in = make_inputs({2, 4, 3, 5, 3});
  for (at::Tensor* t : {&in.keys, &in.values, &in.position}) t->requires_grad_();
  const at::Tensor probe1 = test::normal({2, 5, 3}, 47), probe2 = test::normal({2, 5, 3}, 48);
  const auto loss = [&](const at::Tensor& k, const at::Tensor& v, const at::Tensor& p) {
    const auto [sum1, sum2] = sums_of(k, v, p, in.index);
    return (sum1 * probe1 + sum2 * probe2).sum();
  };
  loss(in.keys, in.values, in.position).backward();
  const auto by = [&](const at::Tensor& x, const std::function<at::Tensor(const at::Tensor&)>& f) {
    return test::relative_error(x.grad(), test::numerical_gradient(f, x));
  };
  EXPECT_LT(by(in.keys, [&](auto& x) { return loss(x, in.values, in.position); }), 1e-8);
  EXPECT_LT(by(in.values, [&](auto& x) { return loss(in.keys, x, in.position); }), 1e-8);
  EXPECT_LT(by(in.position, [&](auto& x) { return loss(in.keys, in.values, x); }), 1e-8);
}

TEST_P(NeighbourSums, AGradientByOneSumAloneIsComplete) {
  Inputs in = make_inputs({2, 6, 20, 9, 4});
  in.position.requires_grad_();
  sums_of(in).first.sum().backward();
  EXPECT_TRUE(at::equal(in.position.grad(), at::full_like(in.position, 2)));  // one for each layer
}

TEST_P(NeighbourSums, AcceptStridedInputs) {
  const Inputs in = make_inputs({2, 6, 20, 9, 4});
  const auto strided = [](const at::Tensor& t) {
    return t.transpose(0, 2).contiguous().transpose(0, 2);
  };
  const auto plain = sums_of(in);
  const auto other = sums_of(strided(in.keys), strided(in.values), strided(in.position),
                             in.index.t().contiguous().t());
  EXPECT_TRUE(at::equal(plain.first, other.first));
  EXPECT_TRUE(at::equal(plain.second, other.second));
}

TEST_P(NeighbourSums, InferenceAgreesWithTraining) {
  for (const Sizes& s : kSizes) {
    for (const int64_t H : {1, 13, 64}) {
      const Inputs in = make_inputs(s, at::kFloat);
      const at::Tensor hidden = test::normal({s.Q, s.K, H}, 51, at::kFloat);
      const at::Tensor weight = test::normal({s.C, H}, 52, at::kFloat) / std::sqrt(double(H));
      const at::Tensor bias = test::normal({s.C}, 53, at::kFloat);
      const at::Tensor position = at::matmul(hidden, weight.t()) + bias;
      const auto training = sums_of(in.keys, in.values, position, in.index);
      const auto [sum1, sum2] =
          neighbour_sums_inference(neighbour_table(put(in.keys), put(in.values)), put(hidden),
                                   put(weight), put(bias), put(in.index));
      ASSERT_EQ(sum1.sizes(), (at::IntArrayRef{s.L, s.Q, s.C}));
      EXPECT_LT(test::relative_error(sum1.cpu(), training.first), tolerance(1e-5));
      EXPECT_LT(test::relative_error(sum2.cpu(), training.second), tolerance(1e-5));
    }
  }
}

TEST_P(NeighbourSums, Float32IsCloseToFloat64) {
  const Sizes s{6, 50, 128, 40, 32};
  const Inputs in = make_inputs(s);
  const auto exact = sums_of(in);
  const auto single = sums_of(in.keys.to(at::kFloat), in.values.to(at::kFloat),
                              in.position.to(at::kFloat), in.index);
  EXPECT_LT(test::relative_error(single.first, exact.first), tolerance(2e-6));
  EXPECT_LT(test::relative_error(single.second, exact.second), tolerance(2e-6));
}

TEST_P(NeighbourSums, DoNotDependOnThreadsAndRepeatTheirBits) {
  const Sizes s{6, 100, 72, 333, 16};
  const Inputs in = make_inputs(s, at::kFloat);
  const at::Tensor hidden = put(test::normal({s.Q, s.K, 20}, 54, at::kFloat)),
                   weight = put(test::normal({s.C, 20}, 55, at::kFloat)),
                   bias = put(test::normal({s.C}, 56, at::kFloat)), index = put(in.index),
                   table = neighbour_table(put(in.keys), put(in.values));
  const auto run = [&] {
    const at::Tensor k = put(in.keys).detach().requires_grad_(),
                     v = put(in.values).detach().requires_grad_(),
                     p = put(in.position).detach().requires_grad_();
    const auto [sum1, sum2] = neighbour_sums(k, v, p, index);
    (sum1.square() + sum2).sum().backward();
    const auto [fused1, fused2] = neighbour_sums_inference(table, hidden, weight, bias, index);
    return std::vector<at::Tensor>{sum1.detach(), sum2.detach(), k.grad(), v.grad(),
                                   p.grad(),      fused1,        fused2};
  };
  const auto one = test::with_threads(1, run), two = test::with_threads(2, run);
  for (size_t i = 0; i < one.size(); ++i) EXPECT_TRUE(at::equal(one[i], two[i])) << i;
}

TEST(NeighbourSumsOnTheCpu, InferenceDoesNotDependOnOtherQueries) {
  const Sizes s{6, 100, 72, 333, 16};
  const Inputs in = make_inputs(s, at::kFloat);
  const at::Tensor hidden = test::normal({s.Q, s.K, 20}, 54, at::kFloat),
                   weight = test::normal({s.C, 20}, 55, at::kFloat),
                   bias = test::normal({s.C}, 56, at::kFloat);
  const at::Tensor table = neighbour_table(in.keys, in.values);
  const auto whole = neighbour_sums_inference(table, hidden, weight, bias, in.index);
  const auto part = neighbour_sums_inference(table, hidden.narrow(0, 100, 7), weight, bias,
                                             in.index.narrow(0, 100, 7));
  EXPECT_TRUE(at::equal(std::get<0>(part), std::get<0>(whole).narrow(1, 100, 7)));
  EXPECT_TRUE(at::equal(std::get<1>(part), std::get<1>(whole).narrow(1, 100, 7)));
}

TEST_P(NeighbourSums, RefuseBadInput) {
  const Inputs in = make_inputs({2, 6, 20, 9, 4}, at::kFloat);
  const at::Tensor k = put(in.keys), v = put(in.values), p = put(in.position), i = put(in.index);
  const auto refused = [](const at::Tensor& keys, const at::Tensor& values,
                          const at::Tensor& position, const at::Tensor& index, const char* words) {
    return throws_saying([&] { neighbour_sums(keys, values, position, index); }, words);
  };
  EXPECT_TRUE(refused(k[0], v, p, i, "[L, m, C]"));
  EXPECT_TRUE(refused(k, v[0], p, i, "shape of keys"));
  EXPECT_TRUE(refused(k, v.to(at::kDouble), p, i, "float64"));
  EXPECT_TRUE(refused(k, v, p[0], i, "position must be"));
  EXPECT_TRUE(refused(k, v, p.to(at::kDouble), i, "position must be"));
  EXPECT_TRUE(refused(k, v, p, i[0], "[Q, K] int64"));
  EXPECT_TRUE(refused(k, v, p, i.to(at::kInt), "int64"));
  EXPECT_TRUE(throws_saying([&] { neighbour_table(k, v.narrow(2, 0, 19)); }, "shape of keys"));
  if (on_cpu()) return;
  EXPECT_TRUE(refused(k, v.cpu(), p, i, "values on cpu"));
  EXPECT_TRUE(refused(k, v, p, i.cpu(), "indices on cpu"));
}

TEST_P(NeighbourSums, BackwardRefusesBadInput) {
  static const auto backward = find_operator<std::tuple<at::Tensor, at::Tensor, at::Tensor>(
      const at::Tensor&, const at::Tensor&, const at::Tensor&, const at::Tensor&, const at::Tensor&,
      const at::Tensor&)>("lte::neighbour_sums_backward");
  const Inputs in = make_inputs({2, 6, 20, 9, 4}, at::kFloat);
  const auto refused = [&](const at::Tensor& grad1, const at::Tensor& grad2) {
    return throws_saying(
        [&] {
          backward.call(put(grad1), put(grad2), put(in.keys), put(in.values), put(in.position),
                        put(in.index));
        },
        "a gradient must be [2, 9, 20]");
  };
  const at::Tensor good = at::ones({2, 9, 20});
  EXPECT_TRUE(refused(good, good.narrow(2, 0, 19)));
  EXPECT_TRUE(refused(good[0], good));
  EXPECT_TRUE(refused(good, good.to(at::kDouble)));
}

TEST_P(NeighbourSums, InferenceRefusesBadInput) {
  const Inputs in = make_inputs({2, 6, 20, 9, 4}, at::kFloat);
  const at::Tensor table = neighbour_table(put(in.keys), put(in.values)), index = put(in.index),
                   hidden = put(at::ones({9, 4, 5})), weight = put(at::ones({20, 5})),
                   bias = put(at::ones({20}));
  const auto refused = [](const at::Tensor& t, const at::Tensor& h, const at::Tensor& w,
                          const at::Tensor& b, const at::Tensor& i, const char* words) {
    return throws_saying([&] { neighbour_sums_inference(t, h, w, b, i); }, words);
  };
  EXPECT_TRUE(refused(put(in.keys), hidden, weight, bias, index, "neighbour_table()"));
  EXPECT_TRUE(refused(table.transpose(0, 1).contiguous().transpose(0, 1), hidden, weight, bias,
                      index, "neighbour_table()"));
  EXPECT_TRUE(refused(table, hidden[0], weight, bias, index, "hidden must be"));
  EXPECT_TRUE(refused(table, hidden, weight, put(at::ones({19})), index, "bias [C]"));
  EXPECT_TRUE(refused(table, hidden, put(at::ones({60, 5})), put(at::ones({60})), index, "C = 60"));
  EXPECT_TRUE(refused(table, hidden.to(at::kDouble), weight, bias, index, "float32"));
  EXPECT_TRUE(refused(table, hidden, weight, bias, index[0], "[Q, K] int64"));
}

// On a GPU kernels assert it.
TEST(NeighbourSumsOnTheCpu, RefuseNeighboursOutsideTheLatents) {
  const Inputs in = make_inputs({2, 6, 20, 9, 4}, at::kFloat);
  const auto refused = [&](const at::Tensor& index, const char* words) {
    return throws_saying([&] { neighbour_sums(in.keys, in.values, in.position, index); }, words);
  };
  at::Tensor index = in.index.clone();
  index[7][2] = 6;
  EXPECT_TRUE(refused(index, "query 7, neighbour 2 is 6, outside the 6 latents"));
  index[3][1] = -1;
  EXPECT_TRUE(refused(index, "query 3, neighbour 1"));
  EXPECT_TRUE(throws_saying(
      [&] {
        neighbour_sums_inference(neighbour_table(in.keys, in.values), at::ones({9, 4, 5}),
                                 at::ones({20, 5}), at::ones({20}), in.index + 6);
      },
      "outside the 6 latents"));
}

}  // namespace
}  // namespace lte::ops
