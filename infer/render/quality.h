// The dial of lte_render: one word, or a time, that sets several switches at once.
#pragma once

#include <string>

#include "infer/renderer/renderer.h"
#include "lte/base/enum_names.h"

namespace lte::infer {

enum class Quality { Draft, Preview, Final };
constexpr EnumNames<Quality, 3> enum_names(Quality) {
  return {{{Quality::Draft, "draft"}, {Quality::Preview, "preview"}, {Quality::Final, "final"}}};
}

/// Whether indirect light is asked sparsely. Auto: as the quality has it.
enum class Sparse { Auto, Off, On };
constexpr EnumNames<Sparse, 3> enum_names(Sparse) {
  return {{{Sparse::Auto, "auto"}, {Sparse::Off, "off"}, {Sparse::On, "on"}}};
}

/// Pixels beyond which a draft gathers at fewer of them: what a pixel shows is small then.
inline constexpr int64_t kLargePicture = int64_t{1} << 20;

/// What a quality stands for.
struct QualitySettings {
  int direct_samples = 0;     ///< --direct-samples
  int antialias = 0;          ///< --aa; 0: off
  bool sparse = false;        ///< --sparse auto
  gi::SparseOptions answers;  ///< of --sparse on too
  /// Share of the pixels that is answered where sparse answers are in force, about: for plans.
  double answered_share = 1;
  GatherSettings gather;          ///< of gathered light; its step where sparse answers are in force
  int correction_paths = 0;       ///< --correction-paths of gathered light; the network's has none
  int large_step = 2;             ///< that step for pictures of more than kLargePicture pixels
  int large_rays = 0;             ///< gather and shadow rays of those; 0: as of others
  int gather_antialias = 0;       ///< --aa of gathered light
  int gather_direct_samples = 0;  ///< --direct-samples of it
};

QualitySettings quality_settings(Quality quality);

/// Flags that the user has given, which win over the quality's.
struct GivenFlags {
  bool direct_samples = false, antialias = false, sparse = false;
  bool gather_rays = false, correction_paths = false;
};

/// "0.5s" -> 0.5, "200ms" -> 0.2. @throws lte::Error for anything else.
double parse_time_budget(const std::string& text);

/// "0.25 s", for messages.
std::string seconds_text(double seconds);

/// What the stages of a picture cost, as measured on a small one.
struct PictureRates {
  double primary_s = 0;  ///< a hit
  double decode_s = 0;   ///< an answer of the network
  double ray_s = 0;      ///< a shadow ray at a query
  double metal_s = 0;    ///< a pixel, mean over all: paths where metal is
};

/// Predicted seconds of a picture of so many pixels.
double predicted_seconds(const QualitySettings& settings, const PictureRates& rates,
                         int64_t pixels);

/// The best quality whose picture is predicted to be ready in `seconds`; shadow rays count as those
/// of the quality, but for Draft, which can do with one.
/// @param given     the flags of `settings_of`, which differ between qualities in the others alone
/// @param settings  what each quality stands for, by its number
/// @throws lte::Error "--time-budget ...: ..." if none is. `spent` says what is over already.
Quality choose_quality(double seconds, double spent, const PictureRates& rates, int64_t pixels,
                       const std::array<QualitySettings, 3>& settings, bool rays_are_given);

}  // namespace lte::infer
