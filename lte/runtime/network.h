// A trained network that is ready to use: loaded, on its device, in its precision.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "lte/nn/blocks/precision.h"
#include "lte/nn/config.h"
#include "lte/nn/files/model_metadata.h"
#include "lte/runtime/device.h"
#include "lte/runtime/limit_error.h"

namespace lte::runtime {

using nn::ModelConfig;
using nn::ModelMetadata;
using nn::Precision;

struct NetworkOptions {
  Device device = {};
  Precision precision = Precision::Fp32;
};

/// The estimates of light on either side of scene points that a network reads, as they were made
/// for its training.
struct LightRequest {
  int depth = 0;  ///< surface hits of their paths; 0: it reads none
  int paths = 0;  ///< a side of each point
};

/// A handle: copies share the weights. Nothing about it changes once it is made, so any number of
/// threads and scenes may use it at the same time.
class Network {
 public:
  /// @throws lte::Error naming the file if it is no model of this version; NotEnoughMemory
  ///         if the device has no room for it.
  explicit Network(const std::filesystem::path& path, const NetworkOptions& options = {});

  const ModelConfig& config() const;
  const ModelMetadata& metadata() const;
  Device device() const;
  Precision precision() const;
  /// 16 hexadecimal digits of its configuration and of every weight, whatever file they came from.
  /// Reads all weights.
  std::string fingerprint() const;
  int64_t parameters() const;
  LightRequest light_request() const;

  /// @param extent_m  the widest side of a scene's bounds
  /// @throws SceneTooLarge if that is more than the model knows, but for rounding, and `rescale` is
  ///         false.
  void check_fits(double extent_m, bool rescale) const;
  /// Metres, a quarter of the model's scale: few scenes of training are narrower at their widest.
  double least_extent() const { return config().scale / 4; }

 private:
  friend struct TorchParts;
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace lte::runtime
