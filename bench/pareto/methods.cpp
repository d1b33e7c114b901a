#include "bench/pareto/methods.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "infer/picture/picture_band.h"
#include "infer/picture/surface_guides.h"
#include "infer/render/gather_plan.h"
#include "infer/render/quality.h"
#include "infer/render/time_budget.h"
#include "infer/renderer/denoised_paths.h"
#include "lte/base/check.h"
#include "lte/base/text.h"
#include "lte/base/timer.h"
#include "lte/image/denoise.h"
#include "lte/pathtrace/gbuffer.h"
#include "lte/pathtrace/render.h"

namespace lte::bench {
namespace {

using infer::Indirect;
using infer::Quality;
using infer::RenderSettings;
using infer::Sparse;
using infer::TableLight;

void embed(const MethodScene& scene) {
  infer::EmbedSettings settings;
  settings.seed = scene.seed;
  settings.rescale = true;
  scene.renderer.embed(scene.network, settings);
}

void make_table(const MethodScene& scene, TableLight light) {
  infer::TableSettings settings;
  settings.light = light;
  settings.max_depth = scene.max_depth;
  settings.seed = scene.seed;
  scene.renderer.make_table(settings);
}

RenderSettings settings_of(const MethodScene& scene, Indirect indirect) {
  RenderSettings settings;
  settings.indirect = indirect;
  settings.denoise = infer::Denoise::Auto;
  settings.width = scene.width;
  settings.height = scene.height;
  settings.max_depth = scene.max_depth;
  settings.seed = scene.seed;
  return settings;
}

MethodPicture render(const MethodScene& scene, const scene::Camera& camera,
                     const RenderSettings& settings) {
  infer::Frame frame = scene.renderer.render(camera, settings);
  return {std::move(frame.color),
          [indirect = std::move(frame.indirect), albedo = std::move(frame.albedo)]() mutable {
            for (size_t i = 0; i < indirect.pixels.size(); ++i)
              indirect.pixels[i] *= albedo.pixels[i] / kPi;
            return std::move(indirect);
          }};
}

/// lte_render --mode reference --spp N.
Method paths(int count) {
  Method method;
  method.family = "paths";
  method.name = concat("paths-", count);
  method.settings = concat(count, count == 1 ? " path a pixel" : " paths a pixel");
  method.prepare = [](const MethodScene&) {};
  method.render = [count](const MethodScene& scene, const scene::Camera& camera, double) {
    RenderSettings settings = settings_of(scene, Indirect::Paths);
    settings.mode = infer::Mode::Reference;
    settings.spp = count;
    settings.denoise = infer::Denoise::Off;
    return render(scene, camera, settings);
  };
  return method;
}

/// Paths and a denoiser that has albedo, normals and emission of whole pixels, as renderers give
/// them to denoisers.
MethodPicture render_denoised(const MethodScene& scene, const scene::Camera& camera, int count,
                              const std::shared_ptr<const image::Denoiser>& denoiser) {
  const pathtrace::Bvh& bvh = scene.renderer.bvh();
  pathtrace::RadianceLayers layers;
  pathtrace::render_reference(bvh, scene.renderer.lights(), camera, scene.width, scene.height,
                              {count, scene.max_depth + 1, scene.seed}, {}, &layers);
  const pathtrace::GBuffer hits = pathtrace::trace_gbuffer(bvh, camera, scene.width, scene.height);
  const auto guides = std::make_shared<const infer::SurfaceGuides>(infer::guides_of(hits));
  const infer::PictureBand band(bvh, camera, {scene.width, scene.height, 0, scene.height},
                                {.antialias = infer::kAntialias, .mean_normal = true}, &hits);
  const auto seen = std::make_shared<const infer::Frame>(band.resolve({}));
  const auto denoise = [denoiser, guides, seen](const image::Image& light) {
    return infer::denoise_reflected(*denoiser, *guides, light, {seen->albedo, seen->mean_normal});
  };
  image::Image reflected = std::move(layers.direct);
  for (size_t i = 0; i < reflected.pixels.size(); ++i)
    reflected.pixels[i] += layers.indirect.pixels[i];
  image::Image whole = denoise(reflected);
  for (size_t i = 0; i < whole.pixels.size(); ++i) whole.pixels[i] += seen->emission.pixels[i];
  return {std::move(whole),
          [denoise, indirect = std::move(layers.indirect)] { return denoise(indirect); }};
}

Method denoised_paths(int count) {
  Method method = paths(count);
  method.family = "denoised";
  method.name = concat("denoised-", count);
  method.settings += ", denoised: Open Image Denoise where it is found";
  const auto denoiser = std::make_shared<std::shared_ptr<const image::Denoiser>>();
  method.prepare = [denoiser](const MethodScene&) {
    *denoiser = std::make_shared<const image::Denoiser>();
  };
  method.render = [denoiser, count](const MethodScene& scene, const scene::Camera& camera, double) {
    return render_denoised(scene, camera, count, *denoiser);
  };
  return method;
}

/// lte_render --indirect FAMILY --quality Q.
Method by_quality(const std::string& family, Quality quality) {
  const bool decodes = family == "decoded", gathers = family == "gather";
  Method method;
  method.family = family;
  method.name = concat(family, "-", enum_name(quality));
  method.settings = concat("as --indirect ", family, " --quality ", enum_name(quality));
  method.prepare = [decodes, gathers](const MethodScene& scene) {
    if (!gathers) embed(scene);
    if (!decodes) make_table(scene, gathers ? TableLight::Raw : TableLight::Network);
  };
  method.render = [decodes, quality](const MethodScene& scene, const scene::Camera& camera,
                                     double) {
    const RenderSettings base = settings_of(scene, decodes ? Indirect::Decoded : Indirect::Gather);
    return render(scene, camera, infer::with_quality(quality, Sparse::Auto, {}, base));
  };
  return method;
}

/// lte_render --time-budget: work before the first view and one view together take this time.
Method by_time(double seconds) {
  Method method;
  method.family = "budget";
  method.name = formatted("budget-%gs", seconds);
  method.settings = formatted("as --time-budget %gs", seconds);
  method.prepare = [](const MethodScene& scene) { make_table(scene, TableLight::Raw); };
  method.render = [seconds](const MethodScene& scene, const scene::Camera& camera, double spent_s) {
    const Timer clock;
    const infer::PicturePlan plan =
        infer::plan_gathered(seconds - spent_s, clock, Sparse::Auto, {},
                             settings_of(scene, Indirect::Gather), camera, &scene.renderer);
    return render(scene, camera, plan.settings);
  };
  return method;
}

}  // namespace

std::vector<Method> all_methods() {
  std::vector<Method> out;
  for (const int count : {1, 4, 16, 64, 256, 1024}) out.push_back(paths(count));
  for (const int count : {1, 4, 16, 64}) out.push_back(denoised_paths(count));
  for (const char* family : {"network", "decoded", "gather"}) {
    for (const Quality quality : {Quality::Draft, Quality::Preview, Quality::Final})
      out.push_back(by_quality(family, quality));
  }
  for (const double seconds : {0.5, 1.0, 2.0, 5.0, 10.0, 30.0}) out.push_back(by_time(seconds));
  return out;
}

std::vector<Method> choose_methods(const std::vector<std::string>& words) {
  std::vector<Method> all = all_methods();
  if (words.empty()) return all;
  std::vector<std::string> families;
  std::string list;
  for (const Method& method : all) {
    if (std::find(families.begin(), families.end(), method.family) != families.end()) continue;
    families.push_back(method.family);
    list += (list.empty() ? "" : ", ") + method.family;
  }
  for (const std::string& word : words) {
    LTE_CHECK(std::any_of(all.begin(), all.end(),
                          [&](const Method& m) { return m.name == word || m.family == word; }),
              "--methods: \"", word, "\" is no method: expected a family (", list,
              ") or one of its rows, such as ", all.front().name);
  }
  std::erase_if(all, [&](const Method& m) {
    return std::none_of(words.begin(), words.end(), [&](const std::string& word) {
      return m.name == word || m.family == word;
    });
  });
  return all;
}

}  // namespace lte::bench
