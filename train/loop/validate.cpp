#include "train/loop/validate.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <torch/types.h>

namespace lte::train {
namespace {

struct SceneErrors {
  double loss = 0, mse = 0, psnr = 0, relmse = 0, bias = 0;
};

SceneErrors scene_errors(const at::Tensor& predicted, const at::Tensor& target,
                         const nn::LossConfig& config) {
  constexpr double kEpsilon = 1e-2, kPsnrLimit = 100;
  SceneErrors errors;
  errors.loss = nn::relative_loss(predicted, target, config).item<double>();
  const at::Tensor reference = target.to(at::kDouble);
  const at::Tensor difference = predicted.to(at::kDouble) - reference;
  const at::Tensor square = difference.square();
  errors.mse = square.mean().item<double>();
  errors.relmse = (square / (reference.square() + kEpsilon)).mean().item<double>();
  const double peak = reference.max().item<double>(), mean = reference.mean().item<double>();
  errors.bias = mean > 0 ? difference.mean().item<double>() / mean : 0;
  const double white = peak > 0 ? peak : 1;  // a black scene has no brightest value
  errors.psnr = errors.mse > 0 ? std::min(10 * std::log10(white * white / errors.mse), kPsnrLimit)
                               : kPsnrLimit;
  return errors;
}

/// Adds the errors of radiance in a scene, which is one of `count`, if the model predicts it.
/// @return its loss
double add_radiance(nn::LightTransportModel& model, const nn::Embedding& embedding,
                    const RadianceExample& example, const nn::LossConfig& loss, double count,
                    ValidationResult* result) {
  if (!model->config().predicts_radiance()) return 0;
  const SceneErrors errors =
      scene_errors(model->decode_radiance_normalized({{embedding}, embedding.features},
                                                     {example.queries}, {example.directions})[0],
                   example.target, loss);
  if (!result->radiance) result->radiance = RadianceErrors{};
  result->radiance->loss += errors.loss / count;
  result->radiance->relmse += errors.relmse / count;
  result->radiance->bias += errors.bias / count;
  return errors.loss;
}

}  // namespace

std::vector<std::pair<std::string, double>> ValidationResult::fields() const {
  std::vector<std::pair<std::string, double>> out{
      {"val_loss", loss}, {"val_loss_median", loss_median}, {"val_mse", mse},
      {"val_psnr", psnr}, {"val_relmse", relmse},           {"val_bias", bias}};
  if (radiance) {
    out.emplace_back("val_radiance_loss", radiance->loss);
    out.emplace_back("val_radiance_relmse", radiance->relmse);
    out.emplace_back("val_radiance_bias", radiance->bias);
  }
  for (const KindErrors& errors : kinds) {
    out.emplace_back("val_loss_" + errors.kind, errors.loss);
    out.emplace_back("val_mse_" + errors.kind, errors.mse);
  }
  return out;
}

std::string scene_kind(const std::string& scene) {
  const size_t end = scene.find_last_not_of("0123456789");
  if (end == std::string::npos) return scene;
  return scene.substr(0, scene[end] == '_' && end > 0 ? end : end + 1);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

ValidationResult validate(nn::LightTransportModel& model, const std::vector<Example>& examples,
                          const SceneLossConfig& config, at::Device device) {
  const torch::NoGradGuard no_grad;
  const bool was_training = model->is_training();
  model->eval();
  ValidationResult result;
  std::vector<double> losses;
  std::map<std::string, KindErrors> kinds;
  const auto count = static_cast<double>(examples.size());
  for (const Example& stored : examples) {
    const Example example = stored.to(device);
    const nn::Embedding embedding = model->encode(example.points, example.seed);
    SceneErrors errors = scene_errors(model->decode_normalized(embedding, example.queries),
                                      example.target, config.loss);
    errors.loss = config.irradiance_weight * errors.loss +
                  add_radiance(model, embedding, example.radiance, config.loss, count, &result);
    losses.push_back(errors.loss);
    result.scenes.emplace_back(example.scene, errors.loss);
    KindErrors& kind = kinds[scene_kind(example.scene)];
    ++kind.scenes;
    kind.loss += errors.loss;
    kind.mse += errors.mse;
    result.loss += errors.loss / count;
    result.mse += errors.mse / count;
    result.psnr += errors.psnr / count;
    result.relmse += errors.relmse / count;
    result.bias += errors.bias / count;
  }
  result.loss_median = median(losses);
  if (kinds.size() == 1) kinds.clear();
  for (const auto& [name, kind] : kinds) {
    const auto scenes = static_cast<double>(kind.scenes);
    result.kinds.push_back({name, kind.scenes, kind.loss / scenes, kind.mse / scenes});
  }
  model->train(was_training);
  return result;
}

}  // namespace lte::train
