#include "lte/nn/cost.h"

#include <gtest/gtest.h>

#include "lte/nn/constants.h"
#include "lte/nn/inference_memory.h"
#include "lte/nn/model.h"
#include "tests/nn/support.h"

namespace lte::nn {
namespace {

TEST(Cost, ModulesAddUpToThePartsAndTheWhole) {
  const LightTransportModel model(test::tiny_config());
  const ParameterCounts counts = count_parameters(model);
  int64_t total = 0;
  for (const at::Tensor& parameter : model->parameters()) total += parameter.numel();
  EXPECT_EQ(counts.total, total);
  EXPECT_EQ(counts.nne + counts.encoder + counts.decoder, total);
  int64_t by_module = 0;
  for (const auto& [module, count] : parameters_by_module(model)) by_module += count;
  EXPECT_EQ(by_module, total);
}

TEST(Cost, ShapesAreThoseOfAnEmbedding) {
  LightTransportModel model(test::tiny_config());
  for (const int64_t M : {1, 2, 3, 4, 5, 42, 97}) {
    const Embedding embedding = model->encode(test::box_scene(M, 3));
    EXPECT_EQ(embedding.features.size(0), latent_count(M)) << "M = " << M;
    EXPECT_EQ(embedding.features.size(1), latent_width(model->config())) << "M = " << M;
  }
}

TEST(Cost, AQueryCostsTwoOperationsAWeightBesidesItsNeighbours) {
  // Every dense weight but those of keys, values and γ multiplies once a query.
  const ModelConfig config = test::tiny_config();
  const LightTransportModel model(config);
  double weights = 0;
  for (const auto& item : model->named_parameters()) {
    const std::string& name = item.key();
    const bool of_query = name.starts_with("decoder.") && !name.starts_with("decoder.gamma.") &&
                          name.find(".key.") == std::string::npos &&
                          name.find(".value.") == std::string::npos;
    if (of_query && item.value().dim() == 2) weights += static_cast<double>(item.value().numel());
  }
  const double D = 16, h = kGammaHidden, K = 5, L = 2;
  EXPECT_EQ(decode_flops(config, 100), 2 * (weights + K * (3 * h + h * D) + 2 * K * L * D));
  EXPECT_LT(decode_flops(config, 3), decode_flops(config, 5)) << "no more neighbours than latents";
  EXPECT_EQ(decode_flops(config, 5), decode_flops(config, 100));
}

TEST(Cost, GrowsWithWhatIsAsked) {
  const ModelConfig config;
  EXPECT_LT(encode_mb(config, 1000), encode_mb(config, 20'000));
  EXPECT_LT(decode_mb(config, 1 << 20, 1024), decode_mb(config, 1 << 20, 1 << 17));
  EXPECT_EQ(decode_mb(config, 100, 1024), decode_mb(config, 100, 1 << 17)) << "a block at most";
  EXPECT_LT(activation_bytes(config, 20'000, 1024), activation_bytes(config, 20'000, 8192));
  EXPECT_EQ(weight_bytes(1000), 4000);
}

}  // namespace
}  // namespace lte::nn
