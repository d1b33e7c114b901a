// A trained model and the embedding of one scene: irradiance at any surface point, without Embree
// or a scene file.
//
// The embedding is made once; every camera and every set of query points reads it. This header does
// not include LibTorch.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "infer/common/device.h"
#include "infer/common/memory.h"
#include "infer/common/points.h"
#include "lte/nn/precision.h"

namespace lte::infer {

/// Area-weighted mean emission over points and channels, 1 without emission: what irradiance is
/// divided by in training.
double radiance_scalar(const ScenePoints& points);

class Predictor {
 public:
  /// @throws lte::Error naming the file if it is no model of this version.
  static Predictor load(const std::filesystem::path& checkpoint, Device device,
                        nn::Precision precision = nn::Precision::Fp32);

  /// From now on embed() refuses what would not fit, and predict() decodes no more at a time than
  /// does.
  void limit_memory(const MemoryLimit& limit);

  bool predicts_total() const;  ///< the output is total irradiance, not indirect
  /// What embed() wants of the light on scene points: 0 for nothing, 1 for direct irradiance, more
  /// for the irradiance of later bounces too, of paths of so many surface hits.
  int light_depth() const;
  double scale() const;          ///< s, metres: the largest scene extent that the network knows
  int64_t scene_points() const;  ///< M of the training, 20,000 if the checkpoint does not say
  /// Training saw scene points only where light reaches them.
  bool scene_points_pruned() const;
  int64_t parameters() const;

  /// @throws lte::Error, offering --rescale, if `bounds` span more than s and `rescale` is false.
  void check_fits(const Bounds& bounds, bool rescale) const;

  /// Replaces the embedding.
  /// @param rescale  shrinks a scene larger than s into it, for the network only. Exact for
  /// transport: uniform scaling
  ///                 of a scene changes no irradiance that comes from surfaces.
  /// @throws lte::Error for a scene larger than s without `rescale`, or input that is not finite,
  /// or without the light that light_depth() asks for, or where memory lacks or is limited, naming
  /// what it needs.
  void embed(const ScenePoints& points, bool rescale = false);

  /// Irradiance in W/m², one entry a query. embed() comes first.
  /// @param chunk  queries a block: memory beyond the result does not grow with their number, nor
  /// does the result depend
  ///               on it (to rounding)
  std::vector<Rgb> predict(const QueryPoints& queries, int64_t chunk = 1 << 16) const;

  /// The emission scalar of the embedded scene.
  double radiance() const;
  /// What --rescale multiplied lengths by; 1 if nothing.
  double shrink() const;

 private:
  struct State;
  explicit Predictor(std::shared_ptr<State> state) : state_(std::move(state)) {}
  std::shared_ptr<State> state_;
};

}  // namespace lte::infer
