// What stands behind the handles.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <c10/core/Event.h>

#include "lte/c_api.h"
#include "lte/nn/model.h"
#include "lte/nn/model_metadata.h"

namespace lte::c_api {

struct Network {
  nn::LightTransportModel model;
  nn::ModelMetadata metadata;
  at::Device device;
};

/// @param device  LTE_DEVICE_CPU or a CUDA device's number
/// @throws ApiError if there is no such device, lte::Error or c10::Error for the file.
std::shared_ptr<Network> open_network(const std::string& path, int32_t device);

class SceneEmbedding {
 public:
  /// @param memory  where the arrays of `points` are
  /// @throws ApiError, c10::Error
  SceneEmbedding(std::shared_ptr<Network> network, const lte_scene_points& points,
                 at::Device memory);

  const Network& network() const { return *network_; }
  lte_embedding_info info() const;
  void set_gain(const float* rgb);

  /// @param memory  where the arrays of `queries` and `irradiance` are
  void decode(const lte_queries& queries, at::Device memory, float* irradiance,
              int64_t stride) const;

 private:
  /// The embedding under the gain of this moment, ready on the current stream.
  nn::Embedding snapshot() const;

  std::shared_ptr<Network> network_;
  nn::Embedding embedding_;  ///< at gain 1
  int64_t scene_points_ = 0;
  std::optional<c10::Event> ready_;  ///< on CUDA: when the kernels that make it are through
  mutable std::mutex mutex_;         ///< for gain_
  std::array<double, 3> gain_ = {1, 1, 1};
};

}  // namespace lte::c_api
