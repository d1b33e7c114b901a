#include "train/fit/fit_queries.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/reach/reach.h"

namespace lte::train {
namespace {

constexpr size_t kBlock = 2048;

/// 0 to count − 1 in an order of chance.
std::vector<size_t> shuffled(size_t count, uint64_t seed) {
  std::vector<size_t> order(count);
  std::iota(order.begin(), order.end(), size_t{0});
  Rng rng(seed);
  for (size_t i = count; i > 1; --i)
    std::swap(order[i - 1], order[static_cast<size_t>(rng.below(i))]);
  return order;
}

}  // namespace

FitQueries draw_queries(const pathtrace::Bvh& bvh, int64_t count, uint64_t seed) {
  scene::SamplerOptions sampler;
  sampler.seed = seed;
  sampler.filter_footprint = false;
  sampler.punctual_lights = false;
  sampler.environment_share = 0;
  pathtrace::ReachOptions reach;
  reach.seed = seed;
  pathtrace::PruneCounts counts;
  const scene::SurfaceSamples samples = pathtrace::sample_reached_surface(
      bvh, count, sampler, pathtrace::Purpose::Queries, reach, &counts);
  FitQueries out;
  for (const size_t i : shuffled(samples.position.size(), seed)) {
    if (max_component(samples.albedo[i]) <= 0) continue;
    out.position.push_back(samples.position[i]);
    out.normal.push_back(samples.normal[i]);
    out.albedo.push_back(samples.albedo[i]);
  }
  LTE_CHECK(out.size() > 0, bvh.scene().name, ": no surface reflects light");
  return out;
}

void trace_queries(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights, int rays,
                   uint64_t seed, FitQueries* queries,
                   const std::function<bool(int64_t done)>& stop) {
  pathtrace::IrradianceOptions options;
  options.rays = rays;
  options.seed = seed;
  options.by_group = false;
  options.variance = false;
  queries->indirect.clear();
  const size_t all = queries->position.size();
  for (size_t first = 0; first < all; first += kBlock) {
    const size_t count = std::min(kBlock, all - first);
    const auto block = [&](const std::vector<Vec3>& of) {
      return std::span(of).subspan(first, count);
    };
    const pathtrace::Irradiance light = pathtrace::estimate_irradiance(
        bvh, lights, block(queries->position), block(queries->normal), options,
        static_cast<int64_t>(first));
    queries->indirect.insert(queries->indirect.end(), light.indirect.begin(), light.indirect.end());
    queries->rays = light.rays;
    if (stop(static_cast<int64_t>(first + count))) break;
  }
  const size_t done = queries->indirect.size();
  queries->position.resize(done);
  queries->normal.resize(done);
  queries->albedo.resize(done);
}

}  // namespace lte::train
