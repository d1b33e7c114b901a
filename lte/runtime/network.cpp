#include "lte/runtime/network.h"

#include "lte/base/check.h"
#include "lte/base/checksum.h"
#include "lte/base/text.h"
#include "lte/data/scale_rounding.h"
#include "lte/nn/cost.h"
#include "lte/nn/files/model_file.h"
#include "lte/nn/model.h"
#include "lte/runtime/torch_errors.h"
#include "lte/runtime/torch_parts.h"

namespace lte::runtime {

struct Network::State {
  nn::LightTransportModel model;
  nn::ModelMetadata metadata;
  Device device;
  nn::Precision precision;
};

Network::Network(const std::filesystem::path& path, const NetworkOptions& options)
    : state_(std::make_shared<State>(State{nn::load_model(path), nn::read_model_metadata(path),
                                           options.device, options.precision})) {
  own_errors([&] { state_->model->to(torch_device(options.device)); });
  state_->model->eval();
  state_->model->set_precision(options.precision);
}

const nn::ModelConfig& Network::config() const { return state_->model->config(); }
const nn::ModelMetadata& Network::metadata() const { return state_->metadata; }
Device Network::device() const { return state_->device; }
nn::Precision Network::precision() const { return state_->precision; }
int64_t Network::parameters() const { return nn::count_parameters(state_->model).total; }

std::string Network::fingerprint() const {
  Checksum sum;
  sum.add(config().to_yaml());
  for (const auto& item : state_->model->named_parameters()) {
    const at::Tensor values = item.value().detach().to(at::kCPU).contiguous();
    sum.add(item.key());
    sum.add(values.const_data_ptr(), values.nbytes());
  }
  return formatted("%016llx", static_cast<unsigned long long>(sum.value()));
}

nn::LightTransportModel& TorchParts::model(const Network& network) { return network.state_->model; }

LightRequest Network::light_request() const {
  if (!config().reads_estimates()) return {};
  return {metadata().light_depth, metadata().light_paths};
}

void Network::check_fits(double extent_m, bool rescale) const {
  if (extent_m <= config().scale * (1 + data::kScaleRounding) || rescale) return;
  throw SceneTooLarge(concat("the scene spans ", extent_m, " m, the model knows scenes up to ",
                             config().scale, " m: set rescale to shrink it for the network"),
                      {Hint::Rescale});
}

}  // namespace lte::runtime
