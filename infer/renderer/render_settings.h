// What a picture is asked for, what a scene is encoded with, and the stages that are timed.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "infer/picture/output.h"
#include "infer/picture/ray_pace.h"
#include "infer/renderer/gathered_light.h"
#include "infer/renderer/light_check.h"
#include "lte/base/enum_names.h"
#include "lte/gi/sparse_pixels.h"
#include "lte/runtime/embedding.h"

namespace lte::infer {

/// Hits in a pixel at an edge, unless told otherwise.
inline constexpr int kAntialias = 16;

/// Directions a pixel whose radiance the decoder is asked for, unless told otherwise.
inline constexpr int kReflections = 16;

enum class Denoise { Off, On, Auto };
constexpr EnumNames<Denoise, 3> enum_names(Denoise) {
  return {{{Denoise::Auto, "auto"}, {Denoise::On, "on"}, {Denoise::Off, "off"}}};
}

/// Shadow rays a pixel up to which Denoise::Auto takes noise away (docs/lab/direct-light.md).
inline constexpr int kDenoiseUpTo = 16;

/// A picture's answers are held to account by paths (light_check.h).
struct PictureCheck {
  LightCheck* found = nullptr;  ///< takes the outcome
  /// Of work before the picture that it is the only one to need: it counts as the picture's time.
  double seconds_before = 0;
  /// What both may take together, the check included: then it is left with less.
  double budget_s = std::numeric_limits<double>::infinity();
};
/// What a check takes at most of the time of the picture that it checks, but for its first paths.
inline constexpr double kCheckShare = 0.1;

struct RenderSettings {
  Output output = Output::Full;
  Mode mode = Mode::Neural;
  int width = 512, height = 512;
  Indirect indirect = Indirect::Decoded;
  GatherSettings gather;  ///< of Indirect::Gather, which takes its noise away unless `denoise` is
                          ///< off
  /// Of Indirect::Gather at few pixels (gather.step): light that earlier pictures since
  /// make_table() have found is taken where this one shows the same surfaces, and what it finds is
  /// kept (kept_views.h). So a picture depends on those before it.
  bool keep_light = false;
  /// Paths a pixel that correct indirect light; an even number, 0 for none. A full picture of
  /// Indirect::Gather, or by a network of indirect light alone, is corrected by paths through whole
  /// pixels (pixel_correction.h), what is gathered of irradiance alone by paths from their centres
  /// (path_correction.h). Other pictures have none.
  int correction_paths = 0;
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
  /// Neural mode: check what the network or gathered light answers, at a part of the pixels. No
  /// pixel depends on it.
  std::optional<PictureCheck> check;
  /// Keep the layers of the frame. Without, it has its color and depth alone, and takes a fifth of
  /// the memory.
  bool layers = true;
  /// Told of pixels as they are done, width * height in all, by any thread.
  std::function<void(int64_t pixels)> done;
};

struct EmbedSettings {
  int64_t scene_points = 0;  ///< M; 0 for that of the model's training
  uint64_t seed = 0;
  int draws = 1;  ///< embeddings whose answers are averaged, of this seed and the next ones
  bool rescale = false;
  /// Draw scene points only where light reaches them (lte/pathtrace/reach/reach.h); by default as
  /// in the model's training.
  std::optional<bool> prune;
  /// Light groups that bring no light to what will be asked about (left_out_light()). Where
  /// points are pruned, the network is not told of them.
  std::vector<int> unreached;
  runtime::MemoryLimit memory;    ///< of encoding, and of every later picture's decoding
  bool record_attention = false;  ///< keep what the encoder's blocks attend to

  bool prunes(const runtime::Network& network) const {
    return prune.value_or(network.metadata().scene_points_pruned);
  }
};

/// Wall-clock seconds by stage; `load` and `write` belong to the caller. `light` is the time of the
/// estimates on scene points, for models that read them; `table` and `gather` belong to
/// Indirect::Gather, whose correcting paths are in `reference`.
struct StageSeconds {
  double load = 0, sample = 0, light = 0, encode = 0, table = 0, primary = 0, decode = 0;
  double gather = 0, direct = 0, denoise = 0, reference = 0, check = 0, write = 0;
};

/// The stages in the order in which they run.
struct Stage {
  const char* name;
  double StageSeconds::*seconds;
};
inline constexpr std::array<Stage, 13> kStages = {{{"load", &StageSeconds::load},
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
                                                   {"check", &StageSeconds::check},
                                                   {"write", &StageSeconds::write}}};
/// Those of Renderer::render().
inline constexpr std::array<double StageSeconds::*, 7> kPictureStages = {
    &StageSeconds::primary, &StageSeconds::decode,    &StageSeconds::gather, &StageSeconds::direct,
    &StageSeconds::denoise, &StageSeconds::reference, &StageSeconds::check};

}  // namespace lte::infer
