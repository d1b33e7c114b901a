#include "infer/renderer/picture_memory.h"

#include <algorithm>

#include "lte/base/check.h"

namespace lte::infer {
namespace {

constexpr double kMib = 1 << 20;
// Bytes a pixel of a band: hits, queries, answers and layers; and a hit more of anti-aliasing, with
// half of the pixels at edges.
constexpr double kBandBytes = 240, kSubHitBytes = 36;
// More where light is answered sparsely: mask, albedo, irradiance and states of its pixels.
constexpr double kSparseBytes = 48;
// A band's pixels (renderer.cpp).
constexpr double kBand = 1 << 18;
// Bytes a pixel of the frame: color and depth; with layers albedo, normal, emission, and as many of
// direct, indirect and total as there can be.
constexpr double kColorBytes = 16, kLayerBytes = 36, kLightBytes = 12;
// Writing a PNG takes a tone-mapped copy, its bytes, the compressor's and the file; an EXR the file
// while it grows.
constexpr double kPngBytes = 40, kExrShare = 1.5;

// Where the light of all centres is sampled at once: guides, points, rays and the denoiser's copies
// while that is done, and what is kept for the bands.
constexpr double kCentreBytes = 150, kKeptBytes = 24;
// First hits of a strip; light that is kept from picture to picture, all in all (kept_views.h).
constexpr double kHitBytes = 61, kKeptMib = 96;
// A strip with the rows around it, at most (kStripPixels).
constexpr double kStrip = 1.2 * kStripPixels;
// Gathered light: points, what they found and how pixels between them are filled; and the halves of
// the paths that correct it, their differences and how those are smoothed.
constexpr double kGatherBytes = 110, kCorrectionBytes = 320;
// Where paths correct whole pixels: all layers of the strip beside that.
constexpr double kStripLayerBytes = 88;
// Open Image Denoise, which works in tiles beyond its limit (image/oidn.cpp).
constexpr double kOidnBytes = 600, kMostOidnMib = 768;

// What image::encode_png() takes.
constexpr int64_t kMostPngPixels = int64_t{1} << 28;

std::string picture_text(const RenderSettings& settings) {
  return concat("a picture of ", settings.width, "x", settings.height);
}

double light_layers(const RenderSettings& settings) {
  if (is_geometry(settings.output)) return 0;
  return settings.output == Output::Direct ? 1 : 2;
}

}  // namespace

double picture_mb(const RenderSettings& settings) {
  const double pixels = double{1} * settings.width * settings.height;
  const double frame =
      kColorBytes + (settings.layers ? kLayerBytes + kLightBytes * light_layers(settings) : 0);
  const double writing = settings.layers ? kExrShare * frame : kPngBytes;
  // A band is at least eight rows.
  const double band = std::min(pixels, std::max(kBand, 8.0 * settings.width));
  const double work = kBandBytes + kSubHitBytes * std::max(0, settings.antialias) +
                      (settings.sparse ? kSparseBytes : 0);
  // The last band is gone when the picture is written.
  const double bands = (pixels * frame + std::max(pixels * writing, band * work)) / kMib;
  const PictureNeeds needs = needs_of(settings, /*has_light=*/true);
  if (!needs.centres && !needs.corrects_pixels()) return bands;
  const bool corrects_points = settings.correction_paths > 0 && !needs.corrects_pixels();
  const double gather = !needs.table      ? 0
                        : corrects_points ? kGatherBytes + kCorrectionBytes
                                          : kGatherBytes;
  const double strip = needs.radiance ? pixels : std::min(pixels, kStrip);
  const double step = needs.table && settings.gather.direct ? settings.gather.step : 1;
  const double before = strip < pixels ? pixels * frame / kMib : 0;  // strips that are there
  const double centres = strip * (kCentreBytes + gather) / kMib +
                         std::min(kMostOidnMib, strip / (step * step) * kOidnBytes / kMib) + before;
  const double corrected =
      needs.corrects_pixels() ? strip * (kCorrectionBytes + kStripLayerBytes) / kMib + before : 0;
  const double hits = std::min(pixels, kStrip) * kHitBytes / kMib;
  const double kept = needs.table && settings.keep_light ? kKeptMib : 0;
  return std::max({bands + strip * kKeptBytes / kMib, centres, corrected}) + hits + kept;
}

void check_picture_fits(const RenderSettings& settings, double available_mb) {
  LTE_CHECK(settings.layers || int64_t{settings.width} * settings.height <= kMostPngPixels,
            picture_text(settings), " has more than the ", kMostPngPixels,
            " pixels of a PNG: write an .exr, or take a smaller one");
  const double need = picture_mb(settings);
  if (need <= available_mb) return;
  throw runtime::NotEnoughMemory(
      concat(picture_text(settings), " needs ", runtime::memory_text(need), " and ",
             runtime::memory_text(available_mb), " are free: take a smaller one"),
      {runtime::Remedy::FewerQueries});
}

void check_picture_fits(const RenderSettings& settings, const runtime::MemoryLimit& limit) {
  limit.check_ahead(picture_mb(settings), picture_text(settings), "take a smaller one",
                    {runtime::Remedy::FewerQueries});
}

}  // namespace lte::infer
