// Rounding errors of inference, layer by layer, on random and adversarial embeddings: float32
// against float64 equations, bf16 against float32. scripts/figures/plot_numerics.py draws them.
//   lte_stability_bench [--channels 128] [--json F]
#include <cstdio>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <torch/utils.h>

#include "lte/base/file.h"
#include "lte/cli/cli.h"
#include "tests/nn/adversaries.h"
#include "tests/nn/support.h"

namespace lte::bench {
namespace {

/// One case after so many layers.
struct Row {
  std::string kind, name;  ///< kind: decoder or encoder
  int64_t layers;
  double fp32, bf16;  ///< errors in the Euclidean norm, relative
};

void add_decoder_rows(std::vector<Row>& rows, int64_t channels) {
  for (const test::DecoderAdversary& adversary : test::decoder_adversaries()) {
    const test::DecoderCase whole = test::make_decoder_case(adversary, channels);
    for (int64_t layers = 1; layers <= whole.config.query_layers; ++layers) {
      test::DecoderCase c = test::cut(whole, layers);
      const at::Tensor single = test::decode_fused(c, nn::Precision::Fp32),
                       half = test::decode_fused(c, nn::Precision::Bf16);
      rows.push_back(
          {"decoder", adversary.name, layers,
           test::relative_difference(single.to(at::kDouble), test::decode_exactly(c, layers)),
           test::relative_difference(half, single)});
    }
  }
}

/// The latents of the whole encoder, whose depth cannot be cut: one row a scene.
void add_encoder_rows(std::vector<Row>& rows, int64_t channels, int64_t M) {
  const at::NoGradGuard no_grad;
  nn::ModelConfig config;
  config.channels = channels;
  torch::manual_seed(32);
  nn::LightTransportModel model(config), exact(config);
  const auto weights = model->named_parameters();
  for (auto& item : exact->named_parameters()) item.value().copy_(weights[item.key()]);
  model->eval();
  exact->to(at::kDouble);
  exact->eval();
  for (const test::SceneAdversary& adversary : test::scene_adversaries(M)) {
    model->set_precision(nn::Precision::Fp32);
    const at::Tensor single = model->encode(adversary.points).features;
    const at::Tensor expected = exact->encode(test::as_double(adversary.points)).features;
    model->set_precision(nn::Precision::Bf16);
    const at::Tensor half = model->encode(adversary.points).features;
    rows.push_back({"encoder", adversary.name, 14,
                    test::relative_difference(single.to(at::kDouble), expected),
                    test::relative_difference(half, single)});
  }
}

std::string to_json(const std::vector<Row>& rows) {
  nlohmann::json out = nlohmann::json::array();
  for (const Row& row : rows) {
    out.push_back({{"kind", row.kind},
                   {"name", row.name},
                   {"layers", row.layers},
                   {"fp32_against_fp64", row.fp32},
                   {"bf16_against_fp32", row.bf16}});
  }
  return out.dump(1) + "\n";
}

}  // namespace
}  // namespace lte::bench

int main(int argc, char** argv) {
  CLI::App app{"Rounding errors of inference by layer.", "lte_stability_bench"};
  lte::CommonOptions common;
  int64_t channels = 128, scene_points = 2'000;
  lte::add_common_options(app, &common);
  app.add_option("--channels", channels, "D")->check(CLI::PositiveNumber);
  app.add_option("--scene-points", scene_points, "M of the encoder's scenes")
      ->check(CLI::PositiveNumber);
  return lte::run_tool(app, argc, argv, [&] {
    lte::apply_common_options(common);
    std::vector<lte::bench::Row> rows;
    lte::bench::add_decoder_rows(rows, channels);
    lte::bench::add_encoder_rows(rows, channels, scene_points);
    for (const auto& row : rows) {
      std::printf("%-8s %-42s %2lld layers  fp32 %.2e  bf16 %.2e\n", row.kind.c_str(),
                  row.name.c_str(), static_cast<long long>(row.layers), row.fp32, row.bf16);
    }
    if (!common.json.empty()) lte::write_file(common.json, lte::bench::to_json(rows));
  });
}
