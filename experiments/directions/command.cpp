// Error of a model's radiance by direction on a baked data set, beside spherical harmonics and
// Gaussians fitted to the traced maps (the paper's section 5.3 and supplement, section 4).
#include "experiments/command.h"

#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <string>

#include "experiments/directions/incident_eval.h"
#include "experiments/directions/incident_page.h"
#include "infer/tool/tool_options.h"
#include "lte/base/file.h"
#include "lte/cli/command_files.h"
#include "lte/cli/writable.h"

namespace lte::experiments {
namespace {

struct Request {
  std::string checkpoint, data, split = "test", traced, out;
  int64_t scene_points = 0;
  infer::ToolOptions tool;
};

void add_options(CLI::App& app, Request* request) {
  app.add_option("--checkpoint", request->checkpoint, "Model with a radiance decoder")->required();
  app.add_option("--data", request->data, "Data-set folder with incident radiance")->required();
  app.add_option("--split", request->split, "train, val or test")
      ->check(CLI::IsMember({"train", "val", "test"}))
      ->capture_default_str();
  app.add_option("--traced", request->traced,
                 "Data-set folder of the same scenes with fewer paths a direction, a baseline");
  app.add_option("--scene-points", request->scene_points,
                 "Scene points of the network; 0 for as many as in training");
  app.add_option("--out", request->out, "Page to write (.html)");
  infer::add_tool_options(app, &request->tool);
}

void run(const Request& request) {
  const CommonOptions& common = request.tool.common;
  CommandFiles files;
  files.reads("--checkpoint", request.checkpoint);
  files.reads_parts("--data", request.data, data::kDatasetParts);
  files.reads_parts("--traced", request.traced, data::kDatasetParts);
  files.writes("--out", request.out);
  files.writes_common(common);
  files.check();
  infer::apply_tool_options(request.tool);
  check_writable(common.json);
  check_writable(request.out);
  const runtime::Network network(request.checkpoint, infer::network_options(request.tool));
  IncidentSettings settings;
  settings.data = request.data;
  settings.split = data::parse_split(request.split);
  settings.traced = request.traced;
  settings.scene_points = request.scene_points;
  settings.memory = runtime::MemoryLimit(request.tool.max_memory_mb);
  const IncidentResult result = evaluate_incident(settings, network);
  if (!common.json.empty())
    write_file(common.json, incident_json(result, request.checkpoint, request.data));
  if (!request.out.empty())
    write_file(request.out, incident_html(result, request.checkpoint, request.data));
  std::cout << incident_table(result);
}

}  // namespace

std::function<void()> add_command(CLI::App* app) {
  const auto request = std::make_shared<Request>();
  app->name("experiment_directions");
  app->description(
      "Error of a model's radiance by direction, beside spherical harmonics and Gaussians fitted "
      "to the traced maps.");
  app->footer(
      "Example:\n"
      "  lte_datagen generate --config configs/data/glossy_test.yaml --out glossy_test\n"
      "  experiment_directions --checkpoint assets/models/lte-radiance.safetensors \\\n"
      "    --data glossy_test --out directions.html");
  add_options(*app, request.get());
  return [request] { run(*request); };
}

}  // namespace lte::experiments
