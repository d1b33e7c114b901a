#include "infer/common/predictor.h"

#include <cstring>
#include <optional>

#include <ATen/core/grad_mode.h>

#include "infer/common/tensors.h"
#include "lte/base/check.h"
#include "lte/nn/cost.h"
#include "lte/nn/model.h"
#include "lte/nn/model_file.h"
#include "lte/nn/model_metadata.h"
#include "lte/nn/one_line_errors.h"

namespace lte::infer {
namespace {

using nn::one_line_errors;

// Keeps the rescaled extent under s after rounding.
constexpr double kShrinkMargin = 1e-5;
// Of paths in baked data (DESIGN section 5).
constexpr int kTracedDepth = 5;

nn::PointSet to_point_set(const ScenePoints& points, std::span<const Vec3> position,
                          const at::Device& device) {
  const auto light = [&](std::span<const Rgb> values) {
    return values.empty() ? at::Tensor() : borrow(values).to(device);
  };
  return {borrow(position).to(device),
          borrow(points.normal).to(device),
          borrow(points.albedo).to(device),
          borrow(points.emission).to(device),
          borrow(points.area).to(device),
          light(points.direct),
          light(points.indirect)};
}

void check_sizes(const ScenePoints& points) {
  const size_t size = points.position.size();
  LTE_CHECK(size > 0, "a scene needs at least one scene point");
  LTE_CHECK(points.normal.size() == size && points.albedo.size() == size &&
                points.emission.size() == size && points.area.size() == size,
            "scene point arrays differ in length: ", size, " positions, ", points.normal.size(),
            " normals, ", points.albedo.size(), " albedos, ", points.emission.size(),
            " emissions, ", points.area.size(), " areas");
  for (const auto& light : {points.direct, points.indirect}) {
    LTE_CHECK(light.empty() || light.size() == size, "scene point arrays differ in length: ", size,
              " positions, ", light.size(), " irradiances");
  }
}

}  // namespace

struct Predictor::State {
  explicit State(nn::LightTransportModel loaded) : model(std::move(loaded)) {}

  nn::LightTransportModel model;
  at::Device device{at::kCPU};
  nn::ModelMetadata metadata;
  std::optional<nn::Embedding> embedding;
  MemoryLimit memory;
  // World -> what the network was shown: (p − low) shrink.
  Vec3 low;
  double shrink = 1;

  std::vector<Vec3> moved(std::span<const Vec3> positions) const {
    std::vector<Vec3> out(positions.begin(), positions.end());
    for (Vec3& p : out) p = (p - low) * static_cast<float>(shrink);
    return out;
  }
};

double radiance_scalar(const ScenePoints& points) {
  check_sizes(points);
  return nn::mean_emission(to_point_set(points, points.position, at::kCPU));
}

Predictor Predictor::load(const std::filesystem::path& checkpoint, Device device,
                          nn::Precision precision) {
  auto state = std::make_shared<State>(one_line_errors([&] { return nn::load_model(checkpoint); }));
  state->metadata = nn::read_model_metadata(checkpoint);
  state->device = at::Device(device == Device::Cuda ? at::kCUDA : at::kCPU);
  state->model->to(state->device);
  state->model->eval();
  state->model->set_precision(precision);
  return Predictor(std::move(state));
}

bool Predictor::predicts_total() const { return state_->model->config().predicts_total(); }
int Predictor::light_depth() const {
  const nn::ModelConfig& config = state_->model->config();
  return config.reads_indirect() ? kTracedDepth : config.reads_direct() ? 1 : 0;
}
double Predictor::scale() const { return state_->model->config().scale; }
int64_t Predictor::scene_points() const { return state_->metadata.scene_points; }
bool Predictor::scene_points_pruned() const { return state_->metadata.scene_points_pruned; }
int64_t Predictor::parameters() const { return nn::count_parameters(state_->model).total; }
double Predictor::shrink() const { return state_->shrink; }

void Predictor::limit_memory(const MemoryLimit& limit) { state_->memory = limit; }

double Predictor::radiance() const {
  LTE_CHECK(state_->embedding.has_value(), "no scene has been embedded");
  const double mean = state_->embedding->radiance.mean().item<double>();
  return mean > 0 ? mean : 1;
}

void Predictor::check_fits(const Bounds& bounds, bool rescale) const {
  const double extent = max_component(bounds.extent());
  LTE_CHECK(extent <= scale() || rescale, "the scene spans ", extent,
            " m, the model knows scenes up to ", scale(),
            " m: pass --rescale to shrink it for the network");
}

void Predictor::embed(const ScenePoints& points, bool rescale) {
  check_sizes(points);
  Bounds bounds;
  for (const Vec3& p : points.position) bounds.extend(p);
  const double extent = max_component(bounds.extent());
  const bool too_large = extent > scale();
  check_fits(bounds, rescale);
  state_->low = too_large ? bounds.low : Vec3{};
  state_->shrink = too_large ? scale() / extent * (1 - kShrinkMargin) : 1;
  const std::vector<Vec3> shown = too_large ? state_->moved(points.position) : std::vector<Vec3>();
  const at::NoGradGuard no_grad;
  state_->embedding.reset();
  const nn::ModelConfig& config = state_->model->config();
  state_->memory.check_encoding(config, points.size());
  state_->embedding = explain_out_of_memory(
      concat("encoding ", points.size(), " scene points"), encode_mb(config, points.size()),
      "take fewer scene points (--scene-points)", [&] {
        return one_line_errors([&] {
          return state_->model->encode(to_point_set(
              points, too_large ? std::span<const Vec3>(shown) : points.position, state_->device));
        });
      });
}

std::vector<Rgb> Predictor::predict(const QueryPoints& queries, int64_t chunk) const {
  LTE_CHECK(state_->embedding.has_value(), "no scene has been embedded");
  LTE_CHECK(chunk > 0, "chunk is ", chunk, ", expected a positive number");
  LTE_CHECK(queries.normal.size() == queries.position.size() &&
                queries.albedo.size() == queries.position.size(),
            "query arrays differ in length: ", queries.position.size(), " positions, ",
            queries.normal.size(), " normals, ", queries.albedo.size(), " albedos");
  const at::NoGradGuard no_grad;
  const nn::ModelConfig& config = state_->model->config();
  chunk = state_->memory.query_block(config, queries.size(), chunk);
  std::vector<Rgb> out(queries.position.size());
  for (int64_t begin = 0; begin < queries.size(); begin += chunk) {
    const QueryPoints part = queries.slice(begin, std::min(chunk, queries.size() - begin));
    const std::vector<Vec3> shown =
        state_->shrink == 1 ? std::vector<Vec3>() : state_->moved(part.position);
    const nn::QuerySet set{
        borrow(shown.empty() ? part.position : std::span<const Vec3>(shown)).to(state_->device),
        borrow(part.normal).to(state_->device), borrow(part.albedo).to(state_->device)};
    const at::Tensor irradiance = explain_out_of_memory(
        concat("decoding ", queries.size(), " queries"), decode_mb(config, queries.size(), chunk),
        "ask for fewer at once (a smaller picture), or decode fewer at a time (--max-memory)", [&] {
          return one_line_errors([&] {
            return state_->model->decode(*state_->embedding, set)
                .to(at::kCPU, at::kFloat)
                .contiguous();
          });
        });
    std::memcpy(static_cast<void*>(out.data() + begin), irradiance.const_data_ptr<float>(),
                sizeof(Rgb) * part.position.size());
  }
  return out;
}

}  // namespace lte::infer
