#include "infer/render/edit_frames.h"

#include <utility>

#include "infer/session/state.h"
#include "lte/base/check.h"
#include "lte/base/log.h"
#include "lte/embed/culled_lights.h"

namespace lte::infer {
namespace {

nlohmann::json edit_json(const EditReport& report) {
  return {{"scene_ms", report.scene_ms},        {"bvh_ms", report.bvh_ms},
          {"points_ms", report.points_ms},      {"light_ms", report.light_ms},
          {"encode_ms", report.encode_ms},      {"total_ms", report.total_ms},
          {"encodings", report.encodings},      {"layers", report.layers},
          {"points_drawn", report.points_drawn}};
}

SessionSettings seen_from(SessionSettings settings, const std::vector<View>& views) {
  settings.cameras = cameras_of(views);
  return settings;
}

}  // namespace

std::vector<View> edit_views(const EditScript& script, const scene::Scene& scene,
                             std::vector<View> views, const std::string& pattern) {
  rehearse(script, scene);
  const auto count = static_cast<size_t>(script.frames);
  LTE_CHECK(views.size() == 1 || views.size() == count, "--edit: its script has ", count,
            " frames, but there are ", views.size(), " cameras: expected one, or one a frame");
  if (views.size() == count && count > 1) return views;
  LTE_CHECK(count == 1 || picture_name(pattern, 0, "") != picture_name(pattern, 1, ""), pattern,
            ": the frames of --edit need a pattern: %d or %04d for their number, as in "
            "frame_%04d.png; or a video's name");
  std::vector<View> out;
  for (size_t i = 0; i < count; ++i) {
    const scene::Camera& camera = views.front().camera;
    out.push_back({camera, pattern.empty() ? "" : picture_name(pattern, i, camera.name)});
  }
  return out;
}

EditedFrames::EditedFrames(EditScript script, const std::vector<View>& all,
                           const scene::Scene& scene, std::optional<runtime::Network> network,
                           SessionSettings settings)
    : script_(std::move(script)),
      session_(scene, std::move(network), seen_from(std::move(settings), all)),
      player_(script_, &session_) {
  for (size_t i = 0; i < all.size(); ++i) frame_of_[all[i].out] = static_cast<int>(i);
}

Frame EditedFrames::render(const View& view, const RenderSettings& settings, nlohmann::json* report,
                           StageSeconds* seconds) {
  *report = edit_json(player_.go_to(frame_of_.at(view.out)));
  report_culled_lights();
  (*report)["left_out_lights"] = culled_lights_;
  return session_.state()->render(view.camera, settings, seconds);
}

/// Where that has changed, a line names the light that the network does not read.
void EditedFrames::report_culled_lights() {
  const StatePtr state = session_.state();
  const std::vector<int> groups = state->culled_lights();
  std::vector<std::string> names = embed::names_of(state->scene(), groups);
  if (names == culled_lights_) return;
  culled_lights_ = std::move(names);
  if (!groups.empty())
    log_info(embed::culled_lights_note(state->scene(), groups, state->parts().cameras));
}

}  // namespace lte::infer
