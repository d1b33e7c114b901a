#include "bench/pareto/methods.h"

#include <algorithm>
#include <utility>

#include "infer/render/gather_plan.h"
#include "infer/render/quality.h"
#include "infer/render/time_budget.h"
#include "lte/base/check.h"
#include "lte/base/text.h"
#include "lte/base/timer.h"

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
  MethodPicture out{std::move(frame.color), std::move(frame.indirect)};
  // The layers of a denoised reference are those of its paths.
  if (settings.mode == infer::Mode::Reference && settings.denoise != infer::Denoise::Off)
    out.indirect = {};
  for (size_t i = 0; i < out.indirect.pixels.size(); ++i)
    out.indirect.pixels[i] *= frame.albedo.pixels[i] / kPi;
  return out;
}

/// lte_render --mode reference --spp N [--denoise on].
Method paths(int count, bool denoised) {
  Method method;
  method.family = denoised ? "denoised" : "paths";
  method.name = concat(method.family, "-", count);
  method.settings =
      concat(count, count == 1 ? " path a pixel" : " paths a pixel", denoised ? ", denoised" : "");
  method.prepare = [](const MethodScene&) {};
  method.render = [count, denoised](const MethodScene& scene, const scene::Camera& camera, double) {
    RenderSettings settings = settings_of(scene, Indirect::Paths);
    settings.mode = infer::Mode::Reference;
    settings.spp = count;
    settings.denoise = denoised ? infer::Denoise::On : infer::Denoise::Off;
    return render(scene, camera, settings);
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
  for (const int count : {1, 4, 16, 64, 256, 1024}) out.push_back(paths(count, false));
  for (const int count : {1, 4, 16, 64}) out.push_back(paths(count, true));
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
