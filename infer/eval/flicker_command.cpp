#include "infer/eval/flicker_command.h"

#include <algorithm>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "infer/picture/flicker.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/cli/command_files.h"
#include "lte/image/exr.h"
#include "lte/scene/load_camera.h"

namespace lte::infer {
namespace {

FlickerFrame read_frame(const std::string& path, const std::string& layer) {
  FlickerFrame frame{scene::load_camera(path), image::read_exr(path, layer),
                     image::read_exr(path, "depth")};
  LTE_CHECK(frame.light.channels == 3, path, ": layer \"", layer, "\" has no color");
  return frame;
}

std::vector<FlickerFrame> read_frames(const std::vector<std::string>& paths,
                                      const std::string& layer) {
  std::vector<FlickerFrame> frames;
  for (const std::string& path : paths) frames.push_back(read_frame(path, layer));
  return frames;
}

void print_flicker(const Flicker& all, size_t pairs, bool has_reference) {
  const double share =
      static_cast<double>(all.compared) / static_cast<double>(std::max<int64_t>(1, all.pixels));
  std::printf("%zu pairs of frames, %.1f %% of their pixels compared: change %.4f of the mean",
              pairs, 100 * share, all.change);
  if (has_reference)
    std::printf("; the reference's %.4f; beyond it %.4f", all.reference_change, all.excess);
  std::printf("\n");
}

nlohmann::json flicker_json(const Flicker& flicker, bool has_reference) {
  nlohmann::json json = {{"pixels", flicker.pixels},
                         {"compared", flicker.compared},
                         {"level", flicker.level},
                         {"change", flicker.change}};
  if (has_reference) {
    json["reference_change"] = flicker.reference_change;
    json["excess"] = flicker.excess;
  }
  return json;
}

}  // namespace

CLI::App* add_flicker_command(CLI::App& app, FlickerRequest* request) {
  CLI::App* command = app.add_subcommand(
      "flicker",
      "Change of what stays the same between frames that lte_render has written as .exr");
  command->fallthrough();
  command->add_option("frames", request->frames, "Frames in the order of time: .exr by lte_render")
      ->required();
  command->add_option(
      "--reference", request->reference,
      "As many frames by the same cameras without error, such as of --integrator path");
  command->add_option(
      "--layer", request->layer,
      "What to compare: a layer such as indirect or direct; by default the picture, "
      "which should be --output irradiance, as texture counts as change");
  command->footer(
      "Example:\n"
      "  lte_render room.glb --turntable 12 --output irradiance --out frames/%02d.exr\n"
      "  lte_eval flicker frames/*.exr --json flicker.json");
  return command;
}

void run_flicker(const FlickerRequest& request, const CommonOptions& common) {
  CommandFiles files;
  for (const std::string& path : request.frames) files.reads("FRAMES", path);
  for (const std::string& path : request.reference) files.reads("--reference", path);
  files.writes_common(common);
  files.check();
  apply_common_options(common);
  const std::vector<FlickerFrame> frames = read_frames(request.frames, request.layer);
  const std::vector<FlickerFrame> reference = read_frames(request.reference, request.layer);
  const Flicker all = measure_flicker(frames, reference);
  LTE_CHECK(all.compared > 0, request.frames[0], ": no point of a frame is seen in the next one");
  if (!common.json.empty()) {
    nlohmann::json json = flicker_json(all, !reference.empty());
    for (size_t i = 0; i + 1 < frames.size(); ++i) {
      const std::span two = std::span(frames).subspan(i, 2);
      const Flicker pair = reference.empty()
                               ? measure_flicker(two)
                               : measure_flicker(two, std::span(reference).subspan(i, 2));
      json["pairs"].push_back(flicker_json(pair, !reference.empty()));
    }
    write_file(common.json, json.dump(2) + "\n");
  }
  print_flicker(all, frames.size() - 1, !reference.empty());
}

}  // namespace lte::infer
