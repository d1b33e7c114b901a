// What lte_render --time-budget makes of a time, and --quality final.
#include <utility>

#include "infer/bench/pareto/lit_picture.h"
#include "infer/bench/pareto/method.h"
#include "infer/bench/pareto/renderer_steps.h"
#include "infer/render/gather_plan.h"
#include "lte/base/check.h"
#include "lte/base/text.h"
#include "lte/base/timer.h"

namespace lte::infer {
namespace {

/// Makes the table that pictures read, and adds its stage.
void make_table(const MethodScene& scene, StageTimes* stages) {
  TableSettings table;
  table.max_depth = scene.max_depth;
  table.seed = scene.seed;
  scene.renderer.make_table(table);
  (*stages)["table"] += scene.renderer.seconds().table;
}

void add_stages(const StageSeconds& seconds, StageTimes* stages) {
  (*stages)["primary"] += seconds.primary;
  (*stages)["gather"] += seconds.gather;
  (*stages)[kDirect] += seconds.direct;
  (*stages)["denoise"] += seconds.denoise;
  (*stages)["paths"] += seconds.reference;
}

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
    make_table(scene, stages);
    const double spent = timer.seconds();
    return [scene, seconds, spent](const scene::Camera& camera, StageTimes* view) {
      const Timer clock;
      const PicturePlan plan = plan_gathered(seconds - spent, clock, Sparse::Auto, {},
                                             gathered(scene), camera, &scene.renderer);
      (*view)["plan"] += clock.seconds();
      MethodPicture picture = picture_of(scene.renderer.render(camera, plan.settings));
      add_stages(scene.renderer.seconds(), view);
      return picture;
    };
  };
  return method;
}

Method gathered_final(int paths) {
  Method method{
      paths < 0 ? "gather-final" : concat("gather-final-", paths),
      "gather-final",
      concat("as --quality final", paths < 0 ? "" : concat(" --correction-paths ", paths)),
      {}};
  method.prepare = [paths](const MethodScene& scene, StageTimes* stages) -> RenderView {
    make_table(scene, stages);
    return [scene, paths](const scene::Camera& camera, StageTimes* view) {
      RenderSettings settings = with_quality(Quality::Final, Sparse::Auto, {}, gathered(scene));
      if (paths >= 0) settings.gather.paths = paths;
      MethodPicture picture = picture_of(scene.renderer.render(camera, settings));
      add_stages(scene.renderer.seconds(), view);
      return picture;
    };
  };
  return method;
}

}  // namespace lte::infer
