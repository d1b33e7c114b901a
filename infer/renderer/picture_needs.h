// What a picture needs, from what is asked and what the scene and its model are.
#pragma once

#include "infer/picture/picture_band.h"
#include "infer/renderer/render_settings.h"

namespace lte::infer {

struct PictureNeeds {
  bool light = false;     ///< there is light, and the output shows it
  bool indirect = false;  ///< light that has bounced
  bool network = false;   ///< of it the network's answers at pixels
  bool table = false;     ///< of it what is gathered from a table of light
  bool direct = false;    ///< sampled light of a neural picture
  /// Direct light is sampled where indirect light is gathered.
  bool gathers_direct = false;
  bool keeps_light = false;  ///< pictures share what is gathered
  /// Paths through each whole pixel that correct what is gathered or what the network answers.
  int correction_paths = 0;
  bool corrects_pixels() const { return correction_paths > 0; }
  bool radiance = false;  ///< a reference whose paths find whole pixels
  /// The light of centres is sampled at once, before the bands: where it is gathered, rays are
  /// shared out or noise is taken away.
  bool centres = false;
  bool denoises_sampled = false, denoises_gathered = false;
  Metal metal = Metal::Diffuse;
  /// The radiance decoder answers for what metal reflects of bounced light. Where paths stand in
  /// for the network, they do for metal too.
  bool reflects_by_network = false;
  int strip_rows = 0;  ///< worked on at once
};

PictureNeeds needs_of(const RenderSettings& settings, bool has_light);

/// Whether noise is taken out of sampled light.
bool denoises_sampled(const RenderSettings& settings);

/// Where light is sampled for many centres at once and its noise is taken away, pictures are made
/// in strips of so many pixels, and of some rows more to both sides that only the denoiser sees:
/// that work takes ten times the memory of a frame.
inline constexpr int64_t kStripPixels = int64_t{1} << 21;
/// Rows of strips and bands are multiples of the tiles that pixels are asked in.
inline constexpr int kBandRows = 8;

}  // namespace lte::infer
