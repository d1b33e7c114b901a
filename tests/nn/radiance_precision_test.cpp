// Radiance decoding in bf16 against float32.
#include <gtest/gtest.h>

#include "tests/nn/support.h"

namespace lte::nn {
namespace {

/// Wide enough that its layers are rounded.
ModelConfig wide_config() {
  ModelConfig config = test::tiny_geometric_config();
  config.channels = 64;
  config.query_layers = 4;
  config.light_input = LightInput::Traced;
  config.radiance_lobes = 16;
  return config;
}

LightTransportModel random_radiance_model() {
  LightTransportModel model(wide_config());
  test::randomize(*model, 4);
  model->eval();
  return model;
}

struct PrecisionCase {
  PointSet points = test::box_scene(400, 1);
  QuerySet queries = test::box_queries(300, 2);
  at::Tensor directions;

  PrecisionCase() {
    torch::manual_seed(3);
    points.gloss = torch::rand({400, 2});
    const at::Tensor way = queries.normal.unsqueeze(1) + 0.5 * torch::rand({300, 5, 3});
    directions = way / way.norm(2, {2}, true);
  }
};

TEST(RadiancePrecision, Bf16StaysNearFloat32) {
  const at::NoGradGuard no_grad;
  const PrecisionCase c;
  LightTransportModel model = random_radiance_model();
  const auto answer = [&](const Embedding& embedding) {
    return model->decode_radiance(embedding, c.queries, c.directions);
  };
  const Embedding embedding = model->encode(c.points);
  const at::Tensor single = answer(embedding);
  model->set_precision(Precision::Bf16);
  const at::Tensor half = answer(embedding), whole = answer(model->encode(c.points));
  EXPECT_TRUE(half.isfinite().all().item<bool>());
  EXPECT_GE(half.min().item<float>(), 0);
  // The bound that irradiance has (tests/nn/adversaries.cpp): of the decoder alone, and with
  // latents and the light that discs send out in bf16 too.
  EXPECT_LT(test::relative_difference(half, single), 1e-2);
  EXPECT_GT(test::relative_difference(half, single), 1e-5) << "nothing is rounded";
  EXPECT_LT(test::relative_difference(whole, single), 1e-2);
  model->set_precision(Precision::Fp32);
  EXPECT_TRUE(torch::equal(answer(embedding), single)) << "it can be taken back";
}

TEST(RadiancePrecision, AnswersInBf16DependOnNoBlock) {
  const at::NoGradGuard no_grad;
  const PrecisionCase c;
  LightTransportModel model = random_radiance_model();
  model->set_precision(Precision::Bf16);
  const Embedding embedding = model->encode(c.points);
  const at::Tensor all = model->decode_radiance(embedding, c.queries, c.directions);
  const at::Tensor blocks =
      model->decode_radiance(embedding, c.queries, c.directions, {.block = 37});
  EXPECT_LT(test::relative_difference(blocks, all), 1e-5);
}

}  // namespace
}  // namespace lte::nn
