// Inference in float32 against float64 equations, and in bf16 against float32, on embeddings and
// scenes chosen to hurt; and that a query's answer depends on nothing but the query.
#include <gtest/gtest.h>

#include "tests/nn/adversaries.h"
#include "tests/nn/support.h"

namespace lte::nn {
namespace {

TEST(Stability, DecodingStaysNearTheEquationsOnAdversarialEmbeddings) {
  for (const int64_t channels : {16, 128}) {
    for (const test::DecoderAdversary& adversary : test::decoder_adversaries()) {
      test::DecoderCase c = test::make_decoder_case(adversary, channels);
      const at::Tensor single = test::decode_fused(c, Precision::Fp32),
                       half = test::decode_fused(c, Precision::Bf16),
                       exact = test::decode_exactly(c, c.config.query_layers);
      EXPECT_TRUE(single.isfinite().all().item<bool>()) << adversary.name;
      EXPECT_TRUE(half.isfinite().all().item<bool>()) << adversary.name;
      EXPECT_LT(test::relative_difference(single.to(at::kDouble), exact), adversary.fp32_bound)
          << adversary.name << ", " << channels << " channels";
      const double by_bf16 = test::relative_difference(half, single);
      EXPECT_LT(by_bf16, adversary.bf16_bound) << adversary.name << ", " << channels << " channels";
      EXPECT_GT(by_bf16, 0) << adversary.name;
    }
  }
}

TEST(Stability, ErrorsDoNotExplodeWithTheLayers) {
  const test::DecoderCase whole = test::make_decoder_case(test::decoder_adversaries().front(), 128);
  for (int64_t layers = 1; layers <= whole.config.query_layers; ++layers) {
    test::DecoderCase c = test::cut(whole, layers);
    const at::Tensor single = test::decode_fused(c, Precision::Fp32);
    EXPECT_LT(test::relative_difference(single.to(at::kDouble), test::decode_exactly(c, layers)),
              5e-7 * std::sqrt(static_cast<double>(layers)))
        << layers;
    EXPECT_LT(test::relative_difference(test::decode_fused(c, Precision::Bf16), single),
              3e-3 * std::sqrt(static_cast<double>(layers)))
        << layers;
  }
}

TEST(Stability, EncodingStaysNearFloat64) {
  const at::NoGradGuard no_grad;
  torch::manual_seed(32);
  LightTransportModel model(test::tiny_config());
  model->eval();
  LightTransportModel exact(test::tiny_config());
  const auto weights = model->named_parameters();
  for (auto& item : exact->named_parameters()) item.value().copy_(weights[item.key()]);
  exact->to(at::kDouble);
  exact->eval();
  for (const test::SceneAdversary& adversary : test::scene_adversaries(400)) {
    model->set_precision(Precision::Fp32);
    const at::Tensor got = model->encode(adversary.points).features;
    const at::Tensor expected = exact->encode(test::as_double(adversary.points)).features;
    EXPECT_TRUE(got.isfinite().all().item<bool>()) << adversary.name;
    EXPECT_LT(test::relative_difference(got.to(at::kDouble), expected), adversary.fp32_bound)
        << adversary.name;
    model->set_precision(Precision::Bf16);
    const double by_bf16 = test::relative_difference(model->encode(adversary.points).features, got);
    EXPECT_LT(by_bf16, adversary.bf16_bound) << adversary.name;
    EXPECT_GT(by_bf16, 0) << adversary.name;
  }
}

TEST(Stability, AnAnswerDependsNeitherOnItsCompanyNorOrderNorBlock) {
  const at::NoGradGuard no_grad;
  LightTransportModel model(test::tiny_config());
  test::randomize(*model, 21);
  model->eval();
  const QuerySet queries = test::box_queries(3000, 6);
  const auto pick = [&](const at::Tensor& index) -> QuerySet {
    return {queries.position.index_select(0, index), queries.normal.index_select(0, index),
            queries.albedo.index_select(0, index)};
  };
  const at::Tensor order = torch::randperm(3000);
  for (const Precision precision : {Precision::Fp32, Precision::Bf16}) {
    model->set_precision(precision);
    const Embedding embedding = model->encode(test::box_scene(200, 5));
    Embedding layered = embedding;  // layer by layer, without the fused operator
    layered.table = at::Tensor();
    for (const bool fused : {true, false}) {
      const Embedding& e = fused ? embedding : layered;
      const at::Tensor all = model->decode(e, queries);
      EXPECT_LT(
          test::relative_difference(model->decode(e, pick(order)), all.index_select(0, order)),
          1e-6);
      for (const int64_t block : {1, 97, 1000, 2999, 3000, 1 << 20}) {
        const int64_t count = block == 1 ? 40 : 3000;
        const at::Tensor some = torch::arange(count);
        EXPECT_LT(test::relative_difference(model->decode(e, pick(some), {true, block}),
                                            all.narrow(0, 0, count)),
                  1e-6)
            << enum_name(precision) << ", blocks of " << block;
      }
    }
  }
}

TEST(Stability, PrecisionIsOfInferenceAloneAndCanBeTakenBack) {
  LightTransportModel model(test::tiny_config());
  test::randomize(*model, 21);
  model->eval();
  const PointSet points = test::box_scene(200, 5);
  const auto features = [&] { return model->encode(points).features.detach(); };
  const auto inferred = [&] {
    const at::NoGradGuard no_grad;
    return features();
  };
  const at::Tensor single = inferred(), with_gradients = features();
  model->set_precision(Precision::Bf16);
  EXPECT_GT(test::relative_difference(inferred(), single), 1e-5);
  EXPECT_TRUE(torch::equal(features(), with_gradients));
  model->set_precision(Precision::Fp32);
  EXPECT_TRUE(torch::equal(inferred(), single));
}

}  // namespace
}  // namespace lte::nn
