#include "infer/render/render_report.h"

#include <cstdio>

#include "lte/base/process_memory.h"

namespace lte::infer {
namespace {
constexpr double kMinSeconds = 0.005;  ///< less is printed as 0.00
}

nlohmann::json seconds_json(const StageSeconds& seconds, double total) {
  nlohmann::json out = {{"total", total}};
  for (const Stage& stage : kStages) out[stage.name] = seconds.*stage.seconds;
  return out;
}

void add_seconds(const StageSeconds& picture, StageSeconds* sum) {
  for (double StageSeconds::*stage : kPictureStages) sum->*stage += picture.*stage;
  sum->write += picture.write;
}

void print_times(const StageSeconds& seconds, double total) {
  std::printf(" | seconds: ");
  for (const Stage& stage : kStages) {
    const double spent = seconds.*stage.seconds;
    if (spent >= kMinSeconds) std::printf("%s %.2f, ", stage.name, spent);
  }
  std::printf("total %.2f | peak %.0f MiB\n", total, peak_rss_mb());
}

}  // namespace lte::infer
