#include "infer/bench/stability/stability_command.h"

#include <cstdio>

#include "infer/bench/stability/stability_report.h"
#include "infer/tool/begin_command.h"
#include "infer/tool/tool_options.h"
#include "lte/base/check.h"
#include "lte/base/file.h"

namespace lte::infer {

void add_stability_options(CLI::App& command, StabilityRequest* request) {
  command.add_flag("--quick", request->options.quick, "Small sizes, for a few seconds");
  command
      .add_option("--triangles", request->options.triangles,
                  "Without --quick: of the largest scene; two others have 3/10 and 1/10 as many")
      ->check(CLI::Range(int64_t{1000}, int64_t{200'000'000}))
      ->capture_default_str();
  command.add_option("--checkpoint", request->options.checkpoint,
                     "Model; by default the shipped one");
  command.add_option("--out", request->out, "Page to write (.html)");
}

void run_stability(const StabilityRequest& request, const CommonOptions& common) {
  CommandFiles files;
  files.reads("--checkpoint", request.options.checkpoint);
  begin_command(common, &files, request.out);
  const std::vector<StabilityRow> rows = measure_stability(request.options);
  std::fputs(stability_table(rows).c_str(), stdout);
  files.check_what_was_read();
  if (!common.json.empty()) write_file(common.json, stability_json(request.options, rows));
  if (!request.out.empty()) write_file(request.out, stability_html(request.options, rows));
  if (!all_hold(rows)) throw Error(stability_verdict(rows));
}

}  // namespace lte::infer
