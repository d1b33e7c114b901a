#include "bench/pareto/pareto_command.h"

#include <cstdio>

#include "bench/begin_command.h"
#include "bench/pareto/pareto_report.h"
#include "infer/tool/picture_size.h"
#include "infer/tool/tool_options.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/scene/load_camera.h"

namespace lte::bench {

using namespace infer;

void add_pareto_options(CLI::App& command, ParetoRequest* request) {
  ParetoOptions& options = request->options;
  command.add_option("SCENE", options.scenes, "Scene files (default: the shipped Cornell box)");
  command.add_option("--checkpoint", options.checkpoint, "Model; by default the shipped one");
  command.add_option("--camera", options.camera,
                     concat(scene::kCameraHelp, "; by default the scene's first, else auto"));
  command
      .add_option("--size", request->sizes,
                  "Picture size; several make a chart each: 160x120,320x240")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Validator(check_picture_size, "WxH"))
      ->capture_default_str();
  command
      .add_option("--methods", options.methods,
                  "Families or rows of the chart, such as paths,network-final; by default all")
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      .add_option("--views", options.views,
                  "Views that are measured: the cameras given, or the first one turned")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--reference-spp", options.reference_spp, "Paths a pixel of the reference")
      ->check(CLI::Range(2, 1 << 24))
      ->capture_default_str();
  command.add_option("--references", options.references,
                     "Folder in which references are kept from run to run");
  add_scene_flags(command, &options.loading);
}

void run_pareto(const ParetoRequest& request, int repeats, const CommonOptions& common) {
  ParetoOptions options = request.options;
  options.sizes.clear();
  for (const std::string& size : request.sizes) options.sizes.push_back(parse_picture_size(size));
  options.repeats = repeats;
  CommandFiles files;
  for (const std::string& scene : options.scenes) files.reads("SCENE", scene);
  files.reads("--checkpoint", options.checkpoint);
  files.writes("--references", options.references);
  begin_command(common, &files);
  const std::vector<ParetoChart> charts = measure_pareto(options);
  std::fputs(pareto_table(charts).c_str(), stdout);
  files.check_what_was_read();
  if (!common.json.empty()) write_file(common.json, pareto_json(options, charts));
}

}  // namespace lte::bench
