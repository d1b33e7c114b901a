// The whole network: scene points -> light transport embedding -> irradiance at query points (the
// paper's section 3).
#pragma once

#include <cstdint>
#include <string>

#include <torch/nn/module.h>
#include <torch/nn/pimpl.h>

#include "lte/nn/config.h"
#include "lte/nn/light_cache.h"
#include "lte/nn/precision.h"

namespace lte::nn {

/// Scene points in world space, float32 (or float64 in gradient checks). M >= 1.
struct PointSet {
  at::Tensor position;  ///< [M, 3] metres
  at::Tensor normal;    ///< [M, 3] unit
  at::Tensor albedo;    ///< [M, 3]
  at::Tensor emission;  ///< [M, 3] radiance, W sr^-1 m^-2
  at::Tensor area;      ///< [M] m² each point stands for; weighs the radiance scalar only
  /// [M, 3] W/m², irradiance on both sides of the surface together, 0 at luminaires: direct, and an
  /// estimate of all later bounces. Read as the model's `light_input` says, else undefined will do.
  at::Tensor direct, indirect;
};

/// Query points in world space.
struct QuerySet {
  at::Tensor position;  ///< [Q, 3] metres
  at::Tensor normal;    ///< [Q, 3] unit, towards the side asked about
  at::Tensor albedo;    ///< [Q, 3]
};

/// The light transport embedding of one scene: everything decode() needs.
struct Embedding {
  at::Tensor position;  ///< [m, 3] network space
  at::Tensor features;  ///< [m, D]
  at::Tensor origin;    ///< [3] world, b_min
  double scale = 1;     ///< s, metres
  double spacing = 1;   ///< of the m points, network space: the last insertion distance of farthest
                        ///< point sampling
  at::Tensor radiance;  ///< [3] float64, channel_radiance() of the scene: emission is divided by
                        ///< it, irradiance multiplied
  at::Tensor table;     ///< ops::neighbour_table of all layers, made by encode() outside training;
                        ///< else undefined
  LightCache cache;     ///< of models whose `light_input` is traced
};

/// Where a scene lies in network space: p̂ = (p − origin) / scale.
struct Frame {
  at::Tensor origin;  ///< [3] world, at most every scene point; undefined: their least corner
  double scale = 0;   ///< metres; 0: the model's s. More shrinks a scene wider than s for the
                      ///< network alone, which moves no irradiance that comes from surfaces
};

/// @throws c10::Error naming the first row that is not finite, or out of range (docs/model.md)
void check_queries(const QuerySet& queries);

/// The emission scalar: area-weighted mean emission over points and channels; 1 for a scene without
/// emission.
double radiance_scalar(const PointSet& points);

/// The same by color channel, [3] float64 on the CPU; 0 for a channel without emission. No surface
/// moves light from one channel to another, so each channel of irradiance is linear in the same
/// channel of emission.
at::Tensor channel_radiance(const PointSet& points);

struct DecodeOptions {
  /// false for queries that check_queries() has seen or the caller answers for: on a GPU nothing
  /// then waits for it.
  bool check_values = true;
  int64_t block = 0;  ///< queries at a time, at most; 0 for a size that runs fast
};

/// Parameters: `nne.*`, `encoder.*`, `decoder.*` (checkpoint names; do not rename).
class LightTransportModelImpl : public torch::nn::Module {
 public:
  explicit LightTransportModelImpl(const ModelConfig& config);

  /// Embeds one scene. Differentiable in the parameters; under NoGradGuard it also makes the
  /// decoder's table. In training mode the curve orders are drawn from `order_seed`; in evaluation
  /// they are fixed. `frame` is for callers whose scene's bounds are not those of its points.
  /// @throws c10::Error naming the first row that is not finite, or a scene larger than `scale`
  /// (offering --rescale), or points below the frame's origin
  Embedding encode(const PointSet& points, uint64_t order_seed = 0, const Frame& frame = {});

  /// The arithmetic of encode() and decode() without gradients from now on, on the CPU. Rounds the
  /// weights that there are now: call it again when they have changed.
  void set_precision(Precision precision);

  /// Irradiance over the emission scalar: what the loss sees.
  /// @return [Q, 3], non-negative
  at::Tensor decode_normalized(const Embedding& embedding, const QuerySet& queries);

  /// Irradiance in W/m², [Q, 3]. Works through queries in blocks, so memory does not grow with Q
  /// beyond the output. Independent of block size and of the other queries to rounding.
  at::Tensor decode(const Embedding& embedding, const QuerySet& queries,
                    const DecodeOptions& options = {});

  const ModelConfig& config() const { return config_; }

 private:
  ModelConfig config_;
  struct Parts;
  std::shared_ptr<Parts> parts_;
};
TORCH_MODULE(LightTransportModel);

/// The arithmetic of all of a network's dense layers and convolutions, as
/// LightTransportModel::set_precision().
void set_precision(torch::nn::Module& network, Precision precision);

/// The arithmetic of all of a network's dense layers and convolutions where gradients are asked
/// for, from now on: Bf16 rounds what their products read, forward and backward, and leaves
/// weights, sums, results and gradients in float32. On CUDA attention too. Without gradients
/// nothing changes.
void set_autocast(torch::nn::Module& network, Precision precision);

/// Sizes in parameters: total, nne (F and both G), encoder (PTV3), decoder.
struct ParameterCounts {
  int64_t total = 0, nne = 0, encoder = 0, decoder = 0;
};
ParameterCounts count_parameters(const LightTransportModel& model);

}  // namespace lte::nn
