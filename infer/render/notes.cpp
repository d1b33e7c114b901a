#include "infer/render/notes.h"

#include <algorithm>

#include "infer/renderer/check_report.h"
#include "lte/base/log.h"
#include "lte/base/text.h"
#include "lte/scene/metal.h"

namespace lte::infer {
namespace {

bool shows_light_of_surfaces(Output output) {
  return output == Output::Full || output == Output::Gi || output == Output::Direct;
}

}  // namespace

PictureProgress::PictureProgress(RenderSettings* settings)
    : settings_(settings),
      progress_("rendering", int64_t{settings->width} * settings->height, "pixels") {
  settings->done = [this](int64_t pixels) { progress_.advance(pixels); };
}

PictureProgress::~PictureProgress() { settings_->done = {}; }

const char* method_word(const RenderSettings& settings, TableLight table) {
  if (settings.mode == Mode::Reference) return enum_name(Indirect::Paths);
  if (settings.indirect == Indirect::Gather && table == TableLight::Network) return "network";
  return enum_name(settings.indirect);
}

void say_method(const std::filesystem::path& model, const Renderer& renderer,
                const RenderSettings& settings, const TableSettings& table) {
  const PictureNeeds needs = renderer.needs(settings);
  if (!needs.indirect || settings.mode == Mode::Reference) return;
  const std::string name = model.stem().string();
  if (settings.indirect == Indirect::Paths) {
    log_info("indirect light: ", settings.spp, " paths a pixel");
  } else if (settings.indirect == Indirect::Decoded) {
    log_info("indirect light: ", name, ", decoded at each pixel");
  } else if (table.light == TableLight::Network) {
    log_info("indirect light: ", name, " at ", table.entries, " places, gathered by rays");
  } else {
    log_info("indirect light: path-traced at ", table.entries,
             " places, gathered by rays; no "
             "model is needed");
  }
}

void report_metal(const std::string& scene, const RenderSettings& settings, const Frame& frame) {
  const double seen =
      static_cast<double>(int64_t{settings.width} * settings.height - frame.background);
  if (!(frame.metal > 0) || !(seen > 0) || !shows_light_of_surfaces(settings.output)) return;
  const std::string share =
      scene::metal_text({frame.metal / seen, frame.metal_by_default / seen}, "visible surface");
  if (settings.mode == Mode::Reference || settings.metal == Metal::Trace) {
    log_info(scene, ": ", share, "; path-traced there, ", settings.spp, " paths a pixel");
  } else if (settings.metal == Metal::Network) {
    log_info(scene, ": ", share, "; direct light path-traced there, ", settings.spp,
             " paths a pixel; later bounces by the network, ", settings.reflections,
             " directions a pixel");
  } else if (settings.metal == Metal::Diffuse) {
    log_warning(scene, ": ", share, "; shown as a matt surface of its color (--metal trace)");
  } else {
    log_warning(scene, ": ", share, "; shown as black (--metal trace)");
  }
}

void report_darkness(const std::string& scene, const std::string& camera, Output output,
                     const Frame& frame) {
  if (output != Output::Full && output != Output::Direct) return;
  const auto& values = frame.color.pixels;
  const bool black = std::all_of(values.begin(), values.end(), [](float v) { return !(v > 0); });
  if (black)
    log_warning(scene, ": no light reaches what camera ", camera, " sees; the picture is black");
}

void report_check(const std::string& picture, bool by_network, const LightCheck& check) {
  const std::string note =
      check_note(check, by_network ? "the network's" : "the gathered", "the picture");
  if (!note.empty()) log_warning(picture, ": ", note);
}

}  // namespace lte::infer
