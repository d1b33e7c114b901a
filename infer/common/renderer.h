// Pictures of a scene: the network's indirect light and sampled direct light at primary hits, or
// the path-traced reference of the same quantities.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "infer/common/frame.h"
#include "infer/common/picture_band.h"
#include "infer/common/ray_pace.h"
#include "lte/gi/sparse_pixels.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights.h"
#include "lte/pathtrace/reach.h"
#include "lte/pathtrace/render.h"
#include "lte/runtime/embedding.h"
#include "lte/scene/sampler.h"
#include "lte/scene/scene.h"

namespace lte::infer {

enum class Output { Full, Gi, Irradiance, Direct, Albedo, Normal, Depth };
enum class Mode { Neural, Reference };

/// The word for an output on the command line.
const char* output_name(Output output);
/// The output or mode of a word. @throws lte::Error naming the word and the ones there are.
Output parse_output(const std::string& word);
Mode parse_mode(const std::string& word);
Metal parse_metal(const std::string& word);

/// Hits in a pixel at an edge, unless told otherwise.
inline constexpr int kAntialias = 16;

struct RenderSettings {
  Output output = Output::Full;
  Mode mode = Mode::Neural;
  int width = 512, height = 512;
  int direct_samples = 64;  ///< shadow rays a pixel
  int spp = 64;             ///< paths a pixel: in reference mode, and for metal that is traced
  int max_depth = 5;        ///< of these paths: surface hits after the primary one
  uint64_t seed = 0;
  /// Hits in a pixel at an edge; 0 or 1 for the centre's alone. A reference of the full output
  /// spreads its paths over the pixel and needs none.
  int antialias = kAntialias;
  /// What stands for metal in light outputs; Irradiance shows it like any surface. Reference mode
  /// always traces it.
  Metal metal = Metal::Trace;
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
  runtime::MemoryLimit memory;  ///< of encoding, and of every later picture's decoding
};

/// Wall-clock seconds by stage; `load` and `write` belong to the caller. `light` is the time of the
/// estimates on scene points, for models that read them.
struct StageSeconds {
  double load = 0, sample = 0, light = 0, encode = 0, primary = 0, decode = 0, direct = 0;
  double reference = 0, write = 0;
};

/// The stages in the order in which they run.
struct Stage {
  const char* name;
  double StageSeconds::*seconds;
};
inline constexpr std::array<Stage, 9> kStages = {{{"load", &StageSeconds::load},
                                                  {"sample", &StageSeconds::sample},
                                                  {"light", &StageSeconds::light},
                                                  {"encode", &StageSeconds::encode},
                                                  {"primary", &StageSeconds::primary},
                                                  {"decode", &StageSeconds::decode},
                                                  {"direct", &StageSeconds::direct},
                                                  {"reference", &StageSeconds::reference},
                                                  {"write", &StageSeconds::write}}};

/// The BVH, the lights and at most one embedding of a scene, which must outlive it. Camera moves
/// re-encode nothing.
class Renderer {
 public:
  explicit Renderer(const scene::Scene& scene);

  /// Samples scene points and encodes them.
  /// @throws runtime::Refusal for a scene wider than the model knows, unless settings.rescale, and
  ///         where memory lacks.
  void embed(const runtime::Network& network, const EmbedSettings& settings);

  /// @throws lte::Error if the network is needed and embed() has not been called.
  Frame render(const scene::Camera& camera, const RenderSettings& settings);

  /// Whether the network is needed: in neural mode, for an output with indirect light, where the
  /// scene has light.
  bool needs_network(const RenderSettings& settings) const;

  bool has_light() const { return !lights_.empty(); }
  bool has_environment() const { return lights_.has_environment(); }
  const pathtrace::Bvh& bvh() const { return bvh_; }
  const pathtrace::Lights& lights() const { return lights_; }
  StageSeconds& seconds() { return seconds_; }
  /// Counts of the last embed(); zeros if it did not prune.
  const pathtrace::PruneCounts& pruned_points() const { return pruned_points_; }

 private:
  struct Job;
  Frame render_band(const PictureRows& rows, Job* job);
  BandLight neural(const PictureBand& band, Job* job);
  BandLight reference(const PictureBand& band, Job* job);
  void decode(const PictureBand& band, const RenderSettings& settings, BandLight* light);
  std::vector<Rgb> decode_all(const QuerySet& queries, int64_t centres) const;
  gi::Answerer decoder() const;
  void estimate(const PictureBand& band, bool direct_only, Job* job, BandLight* light);
  void trace_metal(const PictureBand& band, Job* job, BandLight* light);
  Metal metal_of(const RenderSettings& settings) const;

  pathtrace::Bvh bvh_;
  pathtrace::Lights lights_;
  std::optional<runtime::SceneEmbedding> embedding_;
  StageSeconds seconds_;
  pathtrace::PruneCounts pruned_points_;
};

/// Draws the points that describe a scene to the network, as every tool does.
/// @param prune   draw them only where light reaches
/// @param counts  what was pruned; may be null
scene::SurfaceSamples sample_scene_points(const pathtrace::Bvh& bvh, int64_t count, bool prune,
                                          uint64_t seed, pathtrace::PruneCounts* counts);

}  // namespace lte::infer
