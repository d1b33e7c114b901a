// Whether answers stay finite, and how much they change, in scenes that strain numbers.
#include "experiments/command.h"

#include <cstdio>
#include <functional>
#include <memory>
#include <string>

#include "bench/begin_command.h"
#include "experiments/stability/stability.h"
#include "experiments/stability/stability_report.h"
#include "infer/tool/tool_options.h"
#include "lte/base/check.h"
#include "lte/base/file.h"

namespace lte::experiments {
namespace {

struct Request {
  StabilityOptions options;
  std::string device;  ///< cpu or cuda
  std::string out;     ///< the page; empty: none
  CommonOptions common;
};

void add_options(CLI::App& app, Request* request) {
  app.add_flag("--quick", request->options.quick, "Small sizes, for a few seconds");
  app.add_option("--triangles", request->options.triangles,
                 "Without --quick: triangles of the largest scene; two others have 3/10 and 1/10")
      ->check(CLI::Range(int64_t{1000}, int64_t{200'000'000}))
      ->capture_default_str();
  app.add_option("--checkpoint", request->options.checkpoint, "Model; by default the shipped one");
  app.add_option("--device", request->device, "Processor of the network: cpu or cuda")
      ->check(CLI::IsMember({"cpu", "cuda"}))
      ->default_str("cpu");
  app.add_option("--out", request->out, "Page to write (.html)");
  add_common_options(app, &request->common);
}

void run(const Request& request) {
  CommandFiles files;
  files.reads("--checkpoint", request.options.checkpoint);
  bench::begin_command(request.common, &files, request.out);
  StabilityOptions options = request.options;
  if (request.device == "cuda") options.device = runtime::choose_device("cuda", "--device");
  const std::vector<StabilityRow> rows = measure_stability(options);
  std::fputs(stability_table(rows).c_str(), stdout);
  files.check_what_was_read();
  if (!request.common.json.empty())
    write_file(request.common.json, stability_json(request.options, rows));
  if (!request.out.empty()) write_file(request.out, stability_html(request.options, rows));
  if (!all_hold(rows)) throw Error(stability_verdict(rows));
}

}  // namespace

std::function<void()> add_command(CLI::App* app) {
  const auto request = std::make_shared<Request>();
  app->name("experiment_stability");
  app->description("Finite answers, and how little they change, in scenes that strain numbers.");
  add_options(*app, request.get());
  return [request] { run(*request); };
}

}  // namespace lte::experiments
