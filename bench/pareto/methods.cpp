#include "bench/pareto/methods.h"

#include <algorithm>
#include <utility>

#include "infer/renderer/quality.h"
#include "lte/base/check.h"
#include "lte/base/text.h"

namespace lte::bench {
namespace {

using infer::Quality;
using infer::RenderSettings;
using By = render::Method;  // how light is computed; a Method is a row of the chart

RenderSettings settings_of(const MethodScene& scene, By by) {
  RenderSettings settings;
  settings.method = by;
  settings.width = scene.width;
  settings.height = scene.height;
  settings.max_depth = scene.max_depth;
  settings.seed = scene.seed;
  return settings;
}

void prepare(const MethodScene& scene, By by) {
  if (by == By::Path) return;
  if (by == By::Network) {
    infer::EmbedSettings settings;
    settings.seed = scene.seed;
    settings.rescale = true;
    settings.reader = embed::Reader::Rays;
    scene.renderer.embed(scene.network, settings);
  }
  render::CacheSettings cache;
  cache.max_depth = scene.max_depth;
  cache.seed = scene.seed;
  scene.renderer.make_cache(by, cache);
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

/// lte_render --integrator path --spp N.
Method paths(int count, bool denoised) {
  Method method;
  method.family = denoised ? "denoised" : "paths";
  method.name = concat(method.family, "-", count);
  method.settings = concat(count, count == 1 ? " path a pixel" : " paths a pixel",
                           denoised ? ", denoised: Open Image Denoise where it is found" : "");
  method.prepare = [](const MethodScene& scene) { prepare(scene, By::Path); };
  method.render = [count, denoised](const MethodScene& scene, const scene::Camera& camera, double) {
    RenderSettings settings = infer::with_paths(count, settings_of(scene, By::Path));
    settings.denoise = denoised;
    return render(scene, camera, settings);
  };
  return method;
}

/// lte_render --integrator FAMILY --quality Q.
Method by_quality(By by, Quality quality) {
  Method method;
  method.family = enum_name(by);
  method.name = concat(method.family, "-", enum_name(quality));
  method.settings = concat("as --integrator ", method.family, " --quality ", enum_name(quality));
  method.prepare = [by](const MethodScene& scene) { prepare(scene, by); };
  method.render = [by, quality](const MethodScene& scene, const scene::Camera& camera, double) {
    return render(scene, camera, infer::with_quality(quality, settings_of(scene, by)));
  };
  return method;
}

/// lte_render --time: work before the first view and one view together take this time.
Method by_time(double seconds) {
  Method method;
  method.family = "time";
  method.name = formatted("time-%gs", seconds);
  method.settings = formatted("as --time %gs", seconds);
  method.prepare = [](const MethodScene& scene) { prepare(scene, By::Gather); };
  method.render = [seconds](const MethodScene& scene, const scene::Camera& camera, double spent_s) {
    return render(scene, camera,
                  infer::with_time(seconds - spent_s, settings_of(scene, By::Gather)));
  };
  return method;
}

}  // namespace

std::vector<Method> all_methods() {
  std::vector<Method> out;
  for (const int count : {1, 4, 16, 64, 256, 1024}) out.push_back(paths(count, false));
  for (const int count : {1, 4, 16, 64}) out.push_back(paths(count, true));
  for (const By by : {By::Network, By::Gather}) {
    for (const Quality quality : {Quality::Draft, Quality::Preview, Quality::Final})
      out.push_back(by_quality(by, quality));
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
