#include "infer/renderer/renderer.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "infer/light/lit_samples.h"
#include "infer/light/untrained_light.h"
#include "infer/picture/compose.h"
#include "infer/renderer/reflected_light.h"
#include "infer/renderer/sparse_light.h"
#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/pathtrace/direct_light.h"
#include "lte/pathtrace/irradiance.h"

namespace lte::infer {
namespace {

using image::Image;

// Pixels of a band; its rows are a multiple of the tiles that pixels are asked in.
constexpr int64_t kBandPixels = int64_t{1} << 18;
constexpr int kBandRows = 8;
// Rows around a strip that the denoiser sees.
constexpr int kRowsAround = 32;
// Estimates keep two colors a point and light group: blocks bound that memory.
constexpr int64_t kEstimateBlock = int64_t{1} << 21;
// Points between two looks at the progress.
constexpr int64_t kProgressBlock = int64_t{1} << 14;
// Shadow rays, at least, of hits in a denoised picture that stand on no centre's surface.
constexpr int kLeastEdgeRays = 16;

/// What is known of the centres, which come first.
/// @param first  pixel of the picture that `known` begins with
void take_centres(const PictureBand& band, const Image& known, int64_t first,
                  std::vector<Rgb>* values) {
  for (size_t i = 0; i < band.centre_pixels().size(); ++i) {
    const auto at = 3 * static_cast<size_t>(band.centre_pixels()[i] - first);
    (*values)[i] = {known.pixels[at], known.pixels[at + 1], known.pixels[at + 2]};
  }
}

}  // namespace

/// A picture in the making.
struct Renderer::Job {
  const scene::Camera& camera;
  const RenderSettings& settings;
  int64_t centre_queries = 0, extra_queries = 0;  ///< of the bands before
  int64_t band = 0;                               ///< pixels of this band
  int64_t done = 0;                               ///< those of them that were told of
  // Of a strip and the rows around it, from `first_row` on.
  int first_row = 0;
  std::optional<pathtrace::GBuffer> hits = {};
  std::optional<SurfaceGuides> guides = {};  ///< for a denoised reference: of the whole picture
  std::optional<CentreLight> centres = {};
  bool told_of_all = false;  ///< pixels, by `centres`
  bool counted = false;      ///< what was gathered at centres, in a band
  int view = 0;              ///< LightCells::begin_view()

  /// What `centres` begins with, as a pixel of the picture.
  int64_t first_pixel() const { return int64_t{settings.width} * first_row; }

  /// A pixel is told of once, by the first stage that has come so far.
  void advance(int64_t pixels) {
    pixels = std::min(pixels, band - done);
    if (settings.done && pixels > 0 && !told_of_all) settings.done(pixels);
    done += pixels;
  }
};

/// What paths from the queries are asked for.
struct Renderer::Estimate {
  int rays = 0;
  bool direct = true, indirect = true;
};

Renderer::Renderer(const scene::Scene& scene)
    : Renderer(std::make_shared<pathtrace::Bvh>(scene), std::make_shared<pathtrace::Lights>(scene),
               std::make_shared<SharedDenoiser>()) {}

Renderer::Renderer(std::shared_ptr<const pathtrace::Bvh> bvh,
                   std::shared_ptr<const pathtrace::Lights> lights,
                   std::shared_ptr<SharedDenoiser> denoiser)
    : held_bvh_(std::move(bvh)),
      held_lights_(std::move(lights)),
      bvh_(*held_bvh_),
      lights_(*held_lights_),
      denoiser_(std::move(denoiser)) {}

bool Renderer::shows_indirect(Output output) const {
  return has_light() && !is_geometry(output) && output != Output::Direct;
}

bool Renderer::needs_network(const RenderSettings& settings) const {
  return settings.mode == Mode::Neural && settings.indirect == Indirect::Network &&
         shows_indirect(settings.output);
}

bool Renderer::needs_table(const RenderSettings& settings) const {
  return settings.mode == Mode::Neural && settings.indirect == Indirect::Gather &&
         shows_indirect(settings.output);
}

void Renderer::embed(const runtime::Network& network, const EmbedSettings& settings) {
  Timer timer;
  embedding_.reset();  // two at a time would need twice the memory
  const int64_t count =
      settings.scene_points > 0 ? settings.scene_points : network.metadata().scene_points;
  pruned_points_ = {};
  const bool prune = settings.prune.value_or(network.metadata().scene_points_pruned);
  scene::SurfaceSamples samples =
      sample_scene_points(bvh_, count, prune, settings.seed, &pruned_points_);
  leave_out_untrained_suns(bvh_.scene(), network.metadata(), &samples);
  seconds_.sample = timer.seconds();
  timer.restart();
  const LitSamples lit = add_light_estimates(bvh_, lights_, std::move(samples),
                                             network.light_request(), settings.seed);
  seconds_.light = timer.seconds();
  timer.restart();
  embedding_ = std::make_shared<const runtime::SceneEmbedding>(
      network, lit.points(),
      runtime::EncodeOptions{settings.rescale, {}, settings.memory, settings.record_attention});
  seconds_.encode = timer.seconds();
}

void Renderer::make_table(const TableSettings& settings) {
  const Timer timer;
  table_.reset();  // two at a time would need twice the memory
  cells_.reset();
  table_.emplace(make_light_table(bvh_, lights_, embedding_ ? &*embedding_ : nullptr, settings));
  seconds_.table = timer.seconds();
}

const gi::RadiosityTable& Renderer::table() const {
  LTE_CHECK(table_.has_value(), "there is no table of light: make_table() comes first");
  return *table_;
}

void Renderer::set_embedding(runtime::SceneEmbedding embedding) {
  set_embedding(std::make_shared<const runtime::SceneEmbedding>(std::move(embedding)));
}

void Renderer::set_embedding(std::shared_ptr<const runtime::SceneEmbedding> embedding) {
  pruned_points_ = {};
  embedding_ = std::move(embedding);
}

const runtime::SceneEmbedding& Renderer::embedding() const {
  LTE_CHECK(embedding_ != nullptr, "there is no embedding: embed() comes first");
  return *embedding_;
}

Metal Renderer::metal_of(const RenderSettings& settings) const {
  if (is_geometry(settings.output) || settings.output == Output::Irradiance || !has_light())
    return Metal::Diffuse;
  if (settings.mode == Mode::Neural)
    return settings.metal == Metal::Network ? Metal::Trace : settings.metal;
  return settings.output == Output::Full ? Metal::Diffuse : Metal::Trace;
}

/// The network itself, as what answers queries.
gi::Answerer Renderer::decoder() const {
  return [this](std::span<const gi::Query> queries) {
    QuerySet set;
    for (const gi::Query& query : queries) {
      set.position.push_back(query.position);
      set.normal.push_back(query.normal);
      set.albedo.push_back(query.albedo);
    }
    return embedding_->decode({set.position, set.normal, set.albedo});
  };
}

void Renderer::decode(const PictureBand& band, const RenderSettings& settings, BandLight* light) {
  LTE_CHECK(embedding_ != nullptr, "this output needs a model: embed() comes first");
  const Timer timer;
  const gi::Answerer answerer = settings.answerer ? settings.answerer : decoder();
  SparseLight answers = settings.sparse ? light_sparsely(band, *settings.sparse, answerer)
                                        : light_everywhere(band, answerer);
  light->decoded = answers.answers;
  (embedding_->network().predicts_total() ? light->total : light->indirect) =
      std::move(answers.irradiance);
  seconds_.decode += timer.seconds();
}

/// Irradiance by paths. The queries of centres are numbered through the picture, those that
/// anti-aliasing adds from the number of its pixels on, so that they change no other.
void Renderer::estimate(const PictureBand& band, const Estimate& what, Job* job, BandLight* light) {
  const RenderSettings& settings = job->settings;
  pathtrace::IrradianceOptions options;
  options.rays = what.rays;
  options.max_depth = what.indirect ? settings.max_depth : 1;
  options.seed = settings.seed;
  options.direct_only = !what.indirect;
  const QuerySet& queries = band.queries();
  if (what.direct) light->direct.emplace(queries.position.size());
  if (what.indirect) light->indirect.emplace(queries.position.size());
  const int64_t block = std::min(
      kProgressBlock, std::max<int64_t>(1024, kEstimateBlock / std::max(1, lights_.groups())));
  const auto run = [&](int64_t first, int64_t end, int64_t number) {
    for (int64_t begin = first; begin < end; begin += block) {
      const auto b = static_cast<size_t>(begin),
                 n = static_cast<size_t>(std::min(block, end - begin));
      const pathtrace::Irradiance part = pathtrace::estimate_irradiance(
          bvh_, lights_, std::span(queries.position).subspan(b, n),
          std::span(queries.normal).subspan(b, n), options, number + begin - first);
      for (size_t i = 0; i < n; ++i) {
        const auto point = static_cast<int64_t>(i);
        if (what.direct) (*light->direct)[b + i] = part.direct_sum(point);
        if (what.indirect) (*light->indirect)[b + i] = part.indirect_sum(point);
      }
      if (end == band.centre_queries()) job->advance(static_cast<int64_t>(n));
    }
  };
  const int64_t centres = band.centre_queries();
  if (job->centres && settings.mode == Mode::Reference) {
    if (what.direct) take_centres(band, job->centres->direct, job->first_pixel(), &*light->direct);
    if (what.indirect)
      take_centres(band, job->centres->indirect, job->first_pixel(), &*light->indirect);
  } else {
    run(0, centres, job->centre_queries);
  }
  run(centres, queries.size(), int64_t{settings.width} * settings.height + job->extra_queries);
}

/// Direct light by shadow rays. Centres draw from the stream of their pixel, those that
/// anti-aliasing adds from the number of pixels on.
void Renderer::sample_direct(const PictureBand& band, Job* job, BandLight* light) {
  const RenderSettings& settings = job->settings;
  const QuerySet& queries = band.queries();
  light->direct.emplace(queries.position.size());
  pathtrace::DirectOptions options;
  options.seed = settings.seed;
  const auto run = [&](int64_t first, int64_t end, int rays, const auto& stream_of) {
    for (int64_t begin = first; begin < end; begin += kProgressBlock) {
      const int64_t count = std::min(kProgressBlock, end - begin);
      const auto b = static_cast<size_t>(begin), n = static_cast<size_t>(count);
      std::vector<uint64_t> streams(n);
      for (int64_t i = 0; i < count; ++i)
        streams[static_cast<size_t>(i)] = static_cast<uint64_t>(stream_of(begin + i));
      const Timer timer;
      if (settings.pace != nullptr) rays = settings.pace->rays(queries.size() - begin);
      const pathtrace::DirectLight part =
          pathtrace::estimate_direct(bvh_, lights_,
                                     {std::span(queries.position).subspan(b, n),
                                      std::span(queries.normal).subspan(b, n), streams},
                                     std::vector<int32_t>(n, rays), options);
      if (settings.pace != nullptr) settings.pace->add(count, rays, timer.seconds());
      std::copy(part.irradiance.begin(), part.irradiance.end(), light->direct->begin() + begin);
      if (end == band.centre_queries()) job->advance(count);
    }
  };
  const int64_t centres = band.centre_queries();
  if (job->centres) {
    take_centres(band, job->centres->direct, job->first_pixel(), &*light->direct);
  } else {
    run(0, centres, settings.direct_samples,
        [&](int64_t i) { return band.centre_pixels()[static_cast<size_t>(i)]; });
  }
  // Nothing smooths the queries of single hits, so they get more rays beside smooth pixels.
  const int rays = job->centres && settings.denoise != Denoise::Off
                       ? std::max(settings.direct_samples, kLeastEdgeRays)
                       : settings.direct_samples;
  const int64_t number = int64_t{settings.width} * settings.height + job->extra_queries - centres;
  run(centres, queries.size(), rays, [&](int64_t i) { return number + i; });
}

/// Whether the radiance decoder answers for what metal reflects of bounced light. Where paths stand
/// in for the network, they do for metal too.
bool Renderer::reflects_by_network(const RenderSettings& settings) const {
  return settings.metal == Metal::Network && needs_network(settings);
}

void Renderer::trace_metal(const PictureBand& band, Job* job, BandLight* light) {
  const RenderSettings& settings = job->settings;
  if (band.traced_pixels().empty()) return;
  const Timer timer;
  const bool by_network = reflects_by_network(settings);
  const int depth = settings.output == Output::Direct || by_network ? 1 : settings.max_depth;
  light->traced =
      pathtrace::trace_pixels(bvh_, lights_, job->camera, settings.width, settings.height,
                              band.traced_pixels(), {settings.spp, depth + 1, settings.seed},
                              job->told_of_all ? pathtrace::PixelsDone() : settings.done);
  job->done += static_cast<int64_t>(band.traced_pixels().size());
  seconds_.reference += timer.seconds();
  if (!by_network) return;
  const Timer decoding;
  const std::vector<Rgb> indirect = reflected_light(
      bvh_, embedding(), job->camera,
      {settings.width, settings.height, settings.reflections, settings.seed}, band.traced_pixels());
  for (size_t i = 0; i < indirect.size(); ++i) light->traced[i].indirect = indirect[i];
  seconds_.decode += decoding.seconds();
}

/// Whether a neural picture shows sampled light. A total model's full picture needs no direct
/// light; its indirect share is what direct light leaves.
bool Renderer::needs_direct(const RenderSettings& settings) const {
  const bool full = settings.output == Output::Full;
  const bool total =
      needs_network(settings) && embedding_ && embedding_->network().predicts_total();
  return total ? !full : full || settings.output == Output::Direct;
}

/// Whether noise is taken out of sampled light: of direct light where it is few samples.
/// @param gathered  of gathered light
bool Renderer::denoises(const RenderSettings& settings, bool gathered) const {
  const bool few =
      gathered || (settings.mode == Mode::Neural && settings.direct_samples <= kDenoiseUpTo);
  return settings.denoise != Denoise::Off && (settings.denoise != Denoise::Auto || few);
}

/// What takes that noise away; null if nothing does.
const image::Denoiser* Renderer::denoiser_for(const RenderSettings& settings, bool gathered) {
  if (!denoises(settings, gathered)) return nullptr;
  const image::Denoiser& denoiser = denoiser_->get();
  denoised_by_ = denoiser.description();
  return &denoiser;
}

/// Whether the light of centres is sampled at once, before the bands: where it is gathered, rays
/// are shared out or noise is taken away.
bool Renderer::samples_centres(const RenderSettings& settings) const {
  const bool reference = settings.mode == Mode::Reference;
  const bool gathers = needs_table(settings);
  const bool direct = reference || needs_direct(settings);
  if (is_geometry(settings.output) || !has_light() || (!direct && !gathers)) return false;
  if (settings.pace != nullptr && !gathers) return false;  // rays are chosen block by block
  return gathers || (!reference && settings.adaptive_direct) || denoises(settings, false);
}

/// Rows that are worked on at once; all of them where nothing is sampled before the bands, and for
/// a reference that is denoised when it is whole.
int Renderer::strip_rows(const RenderSettings& settings) const {
  const bool by_paths = settings.mode == Mode::Reference && settings.output == Output::Full;
  if (by_paths || !samples_centres(settings)) return settings.height;
  const int64_t rows = kStripPixels / settings.width / kBandRows * kBandRows;
  return static_cast<int>(std::clamp<int64_t>(rows, kBandRows, settings.height));
}

/// Samples the light of a strip's centres.
void Renderer::prepare_centres(const PictureRows& strip, Job* job) {
  const RenderSettings& settings = job->settings;
  job->hits.reset();
  job->guides.reset();
  job->centres.reset();
  if (!samples_centres(settings)) return;
  const bool reference = settings.mode == Mode::Reference;
  const bool gathers = needs_table(settings);
  const bool direct = reference || needs_direct(settings);
  const Timer timer;
  const bool by_paths = reference && settings.output == Output::Full;
  if (by_paths && int64_t{settings.width} * settings.height > kStripPixels) {
    job->guides = trace_guides(bvh_, job->camera, settings.width, settings.height);
  } else {
    job->first_row = std::max(0, strip.first - kRowsAround);
    job->hits = pathtrace::trace_gbuffer_rows(bvh_, job->camera, settings.width, settings.height,
                                              job->first_row,
                                              std::min(settings.height, strip.last + kRowsAround));
    job->guides = guides_of(*job->hits);
  }
  seconds_.primary += timer.seconds();
  const image::Denoiser* denoiser = direct ? denoiser_for(settings, false) : nullptr;
  if (by_paths) return;
  int64_t untold = int64_t{settings.width} * (strip.last - strip.first);
  CentreRequest request;
  request.shadow_rays = {settings.direct_samples, settings.adaptive_direct, false, settings.seed};
  // Strips have streams of their own.
  if (strip.first > 0)
    request.shadow_rays.seed = hash_combine(settings.seed, static_cast<uint64_t>(strip.first));
  request.paths = reference;
  request.indirect = reference && settings.output != Output::Direct;
  request.path_count = settings.spp;
  request.max_depth = settings.max_depth;
  request.denoiser = denoiser;
  request.direct = direct;
  if (gathers) {
    request.table = &table();
    request.gather = settings.gather;
    request.quality = settings.gather.quality;
    request.gather_denoiser = denoiser_for(settings, true);
    request.pixel_size = pathtrace::pixel_size(job->camera, settings.height);
    request.skip_metal = metal_of(settings) == Metal::Trace;
    request.gather.direct = gathers_direct(settings);
    // Without layers nobody asks which light is which.
    request.sum = !settings.layers && settings.gather.paths == 0;
    if (keeps_cells(settings)) request.cells = &*cells_;
    request.view = job->view;
  }
  if (settings.done) {
    request.done = [&](int64_t pixels) {  // of the strip, not of the rows around it
      pixels = std::min(pixels, untold);
      if (pixels > 0) settings.done(pixels);
      untold -= pixels;
    };
  }
  job->centres = light_centres(bvh_, lights_, *job->guides, request);
  job->told_of_all = true;
  job->counted = false;
  (reference ? seconds_.reference : seconds_.direct) += job->centres->sampling_seconds;
  seconds_.denoise += job->centres->denoising_seconds;
  seconds_.gather += job->centres->gathering_seconds;
  seconds_.reference += job->centres->path_seconds;
  job->guides.reset();
}

/// Whether views share light.
bool Renderer::keeps_cells(const RenderSettings& settings) const {
  return needs_table(settings) && settings.keep_light && settings.gather.step > 1;
}

/// Whether direct light is sampled where indirect light is gathered.
bool Renderer::gathers_direct(const RenderSettings& settings) const {
  return needs_table(settings) && needs_direct(settings) && settings.gather.direct &&
         !settings.adaptive_direct;
}

/// Gathered light: that of centres is there already. Hits at edges that stand on no centre's
/// surface take that of pixels near them where pixels do so too, and else gather by themselves.
void Renderer::gather(const PictureBand& band, Job* job, BandLight* light) {
  const Timer timer;
  const RenderSettings& settings = job->settings;
  const QuerySet& queries = band.queries();
  struct Layer {
    const Image& centres;
    std::vector<Rgb>& out;
  };
  std::vector<Layer> layers;
  const auto add_layer = [&](const Image& centres, std::optional<std::vector<Rgb>>* out) {
    if (centres.width > 0) layers.push_back({centres, out->emplace(queries.position.size())});
  };
  const bool with_direct = gathers_direct(settings);
  add_layer(job->centres->indirect, &light->indirect);
  add_layer(job->centres->total, &light->total);
  if (with_direct) add_layer(job->centres->direct, &light->direct);
  std::vector<size_t> open;
  for (const Layer& layer : layers) {
    take_centres(band, layer.centres, job->first_pixel(), &layer.out);
    if (settings.gather.step > 1) open = interpolate_extras(band, &layer.out);
  }
  LitPoints points;
  if (settings.gather.step == 1) {
    open.resize(queries.position.size() - static_cast<size_t>(band.centre_queries()));
    std::iota(open.begin(), open.end(), static_cast<size_t>(band.centre_queries()));
  }
  for (const size_t query : open) {
    points.position.push_back(queries.position[query]);
    points.normal.push_back(queries.normal[query]);
  }
  LightWork work;
  const PointLight alone =
      light_points({bvh_, lights_, table(), settings.max_depth, settings.seed}, points,
                   {std::max(settings.gather.rays, kLeastAloneRays),
                    with_direct ? std::max(settings.direct_samples, kLeastEdgeRays) : 0},
                   int64_t{settings.width} * settings.height + job->extra_queries, &work);
  for (size_t k = 0; k < open.size(); ++k) {
    if (light->indirect) (*light->indirect)[open[k]] = alone.indirect[k];
    if (light->direct) (*light->direct)[open[k]] = alone.direct[k];
    if (light->total) (*light->total)[open[k]] = alone.indirect[k] + alone.direct[k];
  }
  light->decoded = work.points;
  if (!job->counted) light->decoded += job->centres->gathered;
  job->counted = true;
  seconds_.direct += work.direct_seconds;
  seconds_.gather += timer.seconds() - work.direct_seconds;
}

BandLight Renderer::neural(const PictureBand& band, Job* job) {
  const RenderSettings& settings = job->settings;
  BandLight light;
  const bool network = needs_network(settings);
  if (network) decode(band, settings, &light);
  if (needs_table(settings)) gather(band, job, &light);
  trace_metal(band, job, &light);
  if (settings.indirect == Indirect::Paths && shows_indirect(settings.output)) {
    const Timer timer;
    estimate(band, {settings.spp, /*direct=*/false, /*indirect=*/true}, job, &light);
    seconds_.reference += timer.seconds();
  }
  if (!needs_direct(settings) || gathers_direct(settings)) return light;
  const Timer timer;
  sample_direct(band, job, &light);
  seconds_.direct += timer.seconds();
  if (!light.total) return light;
  light.indirect = std::move(light.total);
  light.total.reset();
  for (size_t i = 0; i < light.indirect->size(); ++i)
    (*light.indirect)[i] = max((*light.indirect)[i] - (*light.direct)[i], {0, 0, 0});
  return light;
}

BandLight Renderer::reference(const PictureBand& band, Job* job) {
  BandLight light;
  trace_metal(band, job, &light);
  const Timer timer;
  const bool indirect = job->settings.output != Output::Direct;
  estimate(band, {job->settings.spp, /*direct=*/true, indirect}, job, &light);
  seconds_.reference += timer.seconds();
  return light;
}

Frame Renderer::render_band(const PictureRows& rows, Job* job) {
  const RenderSettings& settings = job->settings;
  const bool by_paths = settings.mode == Mode::Reference && settings.output == Output::Full;
  job->done = 0;
  if (settings.pace) {
    settings.pace->begin_rows(int64_t{rows.width} * (rows.last - rows.first),
                              int64_t{rows.width} * (rows.height - rows.last));
  }
  const Timer timer;
  const PictureBand band(bvh_, job->camera, rows,
                         {by_paths ? 0 : settings.antialias, metal_of(settings),
                          settings.output == Output::Irradiance},
                         job->hits ? &*job->hits : nullptr, job->first_row);
  seconds_.primary += timer.seconds();
  job->band = int64_t{rows.width} * (rows.last - rows.first);
  BandLight light;
  if (!is_geometry(settings.output) && has_light() && !by_paths)
    light = settings.mode == Mode::Neural ? neural(band, job) : reference(band, job);
  job->centre_queries += band.centre_queries();
  job->extra_queries += band.queries().size() - band.centre_queries();
  Frame frame = band.resolve(light);
  if (settings.mode == Mode::Neural && settings.indirect == Indirect::Paths && light.indirect) {
    frame.traced_pixels += band.centre_queries();
    frame.queries = 0;
  }
  if (!by_paths) {
    frame.color = is_geometry(settings.output) || has_light()
                      ? compose(frame, settings.output)
                      : Image(frame.albedo.width, frame.albedo.height, 3);
    job->advance(job->band);
  }
  return frame;
}

Frame Renderer::render(const scene::Camera& camera, const RenderSettings& settings) {
  LTE_CHECK(settings.width > 0 && settings.height > 0, "size ", settings.width, "x",
            settings.height, ": both sides must be positive");
  seconds_.primary = seconds_.decode = seconds_.gather = seconds_.direct = 0;
  seconds_.denoise = seconds_.reference = 0;
  denoised_by_.clear();
  Job job{camera, settings};
  if (keeps_cells(settings)) job.view = (cells_ ? *cells_ : cells_.emplace()).begin_view();
  Frame frame;
  const int strip = strip_rows(settings);
  const int64_t tall = kBandPixels / settings.width / kBandRows * kBandRows;
  const auto rows = static_cast<int>(std::max<int64_t>(tall, kBandRows));
  for (int first = 0; first < settings.height; first += strip) {
    const int last = std::min(first + strip, settings.height);
    prepare_centres({settings.width, settings.height, first, last}, &job);
    for (int row = first; row < last; row += rows) {
      const PictureRows part{settings.width, settings.height, row, std::min(row + rows, last)};
      put_band(render_band(part, &job), row, settings.layers, settings.height, &frame);
    }
  }
  if (settings.mode == Mode::Reference && settings.output == Output::Full) {
    const Timer timer;
    pathtrace::RadianceLayers layers;
    frame.color =
        pathtrace::render_reference(bvh_, lights_, camera, settings.width, settings.height,
                                    {settings.spp, settings.max_depth + 1, settings.seed},
                                    settings.done, settings.layers ? &layers : nullptr);
    if (settings.layers) put_radiance(std::move(layers), &frame);
    seconds_.reference = timer.seconds();
    if (job.guides) {
      const Timer denoising;
      frame.color = denoise_radiance(denoiser_->get(), *job.guides, frame.color);
      seconds_.denoise += denoising.seconds();
    }
  }
  return frame;
}

}  // namespace lte::infer
