// Pictures of a scene: the network's indirect light and sampled direct light at primary hits, or
// the path-traced reference of the same quantities.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "infer/light/embedding_draws.h"
#include "infer/light/light_table.h"
#include "infer/picture/frame.h"
#include "infer/renderer/picture_needs.h"
#include "infer/renderer/render_settings.h"
#include "infer/renderer/shared_denoiser.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/runtime/embedding.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// The BVH, the lights and the embeddings, if any, of a scene, which must outlive it. Camera moves
/// re-encode nothing.
class Renderer {
 public:
  explicit Renderer(const scene::Scene& scene);
  /// Over what others hold too: renderers of one scene in several threads, each its own.
  Renderer(std::shared_ptr<const pathtrace::Bvh> bvh,
           std::shared_ptr<const pathtrace::Lights> lights,
           std::shared_ptr<SharedDenoiser> denoiser);

  /// Samples scene points and encodes them, as often as settings.draws says.
  /// @throws runtime::Refusal for a scene wider than the model knows, unless settings.rescale, and
  ///         where memory lacks.
  void embed(const runtime::Network& network, const EmbedSettings& settings);

  /// Takes an embedding of this scene that was made before, in the place of embed().
  void set_embedding(runtime::SceneEmbedding embedding);
  void set_embedding(std::shared_ptr<const runtime::SceneEmbedding> embedding);
  /// The first one. @throws lte::Error without any.
  const runtime::SceneEmbedding& embedding() const { return *draws_.first(); }
  std::shared_ptr<const runtime::SceneEmbedding> shared_embedding() const { return draws_.first(); }
  /// What answers: all that embed() made.
  const EmbeddingDraws& draws() const { return draws_; }

  /// Makes the table that Indirect::Gather reads, in the place of the last one.
  /// @throws lte::Error if the network is to fill it and embed() has not been called.
  void make_table(const TableSettings& settings);
  /// Takes a table of this scene that others hold too.
  void set_table(std::shared_ptr<const gi::RadiosityTable> table);
  /// @throws lte::Error without one.
  const gi::RadiosityTable& table() const;
  bool has_table() const { return table_ != nullptr; }

  /// @throws lte::Error if the network or the table is needed and embed() or make_table() has not
  ///         been called.
  Frame render(const scene::Camera& camera, const RenderSettings& settings);

  /// What a picture of this scene by the embedding that stands needs.
  PictureNeeds needs(const RenderSettings& settings) const;

  /// What took noise away in the last render(): image::Denoiser::description(), or nothing.
  const std::string& denoised_by() const { return denoised_by_; }

  bool has_light() const { return !lights_.empty(); }
  bool has_environment() const { return lights_.has_environment(); }
  const pathtrace::Bvh& bvh() const { return bvh_; }
  const pathtrace::Lights& lights() const { return lights_; }
  StageSeconds& seconds() { return seconds_; }
  /// Counts of the last embed(); zeros if it did not prune.
  const pathtrace::PruneCounts& pruned_points() const { return pruned_points_; }
  /// Light groups that the last embed() did not tell the network of, as they reach nothing.
  const std::vector<int>& left_out() const { return left_out_; }

 private:
  std::shared_ptr<const runtime::SceneEmbedding> encode(const runtime::Network& network,
                                                        const EmbedSettings& settings);

  std::shared_ptr<const pathtrace::Bvh> held_bvh_;
  std::shared_ptr<const pathtrace::Lights> held_lights_;
  const pathtrace::Bvh& bvh_;
  const pathtrace::Lights& lights_;
  EmbeddingDraws draws_;
  std::shared_ptr<const gi::RadiosityTable> table_;
  std::optional<KeptViews> kept_;  ///< of RenderSettings::keep_light
  StageSeconds seconds_;
  std::shared_ptr<SharedDenoiser> denoiser_;
  std::string denoised_by_;
  pathtrace::PruneCounts pruned_points_;
  std::vector<int> left_out_;
};

}  // namespace lte::infer
