#include "infer/render/notes.h"

#include <algorithm>

#include "infer/check/check_report.h"
#include "lte/base/log.h"
#include "lte/base/text.h"
#include "lte/scene/metal.h"

namespace lte::infer {
namespace {

constexpr int64_t kSteps = 1000;  // of a progress bar

bool shows_light_of_surfaces(Output output) {
  return output == Output::Full || output == Output::Gi || output == Output::Direct;
}

}  // namespace

PictureProgress::PictureProgress(RenderSettings* settings)
    : settings_(settings), progress_("rendering", kSteps, "parts") {
  settings->progress = [this](double share) {
    const auto now = static_cast<int64_t>(share * kSteps);
    if (now > shown_) progress_.advance(now - shown_);
    shown_ = std::max(shown_, now);
  };
}

PictureProgress::~PictureProgress() { settings_->progress = {}; }

void say_method(const std::filesystem::path& model, const Renderer& renderer,
                const RenderSettings& settings, Method records, int64_t count) {
  if (!renderer.needs_cache(settings)) return;
  if (records == Method::Network) {
    log_info("indirect light: ", model.stem().string(), " at ", count, " places, gathered by rays");
  } else {
    log_info("indirect light: path-traced at ", count,
             " places, gathered by rays; no model is needed");
  }
}

void report_metal(const std::string& scene, const RenderSettings& settings, const Frame& frame) {
  const double seen =
      static_cast<double>(int64_t{settings.width} * settings.height - frame.background);
  if (!(frame.metal > 0) || !(seen > 0) || !shows_light_of_surfaces(settings.output)) return;
  log_info(
      scene, ": ",
      scene::metal_text({frame.metal / seen, frame.metal_by_default / seen}, "visible surface"),
      "; path-traced there");
}

void report_darkness(const std::string& scene, const std::string& camera, Output output,
                     const Frame& frame) {
  if (output != Output::Full && output != Output::Direct) return;
  const auto& values = frame.color.pixels;
  const bool black = std::all_of(values.begin(), values.end(), [](float v) { return !(v > 0); });
  if (black)
    log_warning(scene, ": no light reaches what camera ", camera, " sees; the picture is black");
}

void report_check(const std::string& picture, Method records, const LightCheck& check) {
  const std::string note = check_note(
      check, records == Method::Network ? "the network's" : "the gathered", "the picture");
  if (!note.empty()) log_warning(picture, ": ", note);
}

}  // namespace lte::infer
