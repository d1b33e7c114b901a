#include "infer/bake/bake_layers.h"

#include <cmath>
#include <memory>
#include <utility>

#include "lte/bake/light_group.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/cli/numbers.h"
#include "lte/cli/progress.h"

namespace lte::infer {
namespace {

constexpr uint64_t kCache = 71;
constexpr int kProgressSteps = 1000;
/// Passes that --time and --error may take.
constexpr int kManyPasses = 4096;

/// Passes by the word of --quality.
bake::LightOptions light_options(const BakeRequest& request) {
  bake::LightOptions out;
  out.direct = request.include == "full";
  out.max_depth = request.max_depth;
  out.seed = request.seed;
  const Quality quality = parse_enum<Quality>("--quality", request.quality);
  // Paths cost little more than gathered rays and carry no light into the dark.
  out.passes = quality == Quality::Final ? 4 : 2;
  out.path_passes = quality == Quality::Draft ? 0 : quality == Quality::Preview ? 8 : 32;
  if (!request.time.empty() || request.error > 0) {
    out.passes = request.integrator == "path" ? kManyPasses : 2;
    out.path_passes = kManyPasses;
    out.error = request.error;
  }
  return out;
}

std::unique_ptr<render::Integrator> integrator_of(const BakeRequest& request,
                                                  const render::TracedScene& scene,
                                                  render::IrradianceSource source) {
  if (request.integrator == "path") return render::make_path(scene, request.max_depth);
  render::CacheSettings cache;
  cache.records = request.records;
  cache.max_depth = request.max_depth;
  cache.seed = hash_combine(request.seed, kCache);
  return render::make_gather(scene, cache, std::move(source));
}

struct ShownProgress {
  Progress progress{"baking", kProgressSteps, "steps"};
  int64_t shown = 0;
  void operator()(double share) {
    const auto now = static_cast<int64_t>(share * kProgressSteps);
    if (now > shown) progress.advance(now - shown);
    shown = std::max(shown, now);
  }
};

}  // namespace

std::vector<bake::BakedLayer> bake_layers(const BakeRequest& request,
                                          const runtime::Network* network,
                                          const EmbedSettings& settings, const bake::Layout& layout,
                                          double seconds, Renderer* renderer) {
  const Timer timer;
  const double time = request.time.empty() ? INFINITY : parse_time(request.time) - seconds;
  render::IrradianceSource source;
  if (network != nullptr) {
    provide_embedding(request.embedding, *network, settings, renderer);
    source = renderer->source();
  }
  const render::TracedScene traced{renderer->bvh(), renderer->lights()};
  const auto integrator = integrator_of(request, traced, source);
  integrator->prepare();
  ShownProgress progress;
  bake::LightOptions options = light_options(request);
  options.progress = [&](double share) { progress(share); };
  options.seconds = time - timer.seconds();
  const scene::Scene& scene = renderer->bvh().scene();
  std::vector<bake::BakedLayer> out;
  if (!request.by_light) {
    out.push_back(
        {"light", bake::light_texels(traced, *integrator, layout.atlas, layout.texels, options)});
    return out;
  }
  // Sides by all light, so that layers are of the same.
  bake::LightOptions sides = options;
  sides.passes = 2;
  sides.path_passes = 0;
  sides.progress = {};
  const bake::TexelLight all =
      bake::light_texels(traced, *integrator, layout.atlas, layout.texels, sides);
  options.back = &all.back;
  const auto trees = pathtrace::Bvh::with_own_meshes(scene);
  const auto groups = static_cast<int>(scene.light_groups.size());
  for (int group = 0; group < groups; ++group) {
    std::vector<int> tree_of_mesh;
    const scene::Scene one = bake::with_light_of(scene, group, &tree_of_mesh);
    const pathtrace::Bvh bvh(one, *trees, tree_of_mesh);
    const pathtrace::Lights lights(one);
    const auto by = integrator_of(request, {bvh, lights}, {});
    by->prepare();
    options.progress = [&](double share) { progress((group + share) / groups); };
    options.seconds = (time - timer.seconds()) / (groups - group);
    out.push_back({scene.light_groups[static_cast<size_t>(group)],
                   bake::light_texels({bvh, lights}, *by, layout.atlas, layout.texels, options)});
    out.back().light.two_sided = all.two_sided;
  }
  return out;
}

}  // namespace lte::infer
