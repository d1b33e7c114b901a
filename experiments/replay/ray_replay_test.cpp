// Recorded rays mean the same to each of Embree's entry points.
#include "experiments/replay/ray_replay.h"

#include <gtest/gtest.h>

#include "experiments/replay/trace_rates.h"
#include "lte/pathtrace/transport/irradiance_kernel.h"
#include "lte/pathtrace/transport/transport_impl.h"
#include "tests/support/scenes.h"

namespace lte::experiments {
namespace {

using namespace pathtrace;

struct Recording {
  scene::Scene scene = test::furnished_room();
  Bvh bvh{scene};
  Lights lights{scene};
  std::vector<Vec3> positions{{2, 0, 1}, {0, 1.2f, 2}}, normals{{0, 1, 0}, {1, 0, 0}};
  IrradianceOptions options;
  std::vector<RayLog> logs{2};

  Recording() {
    options.rays = 72;  // no multiple of a packet at most depths
    run_irradiance<RayRecorder>(bvh, lights, positions, normals, options, 0, [this](int64_t i) {
      return RayRecorder{&logs[static_cast<size_t>(i)]};
    });
  }
};

TEST(RayReplay, EveryEntryPointFindsTheSame) {
  Recording r;
  int64_t expected = 0;  // through the public queries
  for (const RayLog& log : r.logs) {
    for (const RayArrays* rays : {&log.nearest_rays, &log.shadow_rays}) {
      for (size_t i = 0; i < rays->size(); ++i) {
        const Vec3 origin{rays->origin[0][i], rays->origin[1][i], rays->origin[2][i]};
        const Vec3 direction{rays->direction[0][i], rays->direction[1][i], rays->direction[2][i]};
        expected += r.bvh.occluded({origin, direction, 0, rays->t_max[i]}) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(expected, 300);
  for (const EntryPoint entry : kRecordPoints)
    EXPECT_EQ(replay(r.bvh, r.logs, entry), expected) << name_of(entry);
  sort_rays(r.bvh.bounds(), &r.logs);
  for (const EntryPoint entry : kRecordPoints)
    EXPECT_EQ(replay(r.bvh, r.logs, entry), expected) << name_of(entry) << ", sorted";
}

TEST(TraceRates, CountTheRaysOfTheEstimate) {
  const Recording r;
  const TraceRates rates =
      measure_trace_rates(r.bvh, r.lights, r.positions, r.normals, r.options, 0.01);
  EXPECT_EQ(rates.rays,
            estimate_irradiance(r.bvh, r.lights, r.positions, r.normals, r.options).rays_traced);
  size_t recorded = 0;
  for (const RayLog& log : r.logs) recorded += log.nearest_rays.size() + log.shadow_rays.size();
  EXPECT_EQ(rates.rays, static_cast<int64_t>(recorded));
  EXPECT_GT(rates.path_rays_per_s, 0);
  EXPECT_EQ(rates.bare.size(), 2 * std::size(kRecordPoints));
  for (const BareRate& rate : rates.bare) EXPECT_GT(rate.rays_per_s, 0);
}

}  // namespace
}  // namespace lte::experiments
