#include "infer/common/renderer.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "infer/common/lit_samples.h"
#include "infer/common/sparse_light.h"
#include "infer/common/untrained_light.h"
#include "lte/base/check.h"
#include "lte/base/timer.h"
#include "lte/pathtrace/irradiance.h"

namespace lte::infer {
namespace {

using image::Image;

constexpr std::array<std::pair<const char*, Output>, 7> kOutputs{
    {{"full", Output::Full},
     {"gi", Output::Gi},
     {"irradiance", Output::Irradiance},
     {"direct", Output::Direct},
     {"albedo", Output::Albedo},
     {"normal", Output::Normal},
     {"depth", Output::Depth}}};
// Pixels of a band; its rows are a multiple of the tiles that pixels are asked in.
constexpr int64_t kBandPixels = int64_t{1} << 18;
constexpr int kBandRows = 8;
// As in baked training data, so that the network sees luminaires as densely as it has learnt to.
constexpr double kEmissiveShare = 0.1;
// Estimates keep two colors a point and light group: blocks bound that memory.
constexpr int64_t kEstimateBlock = int64_t{1} << 21;
// Points between two looks at the progress.
constexpr int64_t kProgressBlock = int64_t{1} << 14;

bool is_geometry(Output output) {
  return output == Output::Albedo || output == Output::Normal || output == Output::Depth;
}

/// Adds albedo / π · irradiance: the radiance a Lambertian surface sends back.
void add_reflected(Image* sum, const Image& albedo, const Image& irradiance) {
  if (irradiance.width == 0) return;
  for (size_t i = 0; i < sum->pixels.size(); ++i)
    sum->pixels[i] += albedo.pixels[i] * irradiance.pixels[i] / kPi;
}

/// The chosen picture from its parts.
Image compose(const Frame& frame, Output output) {
  switch (output) {
    case Output::Albedo:
      return frame.albedo;
    case Output::Normal:
      return frame.normal;
    case Output::Depth:
      return frame.depth;
    case Output::Irradiance:
      return frame.indirect;
    default:
      break;
  }
  Image out(frame.albedo.width, frame.albedo.height, 3);
  if (output == Output::Full) out = frame.emission;
  if (output != Output::Gi) add_reflected(&out, frame.albedo, frame.direct);
  if (output == Output::Direct) return out;
  add_reflected(&out, frame.albedo, frame.indirect);
  add_reflected(&out, frame.albedo, frame.total);
  return out;
}

/// Copies the rows of a band, which begin at row `first`, into a picture of `height` rows that is
/// made where it is missing.
void put_rows(const Image& band, int first, int height, Image* picture) {
  if (band.width == 0) return;
  if (band.height == height) {
    *picture = band;
    return;
  }
  if (picture->width == 0) *picture = Image(band.width, height, band.channels);
  std::copy(band.pixels.begin(), band.pixels.end(),
            picture->pixels.begin() + static_cast<int64_t>(picture->offset(0, first)));
}

void put_band(const Frame& band, int first, bool layers, int height, Frame* frame) {
  put_rows(band.color, first, height, &frame->color);
  put_rows(band.depth, first, height, &frame->depth);
  if (layers) {
    put_rows(band.albedo, first, height, &frame->albedo);
    put_rows(band.normal, first, height, &frame->normal);
    put_rows(band.emission, first, height, &frame->emission);
    put_rows(band.direct, first, height, &frame->direct);
    put_rows(band.indirect, first, height, &frame->indirect);
    put_rows(band.total, first, height, &frame->total);
  }
  frame->background += band.background;
  frame->queries += band.queries;
  frame->decoded += band.decoded;
  frame->edge_pixels += band.edge_pixels;
  frame->traced_pixels += band.traced_pixels;
  frame->metal += band.metal;
  frame->metal_by_default += band.metal_by_default;
}

}  // namespace

const char* output_name(Output output) {
  for (const auto& [word, value] : kOutputs) {
    if (value == output) return word;
  }
  return "";
}

Output parse_output(const std::string& word) {
  std::string words;
  for (const auto& [name, value] : kOutputs) {
    if (word == name) return value;
    words += concat(words.empty() ? "" : ", ", name);
  }
  throw Error(concat("output \"", word, "\": expected one of ", words));
}

Mode parse_mode(const std::string& word) {
  LTE_CHECK(word == "neural" || word == "reference", "mode \"", word,
            "\": expected neural or reference");
  return word == "neural" ? Mode::Neural : Mode::Reference;
}

Metal parse_metal(const std::string& word) {
  LTE_CHECK(word == "diffuse" || word == "black" || word == "trace", "metal \"", word,
            "\": expected diffuse, black or trace");
  return word == "diffuse" ? Metal::Diffuse : word == "black" ? Metal::Black : Metal::Trace;
}

scene::SurfaceSamples sample_scene_points(const pathtrace::Bvh& bvh, int64_t count, bool prune,
                                          uint64_t seed, pathtrace::PruneCounts* counts) {
  scene::SamplerOptions sampler;
  sampler.seed = seed;
  sampler.emissive_share = kEmissiveShare;
  if (!prune) return scene::sample_surface(bvh.scene(), count, sampler);
  const pathtrace::ReachOptions reach{pathtrace::ReachOptions().max_depth, seed};
  pathtrace::PruneCounts ignored;
  return pathtrace::sample_reached_surface(bvh, count, sampler, pathtrace::Sides::Either, reach,
                                           counts != nullptr ? counts : &ignored);
}

/// A picture in the making.
struct Renderer::Job {
  const scene::Camera& camera;
  const RenderSettings& settings;
  int64_t centre_queries = 0, extra_queries = 0;  ///< of the bands before
  int64_t done = 0;                               ///< pixels of this band that were told of

  void advance(int64_t pixels) {
    if (settings.done && pixels > 0) settings.done(pixels);
    done += pixels;
  }
};

Renderer::Renderer(const scene::Scene& scene) : bvh_(scene), lights_(scene) {}

bool Renderer::needs_network(const RenderSettings& settings) const {
  return settings.mode == Mode::Neural && has_light() && !is_geometry(settings.output) &&
         settings.output != Output::Direct;
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
  embedding_.emplace(network, lit.points(),
                     runtime::EncodeOptions{settings.rescale, {}, settings.memory});
  seconds_.encode = timer.seconds();
}

Metal Renderer::metal_of(const RenderSettings& settings) const {
  if (is_geometry(settings.output) || settings.output == Output::Irradiance || !has_light())
    return Metal::Diffuse;
  if (settings.mode == Mode::Neural) return settings.metal;
  return settings.output == Output::Full ? Metal::Diffuse : Metal::Trace;
}

/// The network's answers. Those for pixel centres are asked apart from those that anti-aliasing
/// adds: matrix products of other sizes may round otherwise, and centres keep every bit.
std::vector<Rgb> Renderer::decode_all(const QuerySet& queries, int64_t centres) const {
  const auto ask = [&](int64_t first, int64_t last) {
    const auto begin = static_cast<size_t>(first), count = static_cast<size_t>(last - first);
    return embedding_->decode({std::span(queries.position).subspan(begin, count),
                               std::span(queries.normal).subspan(begin, count),
                               std::span(queries.albedo).subspan(begin, count)});
  };
  std::vector<Rgb> answers = ask(0, centres);
  if (queries.size() > centres) {
    const std::vector<Rgb> more = ask(centres, queries.size());
    answers.insert(answers.end(), more.begin(), more.end());
  }
  return answers;
}

gi::Answerer Renderer::decoder() const {
  return [this](std::span<const gi::Query> queries) {
    QuerySet set;
    for (const gi::Query& query : queries) {
      set.position.push_back(query.position);
      set.normal.push_back(query.normal);
      set.albedo.push_back(query.albedo);
    }
    return decode_all(set, set.size());
  };
}

void Renderer::decode(const PictureBand& band, const RenderSettings& settings, BandLight* light) {
  LTE_CHECK(embedding_.has_value(), "this output needs a model: embed() comes first");
  const Timer timer;
  const gi::Answerer answerer = settings.answerer ? settings.answerer : decoder();
  SparseLight answers;
  if (settings.sparse) {
    answers = light_sparsely(band, *settings.sparse, answerer);
  } else if (settings.answerer) {
    answers = light_everywhere(band, answerer);
  } else {
    answers = {decode_all(band.queries(), band.centre_queries()), band.queries().size()};
  }
  light->decoded = answers.answers;
  (embedding_->network().predicts_total() ? light->total : light->indirect) =
      std::move(answers.irradiance);
  seconds_.decode += timer.seconds();
}

/// Irradiance by paths. The queries of centres are numbered through the picture, those that
/// anti-aliasing adds from the number of its pixels on, so that they change no other.
void Renderer::estimate(const PictureBand& band, bool direct_only, Job* job, BandLight* light) {
  const RenderSettings& settings = job->settings;
  pathtrace::IrradianceOptions options;
  options.rays = settings.mode == Mode::Reference ? settings.spp : settings.direct_samples;
  options.max_depth = direct_only ? 1 : settings.max_depth;
  options.seed = settings.seed;
  options.direct_only = direct_only;
  RayPace* pace = settings.mode == Mode::Neural ? settings.pace : nullptr;
  const QuerySet& queries = band.queries();
  light->direct.emplace(queries.position.size());
  if (!direct_only) light->indirect.emplace(queries.position.size());
  const int64_t block = std::min(
      kProgressBlock, std::max<int64_t>(1024, kEstimateBlock / std::max(1, lights_.groups())));
  const auto run = [&](int64_t first, int64_t end, int64_t number) {
    for (int64_t begin = first; begin < end; begin += block) {
      const auto b = static_cast<size_t>(begin),
                 n = static_cast<size_t>(std::min(block, end - begin));
      const Timer timer;
      if (pace) {
        options.rays = pace->rays(queries.size() - begin);
        options.variance = false;  // one ray has none, and stays one
      }
      const pathtrace::Irradiance part = pathtrace::estimate_irradiance(
          bvh_, lights_, std::span(queries.position).subspan(b, n),
          std::span(queries.normal).subspan(b, n), options, number + begin - first);
      if (pace) pace->add(static_cast<int64_t>(n), options.rays, timer.seconds());
      for (size_t i = 0; i < n; ++i) {
        (*light->direct)[b + i] = part.direct_sum(static_cast<int64_t>(i));
        if (!direct_only) (*light->indirect)[b + i] = part.indirect_sum(static_cast<int64_t>(i));
      }
      if (end == band.centre_queries()) job->advance(static_cast<int64_t>(n));
    }
  };
  const int64_t centres = band.centre_queries();
  run(0, centres, job->centre_queries);
  run(centres, queries.size(), int64_t{settings.width} * settings.height + job->extra_queries);
  job->centre_queries += centres;
  job->extra_queries += queries.size() - centres;
}

void Renderer::trace_metal(const PictureBand& band, Job* job, BandLight* light) {
  const RenderSettings& settings = job->settings;
  if (band.traced_pixels().empty()) return;
  const Timer timer;
  const int depth = settings.output == Output::Direct ? 1 : settings.max_depth;
  light->traced = pathtrace::trace_pixels(bvh_, lights_, job->camera, settings.width,
                                          settings.height, band.traced_pixels(),
                                          {settings.spp, depth + 1, settings.seed}, settings.done);
  job->done += static_cast<int64_t>(band.traced_pixels().size());
  seconds_.reference += timer.seconds();
}

BandLight Renderer::neural(const PictureBand& band, Job* job) {
  const RenderSettings& settings = job->settings;
  BandLight light;
  const bool network = needs_network(settings);
  if (network) decode(band, settings, &light);
  trace_metal(band, job, &light);
  // A total model's full picture needs no direct light; its indirect share is what direct light
  // leaves.
  const bool full = settings.output == Output::Full;
  if (light.total ? full : !full && settings.output != Output::Direct) return light;
  const Timer timer;
  estimate(band, /*direct_only=*/true, job, &light);
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
  estimate(band, /*direct_only=*/job->settings.output == Output::Direct, job, &light);
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
                          settings.output == Output::Irradiance});
  seconds_.primary += timer.seconds();
  BandLight light;
  if (!is_geometry(settings.output) && has_light() && !by_paths)
    light = settings.mode == Mode::Neural ? neural(band, job) : reference(band, job);
  Frame frame = band.resolve(light);
  if (!by_paths) {
    frame.color = is_geometry(settings.output) || has_light()
                      ? compose(frame, settings.output)
                      : Image(frame.albedo.width, frame.albedo.height, 3);
    job->advance(int64_t{rows.width} * (rows.last - rows.first) - job->done);
  }
  return frame;
}

Frame Renderer::render(const scene::Camera& camera, const RenderSettings& settings) {
  LTE_CHECK(settings.width > 0 && settings.height > 0, "size ", settings.width, "x",
            settings.height, ": both sides must be positive");
  seconds_.primary = seconds_.decode = seconds_.direct = seconds_.reference = 0;
  Job job{camera, settings};
  Frame frame;
  const int64_t tall = kBandPixels / settings.width / kBandRows * kBandRows;
  const auto rows = static_cast<int>(std::max<int64_t>(tall, kBandRows));
  for (int first = 0; first < settings.height; first += rows) {
    const PictureRows part{settings.width, settings.height, first,
                           std::min(first + rows, settings.height)};
    put_band(render_band(part, &job), first, settings.layers, settings.height, &frame);
  }
  if (settings.mode == Mode::Reference && settings.output == Output::Full) {
    const Timer timer;
    frame.color = pathtrace::render_reference(
        bvh_, lights_, camera, settings.width, settings.height,
        {settings.spp, settings.max_depth + 1, settings.seed}, settings.done);
    seconds_.reference = timer.seconds();
  }
  return frame;
}

}  // namespace lte::infer
