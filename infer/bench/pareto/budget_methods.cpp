// What lte_render --time-budget makes of a time.
#include <utility>

#include "infer/bench/pareto/lit_picture.h"
#include "infer/bench/pareto/method.h"
#include "infer/bench/pareto/renderer_steps.h"
#include "infer/render/gather_plan.h"
#include "lte/base/text.h"
#include "lte/base/timer.h"

namespace lte::infer {
namespace {

RenderSettings gathered(const MethodScene& scene) {
  RenderSettings settings;
  settings.indirect = Indirect::Gather;
  settings.denoise = Denoise::Auto;
  settings.width = scene.width;
  settings.height = scene.height;
  settings.max_depth = scene.max_depth;
  settings.seed = scene.seed;
  return settings;
}

}  // namespace

Method time_budget(double seconds) {
  const std::string words = formatted("%gs", seconds);
  Method method{"budget-" + words,
                "budget",
                "as --time-budget " + words + ": table, rays and paths in that time",
                {}};
  method.prepare = [seconds](const MethodScene& scene, StageTimes* stages) -> RenderView {
    const Timer timer;
    make_table(scene, {}, stages);
    const double spent = timer.seconds();
    return [scene, seconds, spent](const scene::Camera& camera, StageTimes* view) {
      const Timer clock;
      const PicturePlan plan = plan_gathered(seconds - spent, clock, Sparse::Auto, {},
                                             gathered(scene), camera, &scene.renderer);
      (*view)["plan"] += clock.seconds();
      MethodPicture picture = picture_of(scene.renderer.render(camera, plan.settings));
      add_picture_stages(scene, view);
      return picture;
    };
  };
  return method;
}

}  // namespace lte::infer
