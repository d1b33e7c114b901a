#include "infer/common/renderer.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "infer/common/lit_samples.h"
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
// Square tiles of pixels: their shadow rays meet the same nodes and triangles.
constexpr int kTile = 8;
// As in baked training data, so that the network sees luminaires as densely as it has learnt to.
constexpr double kEmissiveShare = 0.1;
// Estimates keep two colors a point and light group: blocks bound that memory.
constexpr int64_t kEstimateBlock = int64_t{1} << 21;

bool is_geometry(Output output) {
  return output == Output::Albedo || output == Output::Normal || output == Output::Depth;
}

Image rgb_image(int width, int height, const std::vector<Rgb>& values) {
  Image out(width, height, 3);
  const std::span<const float> flat = floats(values);
  std::copy(flat.begin(), flat.end(), out.pixels.begin());
  return out;
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

/// Pixels that reflect light, tile by tile: background and black surfaces are never asked about.
/// The order numbers the random streams of direct light, so another one is another picture.
struct Renderer::Queries {
  int width, height;
  std::vector<int64_t> pixel;
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;

  explicit Queries(const pathtrace::GBuffer& hits) : width(hits.width), height(hits.height) {
    for (int tile_y = 0; tile_y < height; tile_y += kTile) {
      for (int tile_x = 0; tile_x < width; tile_x += kTile) add_tile(hits, tile_x, tile_y);
    }
  }

  void add_tile(const pathtrace::GBuffer& hits, int tile_x, int tile_y) {
    for (int y = tile_y; y < std::min(tile_y + kTile, height); ++y) {
      for (int x = tile_x; x < std::min(tile_x + kTile, width); ++x) {
        const size_t i =
            static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
        if (!hits.mask[i] || max_component(hits.albedo[i]) <= 0) continue;
        pixel.push_back(static_cast<int64_t>(i));
        position.push_back(hits.position[i]);
        normal.push_back(hits.normal[i]);
        albedo.push_back(hits.albedo[i]);
      }
    }
  }

  Image scatter(std::span<const Rgb> values) const {
    Image out(width, height, 3);
    for (size_t i = 0; i < values.size(); ++i) {
      float* p = out.pixels.data() + 3 * pixel[i];
      p[0] = values[i].x;
      p[1] = values[i].y;
      p[2] = values[i].z;
    }
    return out;
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

pathtrace::GBuffer Renderer::trace(const scene::Camera& camera, const RenderSettings& settings,
                                   Frame* frame) {
  const Timer timer;
  const int width = settings.width, height = settings.height;
  pathtrace::GBuffer hits = pathtrace::trace_gbuffer(bvh_, camera, width, height);
  frame->albedo = rgb_image(width, height, hits.albedo);
  frame->normal = rgb_image(width, height, hits.normal);
  frame->emission = rgb_image(width, height, hits.emission);
  frame->depth = Image(width, height, 1);
  for (size_t i = 0; i < hits.mask.size(); ++i) {
    if (hits.mask[i]) {
      frame->depth.pixels[i] = hits.depth[i];
    } else {
      ++frame->background;
    }
  }
  seconds_.primary = timer.seconds();
  return hits;
}

image::Image Renderer::estimate(const Queries& queries, const RenderSettings& settings,
                                bool direct_only, Image* indirect) const {
  pathtrace::IrradianceOptions options;
  options.rays = settings.mode == Mode::Reference ? settings.spp : settings.direct_samples;
  options.max_depth = direct_only ? 1 : settings.max_depth;
  options.seed = settings.seed;
  options.direct_only = direct_only;
  const auto count = static_cast<int64_t>(queries.pixel.size());
  const int64_t block = std::max<int64_t>(1024, kEstimateBlock / std::max(1, lights_.groups()));
  std::vector<Rgb> direct(queries.pixel.size()), later(direct_only ? 0 : queries.pixel.size());
  for (int64_t begin = 0; begin < count; begin += block) {
    const auto b = static_cast<size_t>(begin),
               n = static_cast<size_t>(std::min(block, count - begin));
    const pathtrace::Irradiance part =
        pathtrace::estimate_irradiance(bvh_, lights_, std::span(queries.position).subspan(b, n),
                                       std::span(queries.normal).subspan(b, n), options, begin);
    for (size_t i = 0; i < n; ++i) {
      direct[b + i] = part.direct_sum(static_cast<int64_t>(i));
      if (!direct_only) later[b + i] = part.indirect_sum(static_cast<int64_t>(i));
    }
  }
  if (!direct_only) *indirect = queries.scatter(later);
  return queries.scatter(direct);
}

void Renderer::neural(const Queries& queries, const RenderSettings& settings, Frame* frame) {
  const bool network = needs_network(settings);
  const bool total = network && embedding_ && embedding_->network().predicts_total();
  if (network) {
    LTE_CHECK(embedding_.has_value(), "output ", output_name(settings.output),
              " needs a model: embed() comes first");
    const Timer timer;
    Image predicted =
        queries.scatter(embedding_->decode({queries.position, queries.normal, queries.albedo}));
    (total ? frame->total : frame->indirect) = std::move(predicted);
    seconds_.decode = timer.seconds();
  }
  // A total model's full picture needs no direct light; its indirect share is what direct light
  // leaves.
  const bool full = settings.output == Output::Full;
  if (total ? full : !full && settings.output != Output::Direct) return;
  const Timer timer;
  frame->direct = estimate(queries, settings, /*direct_only=*/true, nullptr);
  seconds_.direct = timer.seconds();
  if (!total) return;
  frame->indirect = std::move(frame->total);
  frame->total = Image();
  for (size_t i = 0; i < frame->indirect.pixels.size(); ++i) {
    frame->indirect.pixels[i] = std::max(0.0f, frame->indirect.pixels[i] - frame->direct.pixels[i]);
  }
}

void Renderer::reference(const Queries& queries, const RenderSettings& settings, Frame* frame) {
  const Timer timer;
  if (settings.output == Output::Direct) {
    frame->direct = estimate(queries, settings, /*direct_only=*/true, nullptr);
  } else {
    frame->direct = estimate(queries, settings, /*direct_only=*/false, &frame->indirect);
  }
  seconds_.reference = timer.seconds();
}

Frame Renderer::render(const scene::Camera& camera, const RenderSettings& settings) {
  LTE_CHECK(settings.width > 0 && settings.height > 0, "size ", settings.width, "x",
            settings.height, ": both sides must be positive");
  seconds_.primary = seconds_.decode = seconds_.direct = seconds_.reference = 0;
  Frame frame;
  const Queries queries(trace(camera, settings, &frame));
  frame.queries = static_cast<int64_t>(queries.pixel.size());
  if (is_geometry(settings.output)) {
    frame.color = compose(frame, settings.output);
    return frame;
  }
  if (!has_light()) {
    frame.color = Image(settings.width, settings.height, 3);
    return frame;
  }
  if (settings.mode == Mode::Neural) {
    neural(queries, settings, &frame);
  } else if (settings.output == Output::Full) {
    const Timer timer;
    frame.color =
        pathtrace::render_reference(bvh_, lights_, camera, settings.width, settings.height,
                                    {settings.spp, settings.max_depth + 1, settings.seed});
    seconds_.reference = timer.seconds();
    return frame;
  } else {
    reference(queries, settings, &frame);
  }
  frame.color = compose(frame, settings.output);
  return frame;
}

}  // namespace lte::infer
