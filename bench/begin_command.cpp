#include "bench/begin_command.h"

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

}  // namespace lte::bench
