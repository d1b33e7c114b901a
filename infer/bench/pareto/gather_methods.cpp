// Light gathered from a table of raw estimates or of the network's answers, without its noise: what
// lte_render --indirect gather makes.
#include <utility>

#include "infer/bench/pareto/lit_picture.h"
#include "infer/bench/pareto/method.h"
#include "infer/bench/pareto/renderer_steps.h"
#include "infer/render/time_budget.h"
#include "lte/base/check.h"

namespace lte::infer {
namespace {

/// lte_render with these settings, but for size, depth and seed.
Method gather_method(const std::string& name, const std::string& family, const std::string& words,
                     const RenderSettings& settings, const TableSettings& table) {
  Method method{name, family, words, {}};
  method.prepare = [settings, table](const MethodScene& scene, StageTimes* stages) -> RenderView {
    if (table.light == TableLight::Network) embed_scene(scene, stages);
    make_table(scene, table, stages);
    return [scene, settings](const scene::Camera& camera, StageTimes* view) {
      MethodPicture picture = render_view(scene, settings, camera);
      add_picture_stages(scene, view);
      return picture;
    };
  };
  return method;
}

/// Pictures of so many gather and shadow rays a pixel.
/// More rays leave less to the denoiser, which then is the better and slower one.
RenderSettings gathered(int rays, int step) {
  using image::OidnQuality;
  RenderSettings settings;
  settings.indirect = Indirect::Gather;
  settings.gather.rays = rays;
  settings.gather.step = step;
  settings.direct_samples = rays;
  settings.gather.quality = rays <= 4    ? OidnQuality::Fast
                            : rays <= 16 ? OidnQuality::Balanced
                                         : OidnQuality::High;
  settings.denoise = Denoise::Auto;
  return settings;
}

std::string words_of(int rays) {
  return std::to_string(rays) + " gather and shadow rays a pixel, ";
}

}  // namespace

Method gathered_light(int rays) {
  return gather_method("gather-" + std::to_string(rays), "gather",
                       words_of(rays) + "a table of raw estimates, denoised", gathered(rays, 1),
                       {});
}

Method gathered_sparsely(int rays) {
  return gather_method("gather-sparse-" + std::to_string(rays), "gather",
                       words_of(rays) +
                           "gathered at a quarter of the pixels, a table of raw "
                           "estimates, denoised",
                       gathered(rays, 2), {});
}

Method gathered_draft(DraftKind kind) {
  const bool large = kind == DraftKind::Large, keep_light = kind == DraftKind::Kept;
  RenderSettings settings;
  settings.indirect = Indirect::Gather;
  settings.denoise = Denoise::Auto;
  if (large) settings.width = settings.height = 2048;
  settings = with_quality(Quality::Draft, Sparse::Auto, {}, settings);
  settings.keep_light = keep_light;
  if (keep_light) {
    return gather_method("gather-kept", "gather",
                         "as --quality draft for several views, which share their light", settings,
                         {});
  }
  return gather_method(large ? "gather-draft-large" : "gather-draft", "gather",
                       concat("as --quality draft", large ? " of large pictures" : "", ": ",
                              large ? "6 gather and shadow rays at a sixteenth"
                                    : "8 gather and shadow rays at a quarter",
                              " of the pixels"),
                       settings, {});
}

Method gathered_final(int paths) {
  RenderSettings settings;
  settings.indirect = Indirect::Gather;
  settings.denoise = Denoise::Auto;
  settings = with_quality(Quality::Final, Sparse::Auto, {}, settings);
  if (paths >= 0) settings.correction_paths = paths;
  return gather_method(
      paths < 0 ? "gather-final" : concat("gather-final-", paths), "gather-final",
      concat("as --quality final", paths < 0 ? "" : concat(" --correction-paths ", paths)),
      settings, {});
}

Method gathered_from_network(int rays) {
  TableSettings table;
  table.light = TableLight::Network;
  return gather_method("gather-network-" + std::to_string(rays), "gather-network",
                       words_of(rays) + "a table of the network's answers, denoised",
                       gathered(rays, 1), table);
}

}  // namespace lte::infer
