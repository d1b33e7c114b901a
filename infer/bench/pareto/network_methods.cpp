// The methods that read light at scene points: the network, and its pipeline without it.
#include <algorithm>
#include <memory>
#include <utility>

#include <ATen/ATen.h>

#include "infer/bench/pareto/lit_picture.h"
#include "infer/bench/pareto/method.h"
#include "infer/bench/pareto/renderer_steps.h"
#include "infer/light/lit_samples.h"
#include "lte/base/timer.h"
#include "lte/nn/constants.h"
#include "lte/ops/irradiance_cache.h"
#include "lte/ops/knn.h"
#include "lte/runtime/tensors.h"

namespace lte::infer {
namespace {

constexpr int kEstimateShadowRays = 16;

/// Estimated indirect irradiance at the scene points that do not emit, read between them.
class EstimateCache {
 public:
  EstimateCache(const LitSamples& lit, float unit) : unit_(unit) {
    for (size_t i = 0; i < lit.light.indirect.size(); ++i) {
      if (max_component(lit.surface.emission[i]) > 0) continue;
      position_.push_back(lit.surface.position[i] / unit);
      normal_.push_back(lit.surface.normal[i]);
      light_.push_back(lit.light.indirect[i]);
    }
  }

  std::vector<Rgb> read(const QueryPoints& queries, int neighbours) const {
    std::vector<Vec3> where(queries.position.begin(), queries.position.end());
    std::vector<Rgb> out(where.size());
    if (position_.empty() || where.empty()) return out;
    for (Vec3& p : where) p = p / unit_;
    const at::Tensor query = runtime::borrow(where), points = runtime::borrow(position_);
    const at::Tensor near = std::get<0>(ops::knn(query, points, neighbours));
    const at::Tensor light = runtime::borrow(light_);
    const at::Tensor means = ops::irradiance_cache_means(
        query, runtime::borrow(queries.normal), points, runtime::borrow(normal_),
        at::cat({light, at::zeros_like(light)}, 1), {}, near, nn::kCacheWeights);
    const auto rows = means.accessor<float, 2>();
    for (size_t i = 0; i < out.size(); ++i) {
      const auto row = rows[static_cast<int64_t>(i)];
      out[i] = {row[0], row[1], row[2]};
    }
    return out;
  }

 private:
  float unit_;  ///< metres that a position counts in, near the extent of the scene
  std::vector<Vec3> position_, normal_;
  std::vector<Rgb> light_;
};

/// lte_render with these settings, but for size, depth and seed.
Method network_method(const std::string& name, const std::string& family, const std::string& words,
                      const RenderSettings& settings) {
  Method method{name, family, words, {}};
  method.prepare = [settings](const MethodScene& scene, StageTimes* stages) -> RenderView {
    embed_scene(scene, stages);
    return [scene, settings](const scene::Camera& camera, StageTimes* view) {
      MethodPicture picture = render_view(scene, settings, camera);
      const StageSeconds& seconds = scene.renderer.seconds();
      (*view)["primary"] += seconds.primary;
      (*view)["decode"] += seconds.decode;
      (*view)[kDirect] += seconds.direct;
      (*view)["paths"] += seconds.reference;  // of metal and of corrections
      (*view)["denoise"] += seconds.denoise;
      return picture;
    };
  };
  return method;
}

}  // namespace

Method network_everywhere(int direct_samples) {
  const std::string count = std::to_string(direct_samples);
  RenderSettings settings;
  settings.direct_samples = direct_samples;
  return network_method("network-" + count, "network",
                        "every pixel decoded, " + count + " shadow rays a pixel", settings);
}

Method network_corrected(int paths) {
  const std::string count = std::to_string(paths);
  RenderSettings settings;
  settings.denoise = Denoise::Auto;
  settings.correction_paths = paths;
  return network_method(
      "network-final-" + count, "network-final",
      "every pixel decoded, 64 shadow rays and " + count + " correcting paths a pixel", settings);
}

Method network_sparsely(int direct_samples) {
  const std::string count = std::to_string(direct_samples);
  RenderSettings settings;
  settings.direct_samples = direct_samples;
  settings.sparse.emplace();
  return network_method("sparse-" + count, "sparse",
                        "few pixels decoded, " + count + " shadow rays a pixel", settings);
}

Method network_draft() {
  RenderSettings settings;
  settings.direct_samples = 4;
  settings.antialias = 0;
  settings.sparse.emplace();
  settings.sparse->step = 8;
  settings.sparse->edge_step = 4;
  settings.sparse->tolerance = 0.2F;
  settings.sparse->contact_radius = -1;
  return network_method("sparse-draft", "sparse",
                        "as --quality draft: fewest pixels decoded, 4 shadow rays a pixel, edges "
                        "not anti-aliased",
                        settings);
}

Method light_estimates(int64_t scene_points, int neighbours) {
  const std::string points = std::to_string(scene_points), near = std::to_string(neighbours);
  Method method{"estimates-" + points + "-k" + near,
                "estimates",
                points + " points, " + near + " nearest, " + std::to_string(kEstimateShadowRays) +
                    " shadow rays a pixel",
                {}};
  method.prepare = [scene_points, neighbours](const MethodScene& scene,
                                              StageTimes* stages) -> RenderView {
    const pathtrace::Bvh& bvh = scene.renderer.bvh();
    Timer timer;
    scene::SurfaceSamples samples =
        sample_scene_points(bvh, scene_points, /*prune=*/true, scene.seed, nullptr);
    (*stages)["sample"] += timer.seconds();
    timer.restart();
    const runtime::LightRequest paths{scene.max_depth, scene.network.metadata().light_paths};
    const auto cache = std::make_shared<EstimateCache>(
        add_light_estimates(bvh, scene.renderer.lights(), std::move(samples), paths, scene.seed),
        std::max(max_component(bvh.bounds().extent()), 1e-6F));
    (*stages)["light"] += timer.seconds();
    return [scene, cache, neighbours](const scene::Camera& camera, StageTimes* view) {
      const IndirectLight read = [&](const QueryPoints& queries) {
        return cache->read(queries, neighbours);
      };
      return compose_picture(scene, camera, kEstimateShadowRays, read, view);
    };
  };
  return method;
}

}  // namespace lte::infer
