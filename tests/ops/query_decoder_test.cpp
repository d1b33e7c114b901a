// The whole query decoder in one operator, against its formula in float64.
#include "lte/ops/query_decoder.h"

#include <utility>
#include <vector>

#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "lte/ops/neighbour_sums.h"
#include "tests/ops/decoder_fixture.h"
#include "tests/ops/fixtures.h"
#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

at::Tensor unit(const at::Tensor& v) { return v / v.norm(2, {1}, /*keepdim=*/true); }

struct DecoderSizes {
  int64_t Q, m, K, C, L, hidden;
  bool normals = false;  ///< whether γ reads them
};

/// A decoder with its inputs, on the CPU.
struct Case {
  DecoderWeights weights;
  at::Tensor keys, values, attributes;
  QueryNeighbourhood near;

  Case(const DecoderSizes& s, double scale, double limit)
      : weights(test::decoder_weights(9, s.C, s.L, s.hidden,
                                      s.normals ? kNormalInputs : kOffsetInputs)),
        keys(test::floats({s.L, s.m, s.C}, 11)),
        values(test::floats({s.L, s.m, s.C}, 12)),
        attributes(test::floats({s.Q, 9}, 13)),
        near{test::uniform({s.Q, 3}, 14), test::uniform({s.m, 3}, 15),
             test::integers(s.m, {s.Q, s.K}, 16), scale, limit} {
    if (!s.normals) return;
    near.normal = unit(test::floats({s.Q, 3}, 17));
    near.anchor_normal = unit(test::floats({s.m, 3}, 18));
  }

  at::Tensor expected(const at::Tensor& rows) const {
    return test::decoder_reference(attributes.index_select(0, rows), near_of(rows), keys, values,
                                   weights);
  }

  QueryNeighbourhood near_of(const at::Tensor& rows) const {
    return {near.position.index_select(0, rows),
            near.anchor,
            near.index.index_select(0, rows),
            near.scale,
            near.limit,
            near.normal.defined() ? near.normal.index_select(0, rows) : near.normal,
            near.anchor_normal};
  }
};

class QueryDecoderInference : public test::PerDevice {
 protected:
  /// All queries on this device, on the CPU.
  at::Tensor infer(const Case& c) const {
    const QueryNeighbourhood near{
        put(c.near.position), put(c.near.anchor), put(c.near.index),        c.near.scale,
        c.near.limit,         put(c.near.normal), put(c.near.anchor_normal)};
    const at::Tensor table = neighbour_table(put(c.keys), put(c.values));
    const at::Tensor out =
        query_decoder_inference(put(c.attributes), near, table, test::on(GetParam(), c.weights));
    EXPECT_EQ(out.device().type(), GetParam());
    return out.cpu();
  }
};
LTE_FOR_EACH_DEVICE(QueryDecoderInference);

// DecoderSizes about a warp and a block of channels, a run of neighbours, of γ's activations and of
// queries, and a tile of them.
const DecoderSizes kDecoderSizes[] = {
    {1, 1, 1, 1, 1, 1},        {250, 40, 9, 20, 3, 150},       {100, 90, 33, 33, 2, 64},
    {70, 200, 70, 257, 2, 65}, {97, 30, 16, 16, 1, 8},         {20'000, 500, 32, 128, 6, 64},
    {1, 1, 1, 1, 1, 1, true},  {250, 40, 9, 20, 3, 151, true}, {200, 90, 33, 64, 2, 64, true}};

/// Rows about the borders of tiles and blocks of queries.
at::Tensor some_rows(int64_t Q) {
  std::vector<int64_t> rows;
  for (const int64_t border : {int64_t{0}, int64_t{96}, int64_t{16'384}, Q - 1}) {
    for (int64_t row = border - 20; row < border + 20; ++row) {
      if (row >= 0 && row < Q) rows.push_back(row);
    }
  }
  return at::tensor(rows, at::kLong);
}

TEST_P(QueryDecoderInference, IsItsFormula) {
  for (const DecoderSizes& s : kDecoderSizes) {
    const Case c(s, 10, 4);
    const at::Tensor got = infer(c), rows = some_rows(s.Q);
    ASSERT_EQ(got.sizes(), (at::IntArrayRef{s.Q, 3}));
    EXPECT_GE(got.min().item<float>(), 0);
    EXPECT_LT(test::norm_error(got.index_select(0, rows), c.expected(rows)), tolerance(2e-6))
        << "Q " << s.Q << ", C " << s.C;
  }
}

TEST_P(QueryDecoderInference, InBfloat16IsTheFormulaWithRoundedOperands) {
  for (const DecoderSizes& s : kDecoderSizes) {
    if (s.C < 16) continue;
    Case c(s, 10, 4);
    c.weights = test::in_bf16(c.weights);
    const at::Tensor rows = some_rows(s.Q);
    // The CPU's GELU is to 2 · 10^-4 there, and a sum in another order may round to the other
    // neighbour: far fewer than all do.
    EXPECT_LT(test::norm_error(infer(c).index_select(0, rows), c.expected(rows)), 5e-3)
        << "Q " << s.Q << ", C " << s.C;
  }
}

TEST_P(QueryDecoderInference, NoQueriesGiveNoRows) {
  EXPECT_EQ(infer(Case({0, 5, 3, 16, 1, 8}, 1, 1)).sizes(), (at::IntArrayRef{0, 3}));
}

// On CUDA a matrix product may take another path for other numbers of rows.
TEST(QueryDecoderInferenceOnTheCpu, EachQueryIsTheSameBitsInAnyCompany) {
  const Case c({250, 40, 9, 20, 3, 150}, 10, 64);
  const at::Tensor table = neighbour_table(c.keys, c.values);
  const auto some = [&](const at::Tensor& rows) {
    return query_decoder_inference(c.attributes.index_select(0, rows), c.near_of(rows), table,
                                   c.weights);
  };
  const auto whole = [&] {
    return query_decoder_inference(c.attributes, c.near, table, c.weights);
  };
  const at::Tensor all = whole();
  // More tiles of other lengths.
  const at::Tensor twice = at::cat({at::arange(250, at::kLong), at::arange(250, at::kLong)});
  EXPECT_TRUE(at::equal(some(twice), at::cat({all, all})));
  const at::Tensor order = at::arange(249, -1, -1, at::kLong);
  EXPECT_TRUE(at::equal(some(order), all.index_select(0, order)));
  for (const int64_t row : {0, 1, 95, 96, 249}) {
    EXPECT_TRUE(at::equal(some(at::tensor({row}, at::kLong))[0], all[row])) << row;
  }
  EXPECT_TRUE(at::equal(test::with_threads(1, whole), all));
}

// Whether latents lie one after the other or with gaps does not matter.
TEST(QueryDecoderInferenceOnTheCpu, ReadsTablesWithoutGaps) {
  const Case c({30, 12, 5, 32, 2, 40}, 3, 64);
  const at::Tensor table = neighbour_table(c.keys, c.values);
  EXPECT_GT(table.stride(0), table.select(0, 0).numel());
  const auto with = [&](const at::Tensor& t) {
    return query_decoder_inference(c.attributes, c.near, t, c.weights);
  };
  EXPECT_TRUE(at::equal(with(table.contiguous()), with(table)));
  EXPECT_TRUE(test::throws_saying([&] { with(table.transpose(3, 4).contiguous().transpose(3, 4)); },
                                  "neighbour_table()"));
}

TEST_P(QueryDecoderInference, RefusesBadInput) {
  const Case good({4, 5, 3, 20, 2, 30}, 1, 64);
  EXPECT_NO_THROW(infer(good));
  const auto refused = [&](const auto& change, const char* words) {
    Case c = good;
    change(c);
    return test::throws_saying([&] { infer(c); }, words);
  };
  EXPECT_TRUE(refused([](Case& c) { c.attributes = test::floats({4, 8}, 1); }, "point.hidden"));
  EXPECT_TRUE(refused([](Case& c) { c.attributes = test::floats({3, 9}, 1); }, "position must be"));
  EXPECT_TRUE(refused(
      [](Case& c) {
        c.near.anchor = test::uniform({6, 3}, 15);
      },
      "neighbour_table()"));
  EXPECT_TRUE(refused([](Case& c) { c.near.index = c.near.index[0]; }, "[Q, K] int64"));
  EXPECT_TRUE(refused([](Case& c) { c.near.normal = test::floats({4, 3}, 1); }, "go together"));
  EXPECT_TRUE(refused(
      [](Case& c) {
        c.near.normal = test::floats({4, 3}, 1);
        c.near.anchor_normal = test::floats({4, 3}, 1);
      },
      "anchor_normal must be"));
  EXPECT_TRUE(refused(
      [](Case& c) {
        c.near.normal = test::floats({4, 3}, 1);
        c.near.anchor_normal = test::floats({5, 3}, 1);
      },
      "gamma.hidden must be [outputs, 6]"));
  EXPECT_TRUE(
      refused([](Case& c) { c.near.index = c.near.index.narrow(1, 0, 0); }, "no neighbours"));
  EXPECT_TRUE(refused(
      [](Case& c) {
        c.weights.layers[0].query.weight = test::floats({20, 19}, 1);
      },
      "query"));
  EXPECT_TRUE(
      refused([](Case& c) { c.weights.layers[1].norm2.gain = test::floats({19}, 1); }, "norm2"));
  EXPECT_TRUE(
      refused([](Case& c) { c.weights.head.output.bias = test::floats({2}, 1); }, "head.output"));
  EXPECT_TRUE(refused(
      [](Case& c) {
        c.weights.gamma.hidden.weight = test::floats({30, 3}, 1).to(at::kBFloat16);
      },
      "gamma.hidden"));
  EXPECT_TRUE(refused([](Case& c) { c.weights.layers.pop_back(); }, "layers have"));
  // The width of gamma's output is the decoder's: the rest has to agree. A table of the CPU has
  // blocks, which fill 30 channels as they fill 20.
  EXPECT_TRUE(refused([](Case& c) { c.weights.gamma.output = c.weights.layers[0].ffn.hidden; },
                      on_cpu() ? "point.output must be [30, 30]" : "neighbour_table() at C = 30"));
}

// On a GPU a kernel asserts it.
TEST(QueryDecoderInferenceOnTheCpu, RefusesNeighboursOutsideTheLatents) {
  Case c({4, 5, 3, 20, 2, 30}, 1, 64);
  c.near.index[3][1] = 5;
  EXPECT_TRUE(test::throws_saying(
      [&] {
        query_decoder_inference(c.attributes, c.near, neighbour_table(c.keys, c.values), c.weights);
      },
      "query 3, neighbour 1"));
}

TEST(DecoderWeights, SurviveTheListInTheirOrder) {
  const DecoderWeights w = test::decoder_weights(9, 20, 2, 30);
  const std::vector<at::Tensor> list = w.to_list();
  ASSERT_EQ(list.size(), 14u + 2 * 12u);
  EXPECT_TRUE(list.front().is_same(w.point.hidden.weight));
  EXPECT_TRUE(list.back().is_same(w.head.output.bias));
  const DecoderWeights back = DecoderWeights::from_list(list, 2);
  EXPECT_TRUE(back.gamma.output.weight.is_same(w.gamma.output.weight));
  EXPECT_TRUE(back.layers[1].norm2.bias.is_same(w.layers[1].norm2.bias));
  EXPECT_TRUE(test::throws_saying([&] { DecoderWeights::from_list(list, 1); },
                                  "1 layers have 26 weights, got 38"));
}

TEST(PackedDecoder, GivesTheSameBitsAtEachCall) {
  for (const bool normals : {false, true}) {
    for (const int64_t Q : {0, 1, 5, 200}) {
      const Case c({Q, 30, 5, 32, 2, 24, normals}, 2, 1.5);
      const at::Tensor table = neighbour_table(c.keys, c.values);
      const auto packed = pack_decoder(c.weights);
      const at::Tensor expected = query_decoder_inference(c.attributes, c.near, table, c.weights);
      for (int call = 0; call < 2; ++call)
        EXPECT_TRUE(
            at::equal(query_decoder_inference(c.attributes, c.near, table, *packed), expected));
    }
  }
}

TEST(PackedDecoder, RefusesOtherSizes) {
  const Case c({5, 30, 5, 32, 2, 24}, 2, 1.5), deeper({5, 30, 5, 32, 3, 24}, 2, 1.5),
      facing({5, 30, 5, 32, 2, 24, true}, 2, 1.5);
  const auto packed = pack_decoder(c.weights);
  const auto refused = [&](const Case& given, const at::Tensor& attributes) {
    const at::Tensor table = neighbour_table(given.keys, given.values);
    return test::throws_saying(
        [&] { query_decoder_inference(attributes, given.near, table, *packed); }, "packed weights");
  };
  EXPECT_TRUE(refused(deeper, deeper.attributes));
  EXPECT_TRUE(refused(facing, facing.attributes));
  EXPECT_TRUE(refused(c, test::floats({5, 8}, 1)));
  DecoderWeights wrong = c.weights;
  wrong.norm.gain = test::floats({31}, 2);
  EXPECT_TRUE(test::throws_saying([&] { pack_decoder(wrong); }, "norm"));
}

}  // namespace
}  // namespace lte::ops
