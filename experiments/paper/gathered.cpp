// experiment_paper gathered: the views of a data set that was generated with --glb, by rays that
// read an irradiance cache, as lte_render's gather does.
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "experiments/paper/commands.h"
#include "experiments/paper/trial.h"
#include "experiments/paper/view_scores.h"
#include "infer/eval/baselines/denoised_paths.h"
#include "lte/gi/gather.h"
#include "lte/image/denoise.h"
#include "lte/render/integrator.h"
#include "lte/scene/load.h"

namespace lte::experiments {
namespace {

struct GatheredTrial : Trial {
  int64_t rays = 16;
};

void run(const GatheredTrial& request) {
  begin_trial(request);
  const std::vector<EvalScene> scenes = read_eval_scenes(request.data, data::Split::Test);
  double seconds = 0;  // without loading and denoising
  const auto gather = [&](const EvalScene& eval, const data::View&,
                          const infer::ViewPixels& pixels) {
    const scene::Scene scene =
        scene::load_scene(std::filesystem::path(eval.path).replace_extension(".glb"));
    const pathtrace::Bvh bvh(scene);
    const pathtrace::Lights lights(scene);
    const std::clock_t begin = std::clock();
    const gi::IrradianceCache cache = render::make_cache({bvh, lights}, {.seed = request.seed}, {});
    gi::GatherOptions options;
    options.rays = static_cast<int>(request.rays);
    options.seed = request.seed;
    std::vector<Rgb> light =
        gi::gather_irradiance(bvh, lights, cache, pixels.position, pixels.normal, options).indirect;
    seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    for (Rgb& value : light) value = value * static_cast<float>(1 / eval.radiance);
    return light;
  };
  nlohmann::json json = score_views(scenes, gather);
  json.update({{"rays", request.rays}, {"cpu_seconds", seconds}});
  const image::Denoiser denoiser;
  json["denoised"] = score_views(
      scenes, [&](const EvalScene& eval, const data::View& view, const infer::ViewPixels& pixels) {
        return infer::denoised_paths(denoiser, view, gather(eval, view, pixels));
      });
  json["denoiser"] = denoiser.description();
  std::printf("gathered: MSE %.4g, SSIM %.3f\n", json["mse"].get<double>(),
              json["ssim"].get<double>());
  write_report(request, std::move(json));
}

void add_flags(CLI::App& command, GatheredTrial* request) {
  add_data_option(command, request, "Data set generated with --glb");
  command.add_option("--rays", request->rays, "Of a pixel")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
}

}  // namespace

std::function<void()> add_gathered(CLI::App* app) {
  return add_trial<GatheredTrial>(
      app, "gathered", "Score gathered light on the views of a test split", add_flags, run);
}

}  // namespace lte::experiments
