#include "infer/eval/eval_command.h"

#include <filesystem>
#include <iostream>
#include <system_error>

#include "infer/eval/evaluate.h"
#include "infer/eval/report/eval_report.h"
#include "lte/base/config.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/cli/assets.h"
#include "lte/cli/command_files.h"
#include "lte/cli/numbers.h"
#include "lte/cli/writable.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRunModel = "model.safetensors";
constexpr const char* kShippedData = "data/homes-test";

void check_usage(const EvalRequest& request) {
  const bool fitting = !request.fit_baselines.empty();
  if (fitting && request.out.empty())
    throw CLI::ValidationError("--out", "name the file for --fit-baselines");
  if (!fitting && !request.out.empty())
    throw CLI::ValidationError("--out", "goes with --fit-baselines only");
  if (!fitting && request.split.empty())
    throw CLI::ValidationError("--split", "expected train, val or test");
}

/// From --baselines, from beside the checkpoint, or from the training split, in this order.
Baselines find_baselines(const EvalRequest& request, const fs::path& checkpoint,
                         const fs::path& data) {
  if (!request.baselines.empty()) return read_baselines(request.baselines);
  const fs::path beside = baselines_path(checkpoint);
  if (fs::exists(beside)) return read_baselines(beside);
  const data::DatasetInfo info = data::read_dataset_info(data);
  LTE_CHECK(!data::entries_of(info, data::Split::Train).empty(), beside.string(), ": missing, and ",
            data.string(),
            " has no training scenes to fit the baselines on: run lte_eval --fit-baselines "
            "TRAINING_DATA --out ",
            beside.string());
  log_info(beside.string(), " is missing: fitting baselines on the training split of ",
           data.string());
  return fit_baselines(data);
}

/// @throws lte::Error if an output would replace an input or another output
void claim_files(const EvalRequest& request, CommandFiles* files) {
  files->reads("--config", request.config);
  files->reads("--checkpoint", request.checkpoint);
  files->reads("--baselines", request.baselines);
  files->reads_parts("--data", request.data, data::kDatasetParts);
  files->reads_parts("--fit-baselines", request.fit_baselines, data::kDatasetParts);
  files->writes_parts("--report", request.report, {"report.html"});
  files->writes("--out", request.out);
  files->writes_common(request.tool.common);
  files->check();
}

void fit_to_file(const EvalRequest& request) {
  check_writable(request.out);
  const Baselines fitted = fit_baselines(request.fit_baselines);
  write_baselines(request.out, fitted);
  log_info("wrote ", request.out, " from ", fitted.scenes, " training scenes");
}

}  // namespace

fs::path make_report_folder(const std::string& report, const char* file) {
  if (report.empty()) return {};
  std::error_code error;
  fs::create_directories(report, error);
  LTE_CHECK(!error, report, ": cannot be created: ", error.message());
  check_writable((fs::path(report) / file).string());
  return report;
}

void add_eval_options(CLI::App& app, EvalRequest* r) {
  const auto option = [&app](const char* group, const char* flag, auto* value, const char* help) {
    return app.add_option(flag, *value, help)->group(group);
  };
  const char* const model = "Model and data";
  option(model, "--config", &r->config, "Training configuration: its data set and its run's model");
  option(model, "--checkpoint", &r->checkpoint, "Model; by default the shipped one");
  option(model, "--data", &r->data, "Data-set folder; by default the shipped homes");
  option(model, "--split", &r->split, "train, val or test")
      ->check(CLI::IsMember({"train", "val", "test"}));
  option(model, "--scene-points", &r->scene_points,
         "Scene points of the network, drawn from those of the data; 0 for as many as in training")
      ->check(non_negative_number());
  const char* const baselines = "Baselines";
  option(baselines, "--baselines", &r->baselines,
         "Fitted baselines; by default CHECKPOINT's stem + .baselines.json");
  option(baselines, "--fit-baselines", &r->fit_baselines,
         "Fit the baselines on this data set's training split and stop")
      ->excludes("--split");
  option(baselines, "--out", &r->out, "Baselines file to write with --fit-baselines");
  const char* const results = "Results";
  option(results, "--report", &r->report,
         "Folder for report.html and a contact sheet of each scene");
  app.add_flag("--denoise-references", r->denoise_references,
               "SSIM and FLIP of references without noise, by Open Image Denoise")
      ->group(results);
  option(results, "--resamples", &r->bootstrap.resamples,
         "Bootstrap resamples of the scenes behind the 95 % confidence intervals")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  add_tool_options(app, &r->tool);
}

void read_run_config(EvalRequest* request) {
  if (request->config.empty()) return;
  // Keys are checked by the trainer, which owns them.
  const Config config = Config::load(request->config);
  if (request->data.empty()) config.at("data").read("root", &request->data);
  std::string run;
  config.read("output", &run);
  if (request->checkpoint.empty() && !run.empty()) {
    request->checkpoint = (fs::path(run) / kRunModel).string();
  }
}

void run_eval(const EvalRequest& request) {
  check_usage(request);
  CommandFiles files;
  claim_files(request, &files);
  apply_tool_options(request.tool);
  if (!request.fit_baselines.empty()) return fit_to_file(request);
  check_writable(request.tool.common.json);

  const fs::path checkpoint = checkpoint_or_shipped(request.checkpoint);
  const fs::path data =
      request.data.empty() ? asset_path(kShippedData, "--data") : fs::path(request.data);
  files.reads("--checkpoint", checkpoint);
  files.reads_parts("--data", data, data::kDatasetParts);
  files.check();
  const runtime::Network network(checkpoint, network_options(request.tool));
  const runtime::MemoryLimit memory(request.tool.max_memory_mb);
  const Baselines baselines = find_baselines(request, checkpoint, data);
  files.check_what_was_read();
  const fs::path folder = make_report_folder(request.report, "report.html");

  EvalSettings settings;
  settings.data = data;
  settings.split = data::parse_split(request.split);
  settings.scene_points = request.scene_points;
  settings.denoise_references = request.denoise_references;
  settings.bootstrap = request.bootstrap;
  settings.memory = memory;
  settings.on_scene = [&] { memory.check("a scene"); };
  ContactSheets sheets(folder);
  if (!folder.empty()) settings.on_view = [&](const ViewPicture& picture) { sheets.add(picture); };
  const EvalResult result = evaluate(settings, network, baselines);

  if (!folder.empty())
    write_file(folder / "report.html",
               eval_html(result, checkpoint.string(), data.string(), sheets));
  if (!request.tool.common.json.empty()) {
    write_file(request.tool.common.json, eval_json(result, checkpoint.string(), data.string()));
  }
  std::cout << eval_table(result);
}

}  // namespace lte::infer
