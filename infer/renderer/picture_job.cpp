#include "infer/renderer/picture_job.h"

#include <algorithm>
#include <utility>

#include "infer/picture/compose.h"
#include "infer/renderer/denoised_paths.h"
#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/pathtrace/render.h"

namespace lte::infer {
namespace {

using image::Image;

// Pixels of a band.
constexpr int64_t kBandPixels = int64_t{1} << 19;
// Rows around a strip that the denoiser sees.
constexpr int kRowsAround = 32;
// Paths through pixels are independent of all that the picture has used before.
constexpr uint64_t kPixelPaths = 34;
// And so are the pixels that are checked.
constexpr uint64_t kCheckPixels = 35;

}  // namespace

PictureJob::PictureJob(const PictureSources& sources, const scene::Camera& camera,
                       const RenderSettings& settings, const PictureNeeds& needs)
    : from_(sources), camera_(camera), settings_(settings), needs_(needs) {
  LTE_CHECK(settings.width > 0 && settings.height > 0, "size ", settings.width, "x",
            settings.height, ": both sides must be positive");
  LTE_CHECK(settings.correction_paths >= 0 && settings.correction_paths % 2 == 0,
            "correction paths must be an even number, got ", settings.correction_paths);
  LTE_CHECK(!needs.network || settings.answerer || !from_.draws.empty(),
            "this output needs a model: embed() comes first");
  LTE_CHECK(!needs.table || from_.table != nullptr,
            "there is no table of light: make_table() comes first");
  if (settings.check && settings.check->found && settings.mode == Mode::Neural &&
      (needs.network || needs.table))
    checked_.emplace(settings.width, settings.height, hash_combine(settings.seed, kCheckPixels));
}

/// A pixel is told of once, by the first stage that has come so far.
void PictureJob::advance(int64_t pixels) {
  pixels = std::min(pixels, band_pixels_ - done_);
  done_ += pixels;
  if (settings_.done && centres_) settings_.done(0);  // whether the picture is still wanted
  if (!settings_.done || pixels <= 0 || centres_) return;
  const int64_t told = needs_.corrects_pixels() ? pixels / 2 : pixels;  // paths are the other half
  settings_.done(told);
  untold_ -= told;
}

/// What takes noise away. The picture says so.
const image::Denoiser* PictureJob::denoiser() {
  const image::Denoiser& denoiser = from_.denoiser.get();
  denoised_by_ = denoiser.description();
  return &denoiser;
}

/// What is asked for at a strip's centres.
CentreRequest PictureJob::centre_request(const PictureRows& strip) {
  const bool reference = settings_.mode == Mode::Reference;
  CentreRequest request;
  request.direct = reference || needs_.direct;
  request.shadow_rays = {settings_.direct_samples, settings_.adaptive_direct, false,
                         settings_.seed};
  // Strips have streams of their own.
  if (strip.first > 0)
    request.shadow_rays.seed = hash_combine(settings_.seed, static_cast<uint64_t>(strip.first));
  request.paths = reference;
  request.indirect = reference && needs_.indirect;
  request.path_count = settings_.spp;
  request.max_depth = settings_.max_depth;
  if (request.direct && needs_.denoises_sampled) request.denoiser = denoiser();
  if (!needs_.table) return request;
  request.table = from_.table;
  request.gather = settings_.gather;
  request.gather.direct = needs_.gathers_direct;
  request.quality = settings_.gather.quality;
  if (settings_.done && !request.gather.check) request.gather.check = [this] { settings_.done(0); };
  if (needs_.denoises_gathered) request.gather_denoiser = denoiser();
  request.pixel_size = pathtrace::pixel_size(camera_, settings_.height);
  request.skip_metal = needs_.metal == Metal::Trace;
  // Without layers nobody asks which light is which.
  request.sum = !settings_.layers && settings_.correction_paths == 0;
  // Those of whole pixels come when edges are there, too.
  if (!needs_.corrects_pixels()) request.correction_paths = settings_.correction_paths;
  if (!needs_.keeps_light) return request;
  request.kept = from_.kept;
  request.projection.emplace(camera_, settings_.width, settings_.height);
  request.first_row = first_row_;
  return request;
}

/// Samples the light of a strip's centres. A reference's noise is taken away when it is whole: then
/// the hits are kept, where they are not too many.
void PictureJob::prepare_centres(const PictureRows& strip) {
  hits_.reset();
  centres_.reset();
  untold_ = int64_t{strip.width} * (strip.last - strip.first);
  if (!needs_.centres && !needs_.corrects_pixels()) return;
  if (needs_.radiance && pixels() > kStripPixels) return;
  const Timer timer;
  const int around = needs_.centres ? kRowsAround : 0;
  first_row_ = std::max(0, strip.first - around);
  hits_ = pathtrace::trace_gbuffer_rows(from_.bvh, camera_, settings_.width, settings_.height,
                                        first_row_, std::min(strip.height, strip.last + around));
  seconds_.primary += timer.seconds();
  if (needs_.radiance || !needs_.centres) return;
  CentreRequest request = centre_request(strip);
  if (settings_.done) {
    request.done = [&](int64_t pixels) {          // of the strip, not of the rows around it
      if (needs_.corrects_pixels()) pixels /= 2;  // paths are the other half
      pixels = std::min(pixels, untold_);
      if (pixels > 0) settings_.done(pixels);
      untold_ -= pixels;
    };
  }
  centres_ = light_centres(from_.bvh, from_.lights, *hits_, request);
  counted_ = false;
  (request.paths ? seconds_.reference : seconds_.direct) += centres_->sampling_seconds;
  seconds_.denoise += centres_->denoising_seconds;
  seconds_.gather += centres_->gathering_seconds;
  seconds_.reference += centres_->path_seconds;
}

BandLight PictureJob::neural(const PictureBand& band) {
  BandLight light;
  if (needs_.network) decode(band, &light);
  if (needs_.table) gather(band, &light);
  trace_metal(band, &light);
  if (needs_.indirect && settings_.indirect == Indirect::Paths) {
    const Timer timer;
    estimate(band, {settings_.spp, /*direct=*/false, /*indirect=*/true}, &light);
    seconds_.reference += timer.seconds();
  }
  if (!needs_.direct || needs_.gathers_direct) return light;
  const Timer timer;
  sample_direct(band, &light);
  seconds_.direct += timer.seconds();
  if (!light.total) return light;
  light.indirect = std::move(light.total);
  light.total.reset();
  for (size_t i = 0; i < light.indirect->size(); ++i)
    (*light.indirect)[i] = max((*light.indirect)[i] - (*light.direct)[i], {0, 0, 0});
  return light;
}

BandLight PictureJob::reference(const PictureBand& band) {
  BandLight light;
  trace_metal(band, &light);
  const Timer timer;
  estimate(band, {settings_.spp, /*direct=*/true, needs_.indirect}, &light);
  seconds_.reference += timer.seconds();
  return light;
}

Frame PictureJob::render_band(const PictureRows& rows, Frame* shown) {
  band_pixels_ = int64_t{rows.width} * (rows.last - rows.first);
  done_ = 0;
  if (settings_.pace)
    settings_.pace->begin_rows(band_pixels_, int64_t{rows.width} * (rows.height - rows.last));
  const Timer timer;
  const PictureBand band(from_.bvh, camera_, rows,
                         {needs_.radiance ? 0 : settings_.antialias, needs_.metal,
                          settings_.output == Output::Irradiance, /*centres_known=*/needs_.table,
                          /*mean_normal=*/needs_.corrects_pixels()},
                         hits_ ? &*hits_ : nullptr, first_row_);
  seconds_.primary += timer.seconds();
  BandLight light;
  if (needs_.light && !needs_.radiance)
    light = settings_.mode == Mode::Neural ? neural(band) : reference(band);
  if (checked_) checked_->take(band, rows, light, needs_.table ? &*hits_ : nullptr, first_row_);
  centre_queries_ += band.centre_queries();
  extra_queries_ += band.queries().size() - band.centre_queries();
  if (shown != nullptr && needs_.table && band.traced_pixels().empty()) {
    band.show(light, settings_.output, shown);
    advance(band_pixels_);
    return {};
  }
  Frame frame = band.resolve(light);
  if (settings_.mode == Mode::Neural && settings_.indirect == Indirect::Paths && light.indirect) {
    frame.traced_pixels += band.centre_queries();
    frame.queries = 0;
  }
  if (needs_.radiance) return frame;
  frame.color = needs_.light || is_geometry(settings_.output)
                    ? compose(frame, settings_.output)
                    : Image(frame.albedo.width, frame.albedo.height, 3);
  advance(band_pixels_);
  return frame;
}

/// Paths as they are asked for, or until the time is used.
void PictureJob::trace_passes(const std::vector<PixelKind>& kinds, PixelPaths* paths) {
  std::vector<int64_t> rough, smooth;
  for (size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i] == PixelKind::Rough) rough.push_back(static_cast<int64_t>(i));
    if (kinds[i] == PixelKind::Smooth) smooth.push_back(static_cast<int64_t>(i));
  }
  PicturePace* pace = needs_.table ? settings_.gather.pace : nullptr;
  if (pace == nullptr) {
    paths->add(rough, std::max(1, needs_.correction_paths / 2));
    paths->add(smooth, std::max(1, needs_.correction_paths / 2));
    return;
  }
  pace->begin_paths(static_cast<int64_t>(rough.size()), static_cast<int64_t>(smooth.size()));
  for (PixelPass pass = pace->next_pass(); !pass.empty(); pass = pace->next_pass()) {
    if (pass.rough > 0) paths->add(rough, pass.rough);
    if (pass.smooth > 0) paths->add(smooth, pass.smooth);
    pace->add_pass(pass);
    if (settings_.done && untold_ > 1) {
      settings_.done(untold_ / 2);
      untold_ -= untold_ / 2;
    }
  }
}

/// Corrects a strip by paths through its pixels.
void PictureJob::correct(const PictureRows& strip, Frame* frame) {
  Timer timer;
  const pathtrace::GBuffer hits =
      pathtrace::rows_of(*hits_, strip.first - first_row_, strip.last - first_row_);
  const SurfaceGuides guides = guides_of(hits);
  const std::vector<PixelKind> kinds = pixel_kinds(
      hits, pathtrace::pixel_size(camera_, settings_.height), needs_.metal != Metal::Trace);
  PixelPaths paths(from_.bvh, from_.lights, camera_, strip, settings_.max_depth,
                   hash_combine(settings_.seed, kPixelPaths));
  trace_passes(kinds, &paths);
  seconds_.reference += timer.seconds();
  timer.restart();
  const double pixels = double{1} * settings_.width * settings_.height;
  frame->correction_paths = paths.mean_paths() * static_cast<double>(kinds.size()) / pixels;
  if (frame->correction_paths > 0) {
    const std::array<pathtrace::RadianceLayers, 2> halves = paths.take();
    if (settings_.denoise != Denoise::Off && denoiser()->is_oidn())
      draw_to_denoised(*denoiser(), guides, kinds, paths.paths(), halves, frame);
    correct_pixels(guides, kinds, paths.paths(), halves, frame);
    frame->color = compose(*frame, settings_.output);
  }
  frame->mean_normal = {};
  if (settings_.done && untold_ > 0) settings_.done(untold_);
  seconds_.denoise += timer.seconds();
}

/// The colors of a reference by paths through whole pixels.
void PictureJob::add_radiance(Frame* frame) {
  const int width = settings_.width, height = settings_.height;
  const Timer timer;
  pathtrace::RadianceLayers layers;
  const bool parts = settings_.layers || needs_.centres;
  frame->color =
      pathtrace::render_reference(from_.bvh, from_.lights, camera_, width, height,
                                  {settings_.spp, settings_.max_depth + 1, settings_.seed},
                                  settings_.done, parts ? &layers : nullptr);
  seconds_.reference = timer.seconds();
  if (needs_.centres) denoise_radiance(layers, frame);
  if (settings_.layers) put_radiance(std::move(layers), frame);
}

/// Takes the noise of what surfaces reflect out of a reference's colors.
void PictureJob::denoise_radiance(const pathtrace::RadianceLayers& layers, Frame* frame) {
  const Timer tracing;
  const SurfaceGuides guides =
      hits_ ? guides_of(*hits_)
            : trace_guides(from_.bvh, camera_, settings_.width, settings_.height);
  seconds_.primary += tracing.seconds();
  const Timer denoising;
  Image reflected = layers.direct;
  for (size_t k = 0; k < reflected.pixels.size(); ++k)
    reflected.pixels[k] += layers.indirect.pixels[k];
  frame->color = denoise_reflected(*denoiser(), guides, reflected, {guides.albedo, guides.normal});
  for (size_t k = 0; k < reflected.pixels.size(); ++k)
    frame->color.pixels[k] += layers.emission.pixels[k];
  seconds_.denoise += denoising.seconds();
}

Frame PictureJob::render() {
  const Timer timer;
  const int width = settings_.width, height = settings_.height;
  const int64_t tall = kBandPixels / width / kBandRows * kBandRows;
  const auto band_rows = static_cast<int>(std::max<int64_t>(tall, kBandRows));
  Frame frame;
  if (needs_.table && !settings_.layers) {
    frame.color = Image(width, height, 3);
    frame.depth = Image(width, height, 1);
  }
  for (int first = 0; first < height; first += needs_.strip_rows) {
    const int last = std::min(first + needs_.strip_rows, height);
    const PictureRows strip{width, height, first, last};
    if (settings_.gather.pace != nullptr && needs_.table) {
      settings_.gather.pace->begin_rows(int64_t{width} * (last - first),
                                        int64_t{width} * (height - last));
    }
    prepare_centres(strip);
    Frame corrected;  // all layers of the strip
    for (int row = first; row < last; row += band_rows) {
      const PictureRows rows{width, height, row, std::min(row + band_rows, last)};
      const bool layers = settings_.layers || needs_.corrects_pixels();
      const Frame band = render_band(rows, layers ? nullptr : &frame);
      if (needs_.corrects_pixels()) {
        put_band(band, row - first, /*layers=*/true, last - first, &corrected);
      } else {
        put_band(band, row, settings_.layers, height, &frame);
      }
    }
    if (!needs_.corrects_pixels()) continue;
    correct(strip, &corrected);
    if (checked_) checked_->correct(strip, corrected);
    put_band(corrected, first, settings_.layers, height, &frame);
  }
  if (needs_.radiance) add_radiance(&frame);
  if (checked_) check(timer.seconds());
  return frame;
}

}  // namespace lte::infer
