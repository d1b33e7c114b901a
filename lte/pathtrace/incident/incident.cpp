#include "lte/pathtrace/incident/incident.h"

#include <array>
#include <atomic>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/incident/hemisphere_bins.h"
#include "lte/pathtrace/incident/slot_sums.h"
#include "lte/pathtrace/transport/irradiance_kernel.h"

namespace lte::pathtrace {
namespace {

constexpr int kMaxBins = 1024;
constexpr int kMaxSamples = 1 << 20;

void check_options(const IncidentOptions& options) {
  LTE_CHECK(options.bins >= 2 && options.bins <= kMaxBins && options.bins % 2 == 0,
            "bins must be an even number from 2 to ", kMaxBins, ", got ", options.bins);
  LTE_CHECK(options.samples >= 1 && options.samples <= kMaxSamples, "samples must be 1 to ",
            kMaxSamples, ", got ", options.samples);
  IrradianceOptions shared;
  shared.max_depth = options.max_depth;
  shared.roulette_depth = options.roulette_depth;
  check_irradiance_options(shared);
}

/// Traces all cells of one point.
/// @param origin  in the frame of the BVH, already off the surface
void trace_cells(Transport& transport, const Vec3& origin, const Vec3& normal,
                 const IncidentOptions& options, PathSampler& sampler, SlotSums& sums) {
  const BinFrame frame(normal);
  const int bins = options.bins;
  DirectionNumbers numbers;
  std::array<int32_t, kBlock> paths, cells;
  for (int32_t i = 0; i < kBlock; ++i) paths[static_cast<size_t>(i)] = i;
  const auto flush = [&] {
    const int count = sampler.paths();
    sampler.direction(0, paths.data(), count, &numbers);
    for (int i = 0; i < count; ++i) {
      const int cell = cells[static_cast<size_t>(i)];
      const Vec2 place{(static_cast<float>(cell % bins) + to_unit(numbers.x[i])) / bins,
                       (static_cast<float>(cell / bins) + to_unit(numbers.y[i])) / bins};
      transport.start().origin.put(i, origin);
      transport.start().direction.put(i, frame.to_world(bin_direction(place)));
    }
    transport.trace_from_camera(sampler);
    sampler.clear();
  };
  for (int cell = 0; cell < bins * bins; ++cell) {
    sampler.start_set();
    for (int i = 0; i < options.samples; ++i) {
      if (sampler.paths() == kBlock) flush();
      cells[static_cast<size_t>(sampler.paths())] = cell;
      sums.assign(sampler.paths(), cell);
      sampler.add_path();
    }
  }
  flush();
}

}  // namespace

IncidentRadiance estimate_incident(const Bvh& bvh, const Lights& lights,
                                   std::span<const Vec3> positions, std::span<const Vec3> normals,
                                   const IncidentOptions& options, int64_t first_index) {
  LTE_CHECK(&bvh.scene() == &lights.scene(), "the BVH and the lights are of two scenes");
  check_options(options);
  check_points(positions, normals);
  IncidentRadiance out;
  out.groups = lights.groups();
  out.points = static_cast<int64_t>(positions.size());
  out.bins = options.bins;
  out.direct.resize(static_cast<size_t>(out.groups * out.points * out.cells()));
  out.indirect.resize(out.direct.size());
  if (lights.empty()) return out;
  std::atomic<int64_t> rays_traced{0};
  parallel_for(out.points, 1, [&](int64_t begin, int64_t end) {
    SlotSums sums(out.groups, out.cells());
    const auto sampler = std::make_unique<PathSampler>(Sampling::Sobol, options.samples);
    const auto transport =
        std::make_unique<Transport>(bvh, lights, options.max_depth, options.roulette_depth, sums);
    for (int64_t i = begin; i < end; ++i) {
      sums.clear();
      sampler->start_stream(options.seed, static_cast<uint64_t>(first_index + i));
      trace_cells(*transport, off_surface(bvh, positions[i], normals[i]), normals[i], options,
                  *sampler, sums);
      for (int64_t g = 0; g < out.groups; ++g) {
        const auto slot = static_cast<size_t>((g * out.points + i) * out.cells());
        sums.store(g, options.samples, &out.direct[slot], &out.indirect[slot]);
      }
    }
    rays_traced += transport->rays_traced();
  });
  out.rays_traced = rays_traced;
  return out;
}

}  // namespace lte::pathtrace
