#include "train/loop/scene_loss.h"

#include <algorithm>

namespace lte::train {

std::vector<at::Tensor> scene_losses(nn::LightTransportModel& model, const nn::SceneBatch& batch,
                                     const std::vector<Example>& examples,
                                     const SceneLossConfig& config, nn::Values values) {
  std::vector<at::Tensor> losses(examples.size());
  const auto add = [&](size_t i, const at::Tensor& loss) {
    losses[i] = losses[i].defined() ? losses[i] + loss : loss;
  };
  if (config.irradiance_weight > 0) {
    std::vector<nn::QuerySet> queries;
    for (const Example& example : examples) queries.push_back(example.queries);
    const std::vector<at::Tensor> predicted = model->decode_normalized(batch, queries, values);
    for (size_t i = 0; i < examples.size(); ++i) {
      const at::Tensor loss = nn::relative_loss(predicted[i], examples[i].target, config.loss);
      add(i, config.irradiance_weight == 1 ? loss : loss * config.irradiance_weight);
    }
  }
  if (!model->config().predicts_radiance()) return losses;
  std::vector<nn::QuerySet> points;
  std::vector<at::Tensor> directions;
  for (const Example& example : examples) {
    points.push_back(example.radiance.queries);
    directions.push_back(example.radiance.directions);
  }
  const std::vector<at::Tensor> predicted =
      model->decode_radiance_normalized(batch, points, directions);
  for (size_t i = 0; i < examples.size(); ++i)
    add(i, nn::relative_loss(predicted[i], examples[i].radiance.target, config.loss));
  return losses;
}

bool trains_encoder(const nn::LightTransportModel& model) {
  const auto parameters = model->named_parameters();
  return std::any_of(parameters.begin(), parameters.end(), [](const auto& item) {
    const bool decodes = item.key().starts_with("decoder.") || item.key().starts_with("radiance.");
    return !decodes && item.value().requires_grad();
  });
}

void freeze_parameters(const OptimConfig& config, nn::LightTransportModel& model) {
  for (auto& item : model->named_parameters())
    item.value().requires_grad_(rate_factor(config, item.key()) > 0);
}

}  // namespace lte::train
