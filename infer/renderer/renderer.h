// A scene with what its pictures share: BVH, lights, the embedding of a network, an irradiance
// cache; and pictures of it, by lte/render.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "infer/renderer/render_settings.h"
#include "lte/gi/irradiance_cache.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/render/shared_denoiser.h"
#include "lte/runtime/embedding.h"
#include "lte/scene/scene.h"

namespace lte::infer {

using render::SharedDenoiser;

/// The scene must outlive it. Camera moves re-encode nothing.
class Renderer {
 public:
  explicit Renderer(const scene::Scene& scene);
  /// Over what others hold too: renderers of one scene in several threads, each its own.
  Renderer(std::shared_ptr<const pathtrace::Bvh> bvh,
           std::shared_ptr<const pathtrace::Lights> lights,
           std::shared_ptr<SharedDenoiser> denoiser);

  /// Samples scene points and encodes them.
  /// @throws runtime::LimitError for a scene wider than the model knows, unless settings.rescale,
  ///         and where memory lacks.
  void embed(const runtime::Network& network, const EmbedSettings& settings);

  /// Takes an embedding of this scene that was made before, in the place of embed().
  void set_embedding(runtime::SceneEmbedding embedding);
  void set_embedding(std::shared_ptr<const runtime::SceneEmbedding> embedding);
  /// @throws lte::Error without one.
  const runtime::SceneEmbedding& embedding() const { return *shared_embedding(); }
  const std::shared_ptr<const runtime::SceneEmbedding>& shared_embedding() const;
  /// The embedding's answers, as records of a cache take them.
  render::IrradianceSource source() const;

  /// Makes the irradiance cache that Method::Gather and Method::Network read, in the place of the
  /// last one.
  /// @throws lte::Error if the network is to fill it and embed() has not been called.
  void make_cache(Method method, const render::CacheSettings& settings);
  /// Takes a cache of this scene that others hold too.
  void set_cache(std::shared_ptr<const gi::IrradianceCache> cache);
  bool has_cache() const { return cache_ != nullptr; }
  /// @throws lte::Error without one.
  const gi::IrradianceCache& cache() const;

  /// @throws lte::Error if make_cache() is needed and has not been called; PictureStopped.
  Frame render(const scene::Camera& camera, const RenderSettings& settings);

  /// Whether a picture reads an irradiance cache.
  bool needs_cache(const RenderSettings& settings) const;

  /// What took noise away in the last render(): image::Denoiser::description(), or nothing.
  const std::string& denoised_by() const { return denoised_by_; }
  /// Passes of the last render(): by the integrator, and of paths.
  int passes() const { return passes_; }
  int path_passes() const { return path_passes_; }

  bool has_light() const { return !lights_.empty(); }
  bool has_environment() const { return lights_.has_environment(); }
  const pathtrace::Bvh& bvh() const { return bvh_; }
  const pathtrace::Lights& lights() const { return lights_; }
  StageSeconds& seconds() { return seconds_; }
  /// Counts of the last embed(); zeros if it did not prune.
  const pathtrace::PruneCounts& pruned_points() const { return pruned_points_; }
  /// Light groups that the network of the last embed() does not read, as they reach nothing.
  const std::vector<int>& culled_lights() const { return culled_lights_; }

 private:
  std::unique_ptr<render::Integrator> integrator(const RenderSettings& settings) const;
  double denoising_seconds(int width, int height, image::OidnQuality quality);

  std::shared_ptr<const pathtrace::Bvh> held_bvh_;
  std::shared_ptr<const pathtrace::Lights> held_lights_;
  const pathtrace::Bvh& bvh_;
  const pathtrace::Lights& lights_;
  const bool all_metal_;
  std::shared_ptr<const runtime::SceneEmbedding> embedding_;
  std::shared_ptr<const gi::IrradianceCache> cache_;
  StageSeconds seconds_;
  std::shared_ptr<SharedDenoiser> denoiser_;
  std::string denoised_by_;
  int passes_ = 0, path_passes_ = 0;
  pathtrace::PruneCounts pruned_points_;
  std::vector<int> culled_lights_;
};

/// What the film and the picture take in memory, in MiB.
double picture_mb(int width, int height);
/// @throws runtime::NotEnoughMemory where that fits neither the limit nor what is free
void check_picture_fits(int width, int height, const runtime::MemoryLimit& limit);

}  // namespace lte::infer
