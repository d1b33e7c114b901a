// Pictures of a scene: the network's indirect light and sampled direct light at primary hits, or
// the path-traced reference of the same quantities.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "infer/light/light_table.h"
#include "infer/picture/frame.h"
#include "infer/picture/output.h"
#include "infer/picture/picture_band.h"
#include "infer/picture/ray_pace.h"
#include "infer/renderer/centre_light.h"
#include "infer/renderer/gathered_light.h"
#include "infer/renderer/shared_denoiser.h"
#include "lte/gi/sparse_pixels.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights.h"
#include "lte/pathtrace/reach.h"
#include "lte/pathtrace/render.h"
#include "lte/runtime/embedding.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// Hits in a pixel at an edge, unless told otherwise.
inline constexpr int kAntialias = 16;

/// Directions a pixel whose radiance the decoder is asked for, unless told otherwise.
inline constexpr int kReflections = 16;

struct RenderSettings {
  Output output = Output::Full;
  Mode mode = Mode::Neural;
  int width = 512, height = 512;
  Indirect indirect = Indirect::Network;
  GatherSettings gather;  ///< of Indirect::Gather, which takes its noise away unless `denoise` is
                          ///< off
  /// Of Indirect::Gather at few pixels (gather.step): light that earlier pictures since
  /// make_table() have found is taken again, and what this one finds is kept. So a picture depends
  /// on those before it.
  bool keep_light = false;
  int direct_samples = 64;  ///< shadow rays a pixel
  /// Share them out over pixels, more where penumbrae are: direct_samples is their mean.
  bool adaptive_direct = false;
  /// Take noise away: of sampled direct light; of a reference, all that paths have found. Auto:
  /// of direct light by few samples (kDenoiseUpTo).
  Denoise denoise = Denoise::Off;
  int spp = 64;       ///< paths a pixel: in reference mode, and for what is traced in neural
  int max_depth = 5;  ///< of these paths: surface hits after the primary one
  uint64_t seed = 0;
  /// Hits in a pixel at an edge; 0 or 1 for the centre's alone. A reference of the full output
  /// spreads its paths over the pixel and needs none.
  int antialias = kAntialias;
  /// What stands for metal in light outputs; Irradiance shows it like any surface. Reference mode
  /// always traces it.
  Metal metal = Metal::Trace;
  /// Directions a pixel from which Metal::Network asks for radiance.
  int reflections = kReflections;
  /// Neural mode: ask few pixels for indirect light and take the others' from them; otherwise all.
  std::optional<gi::SparseOptions> sparse;
  /// Neural mode: what answers in the place of the network's decoder. May be null.
  gi::Answerer answerer;
  /// Neural mode: chooses the shadow rays in the place of `direct_samples`. May be null.
  RayPace* pace = nullptr;
  /// Keep the layers of the frame. Without, it has its color and depth alone, and takes a fifth of
  /// the memory.
  bool layers = true;
  /// Told of pixels as they are done, width * height in all, by any thread.
  std::function<void(int64_t pixels)> done;
};

struct EmbedSettings {
  int64_t scene_points = 0;  ///< M; 0 for that of the model's training
  uint64_t seed = 0;
  bool rescale = false;
  /// Draw scene points only where light reaches them (pathtrace/reach.h); by default as in the
  /// model's training.
  std::optional<bool> prune;
  runtime::MemoryLimit memory;    ///< of encoding, and of every later picture's decoding
  bool record_attention = false;  ///< keep what the encoder's blocks attend to
};

/// Wall-clock seconds by stage; `load` and `write` belong to the caller. `light` is the time of the
/// estimates on scene points, for models that read them; `table` and `gather` belong to
/// Indirect::Gather, whose correcting paths are in `reference`.
struct StageSeconds {
  double load = 0, sample = 0, light = 0, encode = 0, table = 0, primary = 0, decode = 0;
  double gather = 0, direct = 0, denoise = 0, reference = 0, write = 0;
};

/// The stages in the order in which they run.
struct Stage {
  const char* name;
  double StageSeconds::*seconds;
};
inline constexpr std::array<Stage, 12> kStages = {{{"load", &StageSeconds::load},
                                                   {"sample", &StageSeconds::sample},
                                                   {"light", &StageSeconds::light},
                                                   {"encode", &StageSeconds::encode},
                                                   {"table", &StageSeconds::table},
                                                   {"primary", &StageSeconds::primary},
                                                   {"decode", &StageSeconds::decode},
                                                   {"gather", &StageSeconds::gather},
                                                   {"direct", &StageSeconds::direct},
                                                   {"denoise", &StageSeconds::denoise},
                                                   {"reference", &StageSeconds::reference},
                                                   {"write", &StageSeconds::write}}};

/// Where light is sampled for many centres at once and its noise is taken away, pictures are made
/// in strips of so many pixels, and of some rows more to both sides that only the denoiser sees:
/// that work takes ten times the memory of a frame.
inline constexpr int64_t kStripPixels = int64_t{1} << 21;

/// The BVH, the lights and at most one embedding of a scene, which must outlive it. Camera moves
/// re-encode nothing.
class Renderer {
 public:
  explicit Renderer(const scene::Scene& scene);
  /// Over what others hold too: renderers of one scene in several threads, each its own.
  Renderer(std::shared_ptr<const pathtrace::Bvh> bvh,
           std::shared_ptr<const pathtrace::Lights> lights,
           std::shared_ptr<SharedDenoiser> denoiser);

  /// Samples scene points and encodes them.
  /// @throws runtime::Refusal for a scene wider than the model knows, unless settings.rescale, and
  ///         where memory lacks.
  void embed(const runtime::Network& network, const EmbedSettings& settings);

  /// Takes an embedding of this scene that was made before, in the place of embed().
  void set_embedding(runtime::SceneEmbedding embedding);
  void set_embedding(std::shared_ptr<const runtime::SceneEmbedding> embedding);
  /// @throws lte::Error without one.
  const runtime::SceneEmbedding& embedding() const;
  std::shared_ptr<const runtime::SceneEmbedding> shared_embedding() const { return embedding_; }

  /// Makes the table that Indirect::Gather reads, in the place of the last one.
  /// @throws lte::Error if the network is to fill it and embed() has not been called.
  void make_table(const TableSettings& settings);
  /// @throws lte::Error without one.
  const gi::RadiosityTable& table() const;
  bool has_table() const { return table_.has_value(); }

  /// @throws lte::Error if the network or the table is needed and embed() or make_table() has not
  ///         been called.
  Frame render(const scene::Camera& camera, const RenderSettings& settings);

  /// Whether the network is needed: in neural mode, for an output with indirect light that paths
  /// do not answer for, where the scene has light.
  bool needs_network(const RenderSettings& settings) const;
  /// Whether a table is needed: likewise, where light is gathered.
  bool needs_table(const RenderSettings& settings) const;

  /// Whether `output` has indirect light in it, and the scene light.
  bool shows_indirect(Output output) const;
  /// What took noise away in the last render(): image::Denoiser::description(), or nothing.
  const std::string& denoised_by() const { return denoised_by_; }

  bool has_light() const { return !lights_.empty(); }
  bool has_environment() const { return lights_.has_environment(); }
  const pathtrace::Bvh& bvh() const { return bvh_; }
  const pathtrace::Lights& lights() const { return lights_; }
  StageSeconds& seconds() { return seconds_; }
  /// Counts of the last embed(); zeros if it did not prune.
  const pathtrace::PruneCounts& pruned_points() const { return pruned_points_; }

 private:
  struct Job;
  struct Estimate;
  Frame render_band(const PictureRows& rows, Job* job);
  BandLight neural(const PictureBand& band, Job* job);
  BandLight reference(const PictureBand& band, Job* job);
  void decode(const PictureBand& band, const RenderSettings& settings, BandLight* light);
  gi::Answerer decoder() const;
  void estimate(const PictureBand& band, const Estimate& what, Job* job, BandLight* light);
  void sample_direct(const PictureBand& band, Job* job, BandLight* light);
  bool needs_direct(const RenderSettings& settings) const;
  int strip_rows(const RenderSettings& settings) const;
  bool denoises(const RenderSettings& settings, bool gathered) const;
  bool keeps_cells(const RenderSettings& settings) const;
  const image::Denoiser* denoiser_for(const RenderSettings& settings, bool gathered);
  bool samples_centres(const RenderSettings& settings) const;
  void prepare_centres(const PictureRows& strip, Job* job);
  void gather(const PictureBand& band, Job* job, BandLight* light);
  bool gathers_direct(const RenderSettings& settings) const;
  void trace_metal(const PictureBand& band, Job* job, BandLight* light);
  Metal metal_of(const RenderSettings& settings) const;
  bool reflects_by_network(const RenderSettings& settings) const;

  std::shared_ptr<const pathtrace::Bvh> held_bvh_;
  std::shared_ptr<const pathtrace::Lights> held_lights_;
  const pathtrace::Bvh& bvh_;
  const pathtrace::Lights& lights_;
  std::shared_ptr<const runtime::SceneEmbedding> embedding_;
  std::optional<gi::RadiosityTable> table_;
  std::optional<gi::LightCells> cells_;  ///< of RenderSettings::keep_light
  StageSeconds seconds_;
  std::shared_ptr<SharedDenoiser> denoiser_;
  std::string denoised_by_;
  pathtrace::PruneCounts pruned_points_;
};

}  // namespace lte::infer
