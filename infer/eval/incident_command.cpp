#include "infer/eval/incident_command.h"

#include <iostream>

#include "infer/eval/incident/incident_eval.h"
#include "infer/eval/incident/incident_page.h"
#include "infer/tool/assets.h"
#include "lte/base/file.h"
#include "lte/cli/command_files.h"
#include "lte/cli/writable.h"

namespace lte::infer {
namespace {

constexpr const char* kPage = "incident.html";

}  // namespace

CLI::App* add_incident_command(CLI::App& app, IncidentRequest* request) {
  CLI::App* command = app.add_subcommand(
      "incident",
      "Error of a model's radiance by direction, beside spherical harmonics and Gaussians fitted "
      "to the traced maps; needs --checkpoint of a model with a radiance decoder, --data and "
      "--split");
  command->fallthrough();
  command->add_option(
      "--traced", request->traced,
      "Data-set folder of the same scenes with fewer paths a direction, as a rival");
  command->footer(
      "Example:\n"
      "  lte_datagen generate --config configs/data/glossy_test.yaml --out glossy_test\n"
      "  lte_eval incident --checkpoint lte_radiance/model.safetensors --data glossy_test --split "
      "test --json incident.json --report incident");
  return command;
}

void run_incident(const IncidentRequest& request, const EvalRequest& eval) {
  if (eval.data.empty())
    throw CLI::ValidationError("--data", "name a data set with incident radiance");
  if (eval.checkpoint.empty())
    throw CLI::ValidationError("--checkpoint", "name a model with a radiance decoder");
  if (eval.split.empty()) throw CLI::ValidationError("--split", "expected train, val or test");
  CommandFiles files;
  files.reads("--checkpoint", eval.checkpoint);
  files.reads_parts("--data", eval.data, data::kDatasetParts);
  files.reads_parts("--traced", request.traced, data::kDatasetParts);
  files.writes_parts("--report", eval.report, {kPage});
  files.writes_common(eval.tool.common);
  files.check();
  apply_tool_options(eval.tool);
  check_writable(eval.tool.common.json);
  const std::filesystem::path folder = make_report_folder(eval.report, kPage);
  const runtime::Network network(eval.checkpoint, network_options(eval.tool));
  IncidentSettings settings;
  settings.data = eval.data;
  settings.split = data::parse_split(eval.split);
  settings.traced = request.traced;
  settings.scene_points = eval.scene_points;
  settings.memory = runtime::MemoryLimit(eval.tool.max_memory_mb);
  const IncidentResult result = evaluate_incident(settings, network);
  if (!eval.tool.common.json.empty())
    write_file(eval.tool.common.json, incident_json(result, eval.checkpoint, eval.data));
  if (!folder.empty())
    write_file(folder / kPage, incident_html(result, eval.checkpoint, eval.data));
  std::cout << incident_table(result);
}

}  // namespace lte::infer
