#include "infer/eval/scenes/scene_methods.h"

#include <algorithm>
#include <utility>

#include "infer/picture/surface_guides.h"
#include "infer/renderer/quality.h"
#include "lte/base/check.h"
#include "lte/base/to_number.h"
#include "lte/embed/embed.h"
#include "lte/embed/untrained_light.h"
#include "lte/render/picture.h"
#include "lte/scene/light_points.h"

namespace lte::infer {
namespace {

constexpr int kMaxPaths = 1 << 20;
/// N of "paths-N" and "paths-N-denoised".
std::optional<std::pair<int, bool>> parse_paths(const std::string& word) {
  const std::string_view head = "paths-", tail = "-denoised";
  if (!word.starts_with(head)) return std::nullopt;
  std::string_view count = std::string_view(word).substr(head.size());
  const bool denoised = count.ends_with(tail);
  if (denoised) count.remove_suffix(tail.size());
  const auto paths = to_number<int>(count);
  if (!paths || *paths < 1 || *paths > kMaxPaths) return std::nullopt;
  return std::pair(*paths, denoised);
}

/// `name`, at --quality preview, or `name`, "-" and another quality.
std::optional<Quality> parse_quality(const std::string& word, const std::string& name) {
  if (word == name) return Quality::Preview;
  for (const Quality quality : {Quality::Draft, Quality::Final}) {
    if (word == concat(name, "-", enum_name(quality))) return quality;
  }
  return std::nullopt;
}

std::string gather_words(Quality quality, const char* light) {
  return concat("as --quality ", enum_name(quality), ": rays that read ", light, ", denoised");
}

SceneMethod method_of(const std::string& word, const SceneModel* model) {
  SceneMethod out;
  out.name = model != nullptr ? word + " " + model->name : word;
  out.model = model;
  if (const auto with_model = parse_quality(word, "network")) {
    out.kind = SceneMethodKind::Network;
    out.quality = *with_model;
    out.settings = gather_words(out.quality, "a cache of the network's light");
  } else if (word == "decoded") {
    out.kind = SceneMethodKind::Decoded;
    out.settings = "the network decoded at every pixel; direct light as --quality preview";
  } else if (const auto without = parse_quality(word, "gather")) {
    out.kind = SceneMethodKind::Gather;
    out.quality = *without;
    out.settings = gather_words(out.quality, "a cache of path-traced light");
  } else {
    const auto paths = parse_paths(word);
    LTE_CHECK(paths.has_value(), "--methods: \"", word,
              "\" is no method: expected network, gather, either with -draft or -final behind it, "
              "decoded, paths-N or paths-N-denoised, such as paths-16");
    out.paths = paths->first;
    out.kind = paths->second ? SceneMethodKind::DenoisedPaths : SceneMethodKind::Paths;
    out.settings = concat(out.paths, " paths a pixel", paths->second ? ", denoised" : "");
  }
  return out;
}

bool asks_model(const std::string& word) {
  return word == "decoded" || parse_quality(word, "network").has_value();
}

/// @param out  the picture's size and what else all methods share
RenderSettings settings_of(const SceneMethod& method, RenderSettings out) {
  out = with_quality(method.quality, out);
  switch (method.kind) {
    case SceneMethodKind::Network:
      out.method = Method::Network;
      break;
    case SceneMethodKind::Gather:
    case SceneMethodKind::Decoded:
      break;
    case SceneMethodKind::Paths:
    case SceneMethodKind::DenoisedPaths:
      out = with_paths(method.paths, out);
      out.method = Method::Path;
      out.denoise = method.kind == SceneMethodKind::DenoisedPaths;
      out.denoise_quality = image::OidnQuality::High;
      break;
  }
  return out;
}

/// Indirect irradiance that the network decodes at what pixel centres see.
image::Image decoded(const Renderer& renderer, const scene::Camera& camera,
                     const RenderSettings& settings) {
  const SurfaceGuides guides =
      trace_guides(renderer.bvh(), camera, settings.width, settings.height);
  const SurfacePoints points = points_of(guides);
  std::vector<Rgb> albedo;
  for (const uint64_t pixel : points.pixel) albedo.push_back(guides.albedo.rgb(pixel));
  const std::vector<Rgb> light =
      renderer.embedding().decode({points.position, points.normal, albedo});
  image::Image out(settings.width, settings.height, 3);
  for (size_t i = 0; i < light.size(); ++i) out.set_rgb(points.pixel[i], light[i]);
  return out;
}

}  // namespace

bool asks_models(const std::vector<std::string>& words) {
  return std::any_of(words.begin(), words.end(), asks_model);
}

std::vector<SceneMethod> scene_methods(const std::vector<std::string>& words,
                                       const std::vector<SceneModel>& models) {
  std::vector<SceneMethod> out;
  const auto add = [&](SceneMethod method) {
    const bool known = std::any_of(out.begin(), out.end(), [&](const SceneMethod& other) {
      return other.name == method.name;
    });
    if (!known) out.push_back(std::move(method));
  };
  // Those of a model stand together, as they share its embedding of a scene.
  bool has_network = false;
  for (const std::string& word : words) {
    if (!asks_model(word)) add(method_of(word, nullptr));
    if (!asks_model(word) || std::exchange(has_network, true)) continue;
    for (const SceneModel& model : models) {
      for (const std::string& other : words) {
        if (asks_model(other)) add(method_of(other, &model));
      }
    }
  }
  return out;
}

std::string ScenePainter::not_for(const SceneMethod& method) const {
  if (method.model == nullptr) return "";
  const runtime::ModelMetadata& model = method.model->network.metadata();
  return embed::has_untrained_light(*view_.scene, model)
             ? embed::untrained_light_note(*view_.scene, model)
             : "";
}

Seconds ScenePainter::embed(const SceneModel& model, embed::Reader reader) {
  const Stopwatch watch;
  EmbedSettings settings;
  settings.reader = reader;
  settings.seed = settings_.seed;
  settings.rescale = true;
  settings.memory = settings_.memory;
  settings.scene_points = embed::scene_point_count(view_.renderer->bvh(), model.network, settings);
  const std::pair made{&model, settings.scene_points};
  if (embedded_ == made) return embedding_seconds_;
  settings.culled_lights = embed::culled_lights(view_.renderer->bvh(), model.network, settings,
                                                std::vector<scene::Camera>{view_.camera});
  view_.renderer->embed(model.network, settings);
  embedded_ = made;
  embedding_seconds_ = watch.seconds();
  return embedding_seconds_;
}

ScenePictures ScenePainter::paint(const SceneMethod& method) {
  ScenePictures out;
  Renderer& renderer = *view_.renderer;
  const bool decodes = method.kind == SceneMethodKind::Decoded;
  if (method.model != nullptr)
    out.seconds = embed(*method.model, decodes ? embed::Reader::Points : embed::Reader::Rays);
  RenderSettings settings;
  settings.width = settings_.width;
  settings.height = settings_.height;
  settings.max_depth = settings_.max_depth;
  settings.seed = settings_.seed;
  settings = settings_of(method, settings);
  const Stopwatch watch;
  if (decodes) settings.output = Output::Direct;
  if (renderer.needs_cache(settings)) {
    render::CacheSettings cache;
    cache.paths = record_paths(settings);
    cache.max_depth = settings_.max_depth;
    cache.seed = settings_.seed;
    renderer.make_cache(settings.method, cache);
  }
  Frame frame = renderer.render(view_.camera, settings);
  if (decodes) {
    frame.indirect = decoded(renderer, view_.camera, settings);
    out.whole = render::compose(frame, Output::Full);
  } else {
    out.whole = std::move(frame.color);
  }
  out.seconds = out.seconds + watch.seconds();
  settings.output = Output::Irradiance;
  out.irradiance =
      decodes ? std::move(frame.indirect) : renderer.render(view_.camera, settings).color;
  return out;
}

std::vector<std::string> size_notes(const SceneView& view, const std::vector<SceneModel>& models) {
  const double extent = double{max_component(scene::point_bounds(*view.scene).extent())};
  std::vector<std::string> out;
  for (const SceneModel& model : models) {
    const double known = model.network.config().scale;
    if (extent > known)
      out.push_back(concat("spans ", extent, " m: shrunk to the ", known, " m that ", model.name,
                           " knows, for the network alone"));
  }
  return out;
}

}  // namespace lte::infer
