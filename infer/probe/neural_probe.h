// Irradiance at points by the network, and what tells how wrong it may be.
#pragma once

#include <cstdint>
#include <vector>

#include "infer/probe/expected_error.h"
#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/probe.h"
#include "lte/runtime/embedding.h"
#include "lte/scene/point_table.h"

namespace lte::infer {

/// The albedo at each point, which the network reads: that of the surface that it lies on.
struct PointAlbedo {
  std::vector<Rgb> albedo;  ///< kFreeAlbedo for points on no surface
  int64_t off_surface = 0;  ///< how many those are
};

/// Looks along each normal for a surface within kSurfaceDistance of the scene's extent.
PointAlbedo albedo_at(const pathtrace::Bvh& bvh, const scene::PointTable& points);

inline constexpr float kSurfaceDistance = 1e-3f;
inline constexpr Rgb kFreeAlbedo{0.5f, 0.5f, 0.5f};

/// How near to each point surfaces are that it sees: the mean, over its hemisphere weighted by the
/// cosine, of `reach` over the distance, at most 1. 0 in the open, near 0.5 at the foot of a wall.
/// @param reach  metres
std::vector<double> nearness_at(const pathtrace::Bvh& bvh, const scene::PointTable& points,
                                double reach);

/// Metres between the latents of an embedding: what lies nearer is one place to the encoder.
double latent_spacing(const runtime::SceneEmbedding& embedding);

/// What one embedding says at points; the last two as ErrorTerms has them.
struct PointAnswers {
  std::vector<Rgb> irradiance;  ///< indirect or total, by the target
  std::vector<double> change, cache;
};
PointAnswers ask_at(const runtime::SceneEmbedding& embedding, const scene::PointTable& points,
                    const std::vector<Rgb>& albedo);

/// Several answers to the same questions, each by an embedding of points and light estimates of its
/// own.
class Draws {
 public:
  void add(PointAnswers answers);

  size_t count() const { return answers_.size(); }
  /// The mean over the draws.
  std::vector<Rgb> mean() const;
  /// Of the mean at each point.
  /// @param nearness  nearness_at() the points
  /// @param direct    light there, W/m²
  std::vector<ErrorTerms> error_terms(const std::vector<double>& nearness,
                                      const std::vector<Rgb>& direct) const;

 private:
  /// What of the mean's error the draws tell: its standard error, root mean square over the
  /// channels; 0 of a single draw.
  double standard_error(size_t point, const Rgb& middle) const;

  std::vector<PointAnswers> answers_;
};

/// Root of the mean square over the channels.
double rms(const Rgb& value);

}  // namespace lte::infer
