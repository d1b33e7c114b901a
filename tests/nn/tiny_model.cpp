#include "tests/nn/tiny_model.h"

#include <cmath>

#include "lte/nn/files/model_file.h"
#include "lte/nn/model.h"
#include "lte/tensor/functions.h"
#include "tests/nn/support.h"

namespace lte::test {

nn::ModelConfig tiny_config() {
  nn::ModelConfig config;
  config.channels = 16;
  config.nne_neighbours = 4;
  config.encoder_depths = {1, 1, 2};
  config.encoder_widths = {1, 1, 2};
  config.decoder_depths = {2, 1};
  config.decoder_widths = {1, 2};
  config.head_width = 8;
  config.patch_size = 8;
  config.dropout = 0;
  config.query_neighbours = 5;
  config.query_layers = 2;
  return config;
}

nn::ModelConfig tiny_geometric_config() {
  nn::ModelConfig config = tiny_config();
  config.preset = nn::Preset::Lte;
  return config;
}

void randomize(torch::nn::Module& module, uint64_t seed) {
  const at::NoGradGuard no_grad;
  at::manual_seed(seed);
  for (at::Tensor parameter : module.parameters()) {
    const double fan = parameter.dim() > 1 ? static_cast<double>(parameter.size(-1)) : 4.0;
    parameter.normal_(0, 1 / std::sqrt(fan));
  }
}

void save_random_model(const std::filesystem::path& path, const nn::ModelConfig& config,
                       const std::map<std::string, std::string>& metadata) {
  nn::LightTransportModel model(config);
  randomize(*model, 5);
  nn::save_model(path, model, metadata);
}

void save_tiny_model(const std::filesystem::path& path, const TinyModel& tiny) {
  nn::ModelConfig config;
  config.channels = tiny.channels;
  config.nne_neighbours = 8;
  config.encoder_depths = {1, 1, 1, 1, 1};
  config.encoder_widths = {1, 1, 1, 1, 1};
  config.decoder_depths = {1, 1, 1, 1};
  config.decoder_widths = {1, 1, 1, 1};
  config.patch_size = 64;
  config.query_neighbours = 8;
  config.query_layers = 2;
  config.light_input = tiny.light_input;
  config.scale = tiny.scale;
  config.radiance_lobes = tiny.radiance_lobes;
  if (config.predicts_radiance() && !config.reads_light())
    config.light_input = nn::LightInput::Radiosity;
  at::manual_seed(tiny.seed);
  const nn::LightTransportModel model(config);
  if (tiny.even_radiance) {
    const at::NoGradGuard no_grad;
    model->named_parameters()["radiance.color.weight"].zero_();
    at::Tensor bias = model->named_parameters()["radiance.color.bias"];
    bias.narrow(0, 0, 3).fill_(*tiny.even_radiance);
    bias.narrow(0, 3, 3).fill_(-80);  // a factor of 0 on what rays see
  }
  nn::save_model(path, model,
                 {{"scene_points", std::to_string(tiny.scene_points)},
                  {"scene_points_pruned", tiny.pruned ? "true" : "false"},
                  {"suns", tiny.suns ? "true" : "false"}});
}

}  // namespace lte::test
