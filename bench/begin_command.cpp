#include "bench/begin_command.h"

#include <cstdio>

#include "lte/base/file.h"
#include "lte/cli/writable.h"
#include "lte/runtime/device.h"

namespace lte::bench {

void begin_command(const CommonOptions& common, CommandFiles* files, const std::string& out) {
  files->writes("--out", out);
  files->writes_common(common);
  files->check();
  apply_common_options(common);
  runtime::set_torch_threads(common.threads);
  check_writable(out);
  check_writable(common.json);
}

void run_measured(const CommonOptions& common, CommandFiles* files,
                  const std::function<std::vector<BenchResult>()>& measure) {
  begin_command(common, files);
  const std::vector<BenchResult> results = measure();
  std::fputs(bench_table(results).c_str(), stdout);
  files->check_what_was_read();
  if (!common.json.empty()) write_file(common.json, bench_json(results));
}

}  // namespace lte::bench
