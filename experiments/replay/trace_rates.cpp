#include "experiments/replay/trace_rates.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "experiments/replay/ray_replay.h"
#include "lte/base/parallel.h"
#include "lte/base/timer.h"
#include "lte/pathtrace/transport/irradiance_kernel.h"
#include "lte/pathtrace/transport/transport_impl.h"

namespace lte::experiments {
namespace {

/// One of the calls whose times are compared.
struct Timed {
  std::function<void()> run;
  double best_seconds = INFINITY, spent_seconds = 0;
};

/// Processor time of a thread, in the mean.
double thread_seconds() { return processor_seconds() / num_threads(); }

/// Runs them turn by turn, so that a busy moment of the machine does not fall on one of them alone.
void time_in_turns(double budget, std::vector<Timed>* calls) {
  for (bool all_done = false; !all_done;) {
    all_done = true;
    for (Timed& call : *calls) {
      if (call.spent_seconds >= budget) continue;
      const double start = thread_seconds();
      call.run();
      const double seconds = std::max(thread_seconds() - start, 1e-9);
      call.best_seconds = std::min(call.best_seconds, seconds);
      call.spent_seconds += seconds;
      all_done = false;
    }
  }
}

}  // namespace

TraceRates measure_trace_rates(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                               std::span<const Vec3> positions, std::span<const Vec3> normals,
                               const pathtrace::IrradianceOptions& options, double seconds) {
  TraceRates rates;
  std::vector<RayLog> logs(positions.size());
  const auto recorder_of = [&logs](int64_t i) {
    return RayRecorder{&logs[static_cast<size_t>(i)]};
  };
  rates.rays = pathtrace::run_irradiance<RayRecorder>(bvh, lights, positions, normals, options, 0,
                                                      recorder_of)
                   .rays_traced;
  std::vector<RayLog> sorted = logs;
  sort_rays(bvh.bounds(), &sorted);
  std::vector<Timed> calls;
  calls.push_back(
      {[&] { pathtrace::estimate_irradiance(bvh, lights, positions, normals, options); }});
  rates.bare.reserve(2 * std::size(kRecordPoints));  // calls keep their addresses
  for (const auto* order : {&logs, &sorted}) {
    for (const EntryPoint entry : kRecordPoints) {
      rates.bare.push_back({name_of(entry), order == &sorted});
      BareRate* rate = &rates.bare.back();
      calls.push_back({[rate, &bvh, order, entry] { rate->stopped = replay(bvh, *order, entry); }});
    }
  }
  time_in_turns(seconds, &calls);
  const auto rate_of = [&rates](const Timed& c) {
    return static_cast<double>(rates.rays) / c.best_seconds;
  };
  rates.path_rays_per_s = rate_of(calls[0]);
  for (size_t i = 0; i < rates.bare.size(); ++i) rates.bare[i].rays_per_s = rate_of(calls[i + 1]);
  return rates;
}

}  // namespace lte::experiments
