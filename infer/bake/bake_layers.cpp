#include "infer/bake/bake_layers.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "lte/bake/light_group.h"
#include "lte/base/file.h"
#include "lte/base/interruption.h"
#include "lte/base/log.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/cli/numbers.h"
#include "lte/cli/progress.h"
#include "lte/scene/sampler.h"

namespace lte::infer {
namespace {

constexpr uint64_t kCache = 71;
constexpr int kProgressSteps = 1000;
/// Passes that --time and --error may take.
constexpr int kManyPasses = 4096;

/// Mean over texels, even: they alternate between two halves. A preview has more where the light
/// map is so small that all its rays are fewer than kPreviewRays: there rays cost little, and a
/// denoiser is worth least.
constexpr int kDraftPasses = 2, kPreviewPasses = 4, kMostPreviewPasses = 16, kFinalPasses = 12;
constexpr double kPreviewRays = 3e6;

int passes_of(Quality quality, double texels, int rays) {
  if (quality == Quality::Draft) return kDraftPasses;
  const double pairs = kPreviewRays / (std::max(texels, 1.0) * rays * 2);
  const int preview = 2 * static_cast<int>(std::lround(
                              std::clamp(pairs, kPreviewPasses / 2.0, kMostPreviewPasses / 2.0)));
  return quality == Quality::Final ? std::max(preview, kFinalPasses) : preview;
}

}  // namespace

bake::LightOptions quality_options(Quality quality, double texels) {
  bake::LightOptions out;
  out.passes = passes_of(quality, texels, out.rays);
  // Gathered light errs where its records do, which shows when noise is gone.
  out.path_passes = quality == Quality::Final ? 16 : 0;
  return out;
}

namespace {

/// @param texels  expected_texels()
bake::LightOptions light_options(const BakeRequest& request, double texels) {
  bake::LightOptions out =
      quality_options(parse_enum<Quality>("--quality", request.quality), texels);
  out.direct = request.include == "full";
  out.max_depth = request.max_depth;
  out.seed = request.seed;
  if (!request.time.empty() || request.error > 0) {
    out.passes = request.by_paths() ? kManyPasses : kPreviewPasses;
    out.path_passes = kManyPasses;
    out.error = request.error;
  }
  return out;
}

std::unique_ptr<render::Integrator> integrator_of(const BakeRequest& request,
                                                  const render::TracedScene& scene,
                                                  render::IrradianceSource source) {
  if (request.by_paths()) return render::make_path(scene, request.max_depth);
  render::CacheSettings cache = cache_settings(request);
  cache.seed = hash_combine(request.seed, kCache);
  const double texels = expected_texels(request, scene.bvh.scene());
  const bake::LightOptions light = light_options(request, texels);
  // A network answers at each record, which takes longer than paths.
  if (cache.records == 0)
    cache.records = bake::record_count(request.needs_network() ? 0 : texels, light);
  cache.paths = bake::record_paths(texels, cache.records, light);
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

/// Bakes layers, or a shard of each.
class LayerBaker {
 public:
  LayerBaker(const BakeRequest& request, const bake::Layout& layout, const BakeParts* parts)
      : request_(request), layout_(layout), parts_(parts) {
    if (!request.shard.empty()) {
      shards_ = {parse_shard(request.shard)};
    } else {
      const int count = request.resume ? std::max(1, parts->shards()) : 1;
      for (int k = 0; k < count; ++k) shards_.push_back({k, count});
    }
    keeps_ = parts != nullptr && request.time.empty() && request.error <= 0;
  }

  int shards() const { return shards_.front().count; }

  /// The light of the next layer. Of one shard its part is written, and nothing comes back.
  /// @param state  gets the samples; may be null
  bake::TexelLight operator()(const render::TracedScene& scene,
                              const render::Integrator& integrator, bake::LightOptions options,
                              bake::LightState* state = nullptr) {
    std::vector<bake::LightState> states;
    for (const bake::Shard shard : shards_) {
      std::optional<bake::LightState> kept;
      if (request_.resume) {
        kept = parts_->read(shard, layer_, layout_.texels.size(),
                            static_cast<size_t>(layout_.atlas.charts), options.direct);
      }
      options.from = kept ? &*kept : nullptr;
      options.shard = shard;
      if (keeps_) options.keep = [&](const bake::LightState& now) { keep(shard, now); };
      states.push_back(
          bake::sample_texels(scene, integrator, layout_.atlas, layout_.texels, options));
    }
    ++layer_;
    if (!request_.shard.empty()) {
      write(shards_[0], layer_ - 1, states[0]);
      return {};
    }
    bake::LightState all = bake::joined(states);
    if (state != nullptr) *state = all;
    return bake::light_of(scene.bvh, integrator.method(), layout_.atlas, layout_.texels, options,
                          std::move(all));
  }

 private:
  void write(bake::Shard shard, size_t layer, const bake::LightState& state) const {
    make_directory(request_.out);
    parts_->write(shard, layer, state);
  }

  /// Now and then: a bake that needs no part goes on without, too.
  void keep(bake::Shard shard, const bake::LightState& state) {
    if (since_.seconds() < request_.keep_every) return;
    try {
      write(shard, layer_, state);
    } catch (const Error& error) {
      if (!request_.shard.empty()) throw;
      log_warning(error.what(), "; --resume will not find what has been sampled");
      keeps_ = false;
    }
    since_.restart();
  }

  const BakeRequest& request_;
  const bake::Layout& layout_;
  const BakeParts* parts_;  ///< null: nothing is kept
  std::vector<bake::Shard> shards_;
  size_t layer_ = 0;
  bool keeps_ = true;
  Timer since_;
};

bake::TexelLight bake_changes(const render::TracedScene& scene,
                              const render::Integrator& integrator, const bake::Layout& layout,
                              const bake::LightOptions& options, double tolerance, SinceBake* since,
                              bake::LightState* state) {
  const KeptBake& old = since->old;
  const pathtrace::Bvh old_bvh(old.atlas.scene);
  const pathtrace::Lights old_lights(old.atlas.scene);
  since->kept = bake::find_changes({old_bvh, old_lights}, scene, since->relayout, old.light,
                                   options, {tolerance});
  bake::LightState found = bake::rebake(scene, integrator, layout, options, old.light, since->kept);
  if (state != nullptr) *state = found;
  bake::TexelLight out = bake::rebaked_light(scene.bvh, integrator.method(), layout, options,
                                             std::move(found), old.light, since->kept);
  // Of the same samples a texel; what is not smoothed here would say otherwise.
  out.expected_error = old.expected_error;
  return out;
}

}  // namespace

double expected_texels(const BakeRequest& request, const scene::Scene& scene) {
  const bake::AtlasOptions& atlas = request.atlas;
  return atlas.size > 0 ? std::pow(static_cast<double>(atlas.size), 2) * kAtlasUse
                        : scene::surface_area(scene) * std::pow(atlas.texels_per_metre, 2);
}

PreparedIntegrator::PreparedIntegrator(const BakeRequest& request, const render::TracedScene& scene)
    : request_(request), scene_(scene) {
  if (request.needs_network()) return;
  made_ = std::async(num_threads() > 1 ? std::launch::async : std::launch::deferred, [this] {
    const Interruption::Shared shared(dropped_);
    auto integrator = integrator_of(request_, scene_, {});
    integrator->prepare();
    return integrator;
  });
}

PreparedIntegrator::~PreparedIntegrator() { dropped_ = true; }

std::unique_ptr<render::Integrator> PreparedIntegrator::get(
    const render::IrradianceSource& source) {
  if (made_.valid()) return made_.get();
  auto integrator = integrator_of(request_, scene_, source);
  integrator->prepare();
  return integrator;
}

std::vector<bake::BakedLayer> bake_layers(const BakeRequest& request,
                                          const runtime::Network* network,
                                          const EmbedSettings& settings, const bake::Layout& layout,
                                          PreparedIntegrator* prepared, double seconds,
                                          const BakeParts* parts, SinceBake* since,
                                          bake::LightState* state, Renderer* renderer) {
  const Timer timer;
  const double time = request.time.empty() ? INFINITY : parse_time(request.time) - seconds;
  render::IrradianceSource source;
  if (network != nullptr) {
    renderer->embed(*network, settings);
    source = renderer->source();
  }
  const render::TracedScene traced{renderer->bvh(), renderer->lights()};
  const auto integrator = prepared->get(source);
  ShownProgress progress;
  LayerBaker bake_layer(request, layout, parts);
  const scene::Scene& scene = renderer->bvh().scene();
  bake::LightOptions options = light_options(request, expected_texels(request, scene));
  options.progress = [&](double share) { progress(share); };
  options.seconds = time - timer.seconds();
  std::vector<bake::BakedLayer> out;
  if (since != nullptr) {
    out.push_back({"light", bake_changes(traced, *integrator, layout, options, request.change,
                                         since, state)});
  } else if (!request.by_light) {
    out.push_back({"light", bake_layer(traced, *integrator, options, state)});
  } else {
    // Sides by all light, so that layers are of the same.
    const bake::Sides sides = bake::find_sides(*integrator, layout.atlas, layout.texels, options);
    options.sides = &sides;
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
                     bake_layer({bvh, lights}, *by, options)});
    }
  }
  if (!request.shard.empty()) out.clear();
  return out;
}

}  // namespace lte::infer
