#include "tests/nn/adversaries.h"

#include "tests/nn/reference_decoder.h"
#include "tests/nn/support.h"

namespace lte::test {

const std::vector<DecoderAdversary>& decoder_adversaries() {
  static const std::vector<DecoderAdversary> adversaries = {
      {"random", 2e-6, 1e-2, [](DecoderCase&) {}},
      {"one latent 10^4 times the others", 1e-5, 1e-2,
       [](DecoderCase& c) { c.latent[7].mul_(1e4); }},
      {"all latents 10^4 times as large", 1e-5, 1e-2, [](DecoderCase& c) { c.latent.mul_(1e4); }},
      {"coincident points, as many as neighbours", 2e-6, 1e-2,
       [](DecoderCase& c) {
         c.anchor.narrow(0, 0, 32).copy_(c.anchor[0].clone());
         c.position.narrow(0, 0, 20).copy_(c.anchor[0].clone());
         // Elsewhere no query may be as far from the 32nd neighbour as from the 33rd.
         c.position.narrow(0, 20, 50).copy_(c.anchor[0] + 1e-3 * torch::randn({50, 3}));
       }},
      {"latents without variance", 2e-6, 1e-2, [](DecoderCase& c) { c.latent.fill_(3); }},
      {"query features without variance",
       1e-4,  // rounding of 0.7 over the norm's floor, the root of 1e-5
       1e-2,
       [](DecoderCase& c) {
         auto parameters = c.decoder->named_parameters();
         parameters["point.output.weight"].zero_();
         parameters["point.output.bias"].fill_(0.7);
       }},
  };
  return adversaries;
}

DecoderCase make_decoder_case(const DecoderAdversary& adversary, int64_t channels) {
  const at::NoGradGuard no_grad;
  DecoderCase c;
  c.config = tiny_config();
  c.config.channels = channels;
  c.config.query_neighbours = 32;
  c.config.query_layers = 6;
  torch::manual_seed(31);
  c.decoder = nn::QueryDecoder(channels, c.config);
  c.decoder->eval();
  c.position = torch::rand({70, 3});
  c.anchor = torch::rand({100, 3});
  c.latent = torch::randn({100, channels});
  adversary.arrange(c);
  c.attributes = torch::cat({4 * c.position, torch::randn({70, 6})}, 1);
  return c;
}

at::Tensor decode_fused(DecoderCase& c, nn::Precision precision) {
  const at::NoGradGuard no_grad;
  nn::set_precision(*c.decoder, precision);
  return c.decoder->infer(c.attributes, {c.position, {}}, {c.anchor, {}}, c.spacing,
                          c.decoder->table(c.latent));
}

at::Tensor decode_exactly(const DecoderCase& c, int64_t layers) {
  const at::NoGradGuard no_grad;
  nn::ModelConfig config = c.config;
  config.query_layers = layers;
  std::map<std::string, at::Tensor> exact;
  for (const auto& item : c.decoder->named_parameters())
    exact[item.key()] = item.value().to(at::kDouble);
  return reference_decoder(exact, config, c.attributes.to(at::kDouble),
                           {c.position.to(at::kDouble), {}}, {c.anchor.to(at::kDouble), {}},
                           c.latent.to(at::kDouble), c.spacing);
}

DecoderCase cut(const DecoderCase& c, int64_t layers) {
  const at::NoGradGuard no_grad;
  DecoderCase out = c;
  out.config.query_layers = layers;
  out.decoder = nn::QueryDecoder(c.config.channels, out.config);
  out.decoder->eval();
  const auto from = c.decoder->named_parameters();
  for (auto& item : out.decoder->named_parameters()) item.value().copy_(from[item.key()]);
  return out;
}

std::vector<SceneAdversary> scene_adversaries(int64_t M) {
  const nn::PointSet points = box_scene(M, 33);
  nn::PointSet bright = points, coincident = points, constant = points;
  bright.emission = points.emission.clone();
  bright.emission[5].fill_(1e6f);
  coincident.position = points.position.clone();
  coincident.position.narrow(0, 0, 64).copy_(points.position[0].clone());
  constant.normal = torch::zeros_like(points.normal);
  constant.albedo = torch::zeros_like(points.albedo);
  constant.emission = torch::zeros_like(points.emission);
  return {{"random", 1e-5, 3e-2, points},
          {"one lamp 10^6 times the others", 1e-5, 3e-2, bright},
          {"64 coincident points", 1e-5, 3e-2, coincident},
          {"no features but positions", 1e-5, 3e-2, constant}};
}

}  // namespace lte::test
