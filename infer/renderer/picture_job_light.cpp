#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "infer/renderer/picture_job.h"
#include "infer/renderer/reflected_light.h"
#include "infer/renderer/sparse_light.h"
#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/image/rgb_view.h"
#include "lte/pathtrace/direct_light.h"
#include "lte/pathtrace/irradiance.h"

// What answers the queries of a band, and what checks the answers.
namespace lte::infer {
namespace {

using image::Image;

// Estimates keep two colors a point and light group: blocks bound that memory.
constexpr int64_t kEstimateBlock = int64_t{1} << 21;
// Points between two looks at the progress.
constexpr int64_t kProgressBlock = int64_t{1} << 14;
// Gather and shadow rays, at least, of hits in a denoised picture that lie on no centre's surface.
constexpr int kLeastEdgeRays = 16;
// Paths that check are independent of all that the picture has used.
constexpr uint64_t kCheckPaths = 36;

}  // namespace

/// What is known of the centres, which come first.
void PictureJob::take_centres(const PictureBand& band, const Image& known,
                              std::vector<Rgb>* values) const {
  const int64_t first = int64_t{settings_.width} * first_row_;
  const std::vector<int64_t>& pixels = band.centre_pixels();
  parallel_for(static_cast<int64_t>(pixels.size()), kProgressBlock,
               [&](int64_t begin, int64_t end) {
                 for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i)
                   (*values)[i] = known.rgb(static_cast<size_t>(pixels[i] - first));
               });
}

/// The network itself, as what answers queries.
gi::Answerer PictureJob::decoder() const {
  return [this](std::span<const gi::Query> queries) {
    QuerySet set;
    for (const gi::Query& query : queries) {
      set.position.push_back(query.position);
      set.normal.push_back(query.normal);
      set.albedo.push_back(query.albedo);
    }
    return from_.draws.decode({set.position, set.normal, set.albedo});
  };
}

void PictureJob::decode(const PictureBand& band, BandLight* light) {
  const Timer timer;
  const gi::Answerer answerer = settings_.answerer ? settings_.answerer : decoder();
  SparseLight answers = settings_.sparse ? light_sparsely(band, *settings_.sparse, answerer)
                                         : light_everywhere(band, answerer);
  light->decoded = answers.answers;
  light->indirect = std::move(answers.irradiance);
  seconds_.decode += timer.seconds();
}

/// Irradiance by paths. The queries of centres are numbered through the picture, those that
/// anti-aliasing adds from the number of its pixels on, so that they change no other.
void PictureJob::estimate(const PictureBand& band, const PathLight& what, BandLight* light) {
  pathtrace::IrradianceOptions options;
  options.rays = what.rays;
  options.max_depth = what.indirect ? settings_.max_depth : 1;
  options.seed = settings_.seed;
  options.direct_only = !what.indirect;
  const QuerySet& queries = band.queries();
  if (what.direct) light->direct.emplace(queries.position.size());
  if (what.indirect) light->indirect.emplace(queries.position.size());
  const int64_t block = std::min(
      kProgressBlock, std::max<int64_t>(1024, kEstimateBlock / std::max(1, from_.lights.groups())));
  const auto run = [&](int64_t first, int64_t end, int64_t number) {
    for (int64_t begin = first; begin < end; begin += block) {
      const auto b = static_cast<size_t>(begin),
                 n = static_cast<size_t>(std::min(block, end - begin));
      const pathtrace::Irradiance part = pathtrace::estimate_irradiance(
          from_.bvh, from_.lights, std::span(queries.position).subspan(b, n),
          std::span(queries.normal).subspan(b, n), options, number + begin - first);
      for (size_t i = 0; i < n; ++i) {
        const auto point = static_cast<int64_t>(i);
        if (what.direct) (*light->direct)[b + i] = part.direct_sum(point);
        if (what.indirect) (*light->indirect)[b + i] = part.indirect_sum(point);
      }
      if (end == band.centre_queries()) advance(static_cast<int64_t>(n));
    }
  };
  const int64_t centres = band.centre_queries();
  if (centres_ && settings_.mode == Mode::Reference) {
    if (what.direct) take_centres(band, centres_->direct, &*light->direct);
    if (what.indirect) take_centres(band, centres_->indirect, &*light->indirect);
  } else {
    run(0, centres, centre_queries_);
  }
  run(centres, queries.size(), pixels() + extra_queries_);
}

/// Direct light by shadow rays. Centres draw from the stream of their pixel, those that
/// anti-aliasing adds from the number of pixels on.
void PictureJob::sample_direct(const PictureBand& band, BandLight* light) {
  const QuerySet& queries = band.queries();
  light->direct.emplace(queries.position.size());
  pathtrace::DirectOptions options;
  options.seed = settings_.seed;
  const auto run = [&](int64_t first, int64_t end, int rays, const auto& stream_of) {
    for (int64_t begin = first; begin < end; begin += kProgressBlock) {
      const int64_t count = std::min(kProgressBlock, end - begin);
      const auto b = static_cast<size_t>(begin), n = static_cast<size_t>(count);
      std::vector<uint64_t> streams(n);
      for (int64_t i = 0; i < count; ++i)
        streams[static_cast<size_t>(i)] = static_cast<uint64_t>(stream_of(begin + i));
      const Timer timer;
      if (settings_.pace != nullptr) rays = settings_.pace->rays(queries.size() - begin);
      const pathtrace::DirectLight part =
          pathtrace::estimate_direct(from_.bvh, from_.lights,
                                     {std::span(queries.position).subspan(b, n),
                                      std::span(queries.normal).subspan(b, n), streams},
                                     std::vector<int32_t>(n, rays), options);
      if (settings_.pace != nullptr) settings_.pace->add(count, rays, timer.seconds());
      std::copy(part.irradiance.begin(), part.irradiance.end(), light->direct->begin() + begin);
      if (end == band.centre_queries()) advance(count);
    }
  };
  const int64_t centres = band.centre_queries();
  if (centres_) {
    light->centres.direct = &centres_->direct;
    take_centres(band, centres_->direct, &*light->direct);
  } else {
    run(0, centres, settings_.direct_samples,
        [&](int64_t i) { return band.centre_pixels()[static_cast<size_t>(i)]; });
  }
  // Nothing smooths the queries of single hits, so they get more rays beside smooth pixels.
  const int rays = centres_ && settings_.denoise != Denoise::Off
                       ? std::max(settings_.direct_samples, kLeastEdgeRays)
                       : settings_.direct_samples;
  const int64_t number = pixels() + extra_queries_ - centres;
  run(centres, queries.size(), rays, [&](int64_t i) { return number + i; });
}

void PictureJob::trace_metal(const PictureBand& band, BandLight* light) {
  if (band.traced_pixels().empty()) return;
  const Timer timer;
  const int depth =
      settings_.output == Output::Direct || needs_.reflects_by_network ? 1 : settings_.max_depth;
  light->traced =
      pathtrace::trace_pixels(from_.bvh, from_.lights, camera_, settings_.width, settings_.height,
                              band.traced_pixels(), {settings_.spp, depth + 1, settings_.seed},
                              centres_ ? pathtrace::PixelsDone() : settings_.done);
  done_ += static_cast<int64_t>(band.traced_pixels().size());
  seconds_.reference += timer.seconds();
  if (!needs_.reflects_by_network) return;
  const Timer decoding;
  const std::vector<Rgb> indirect =
      reflected_light(from_.bvh, from_.draws, camera_,
                      {settings_.width, settings_.height, settings_.reflections, settings_.seed},
                      band.traced_pixels());
  for (size_t i = 0; i < indirect.size(); ++i) light->traced[i].indirect = indirect[i];
  seconds_.decode += decoding.seconds();
}

/// Gathered light: that of centres is there already. Hits at edges that stand on no centre's
/// surface take that of pixels near them where pixels do so too, and else gather by themselves.
void PictureJob::gather(const PictureBand& band, BandLight* light) {
  const Timer timer;
  const QuerySet& queries = band.queries();
  struct Layer {
    const Image& centres;
    std::vector<Rgb>& out;
  };
  std::vector<Layer> layers;
  const auto add_layer = [&](const Image& centres, const Image** known,
                             std::optional<std::vector<Rgb>>* out) {
    if (centres.width == 0) return;
    *known = &centres;
    layers.push_back({centres, out->emplace(queries.position.size())});
  };
  const bool with_direct = needs_.gathers_direct;
  add_layer(centres_->indirect, &light->centres.indirect, &light->indirect);
  add_layer(centres_->total, &light->centres.total, &light->total);
  if (with_direct) add_layer(centres_->direct, &light->centres.direct, &light->direct);
  std::vector<size_t> open;
  const auto first =
      static_cast<size_t>(band.first_lent_row()) * static_cast<size_t>(settings_.width);
  for (const Layer& layer : layers) {
    const std::span<const Rgb> of_pixel =
        image::rgb_view(layer.centres).subspan(first, band.query_of_pixel().size());
    if (settings_.gather.step > 1) open = interpolate_extras(band, of_pixel, layer.out);
  }
  LitPoints points;
  if (settings_.gather.step == 1) {
    open.resize(queries.position.size());
    std::iota(open.begin(), open.end(), size_t{0});
  }
  for (const size_t query : open) {
    points.position.push_back(queries.position[query]);
    points.normal.push_back(queries.normal[query]);
  }
  LightWork work;
  const PointLight alone = light_points(
      {from_.bvh, from_.lights, *from_.table, settings_.max_depth, settings_.seed}, points,
      {std::max(settings_.gather.rays, kLeastEdgeRays),
       with_direct ? std::max(settings_.direct_samples, kLeastEdgeRays) : 0},
      pixels() + extra_queries_, &work);
  for (size_t k = 0; k < open.size(); ++k) {
    if (light->indirect) (*light->indirect)[open[k]] = alone.indirect[k];
    if (light->direct) (*light->direct)[open[k]] = alone.direct[k];
    if (light->total) (*light->total)[open[k]] = alone.indirect[k] + alone.direct[k];
  }
  light->decoded = work.points;
  if (!counted_) light->decoded += centres_->gathered;
  counted_ = true;
  seconds_.direct += work.direct_seconds;
  seconds_.gather += timer.seconds() - work.direct_seconds;
}

/// @param seconds  that the picture has taken
void PictureJob::check(double seconds) {
  seconds += settings_.check->seconds_before;
  CheckOptions options;
  options.seconds = std::min(kCheckShare * seconds, settings_.check->budget_s - seconds);
  options.max_depth = settings_.max_depth;
  options.seed = hash_combine(settings_.seed, kCheckPaths);
  LightCheck& found = *settings_.check->found;
  found = check_light(from_.bvh, from_.lights, checked_->answers(), options);
  seconds_.check = found.seconds;
}

}  // namespace lte::infer
