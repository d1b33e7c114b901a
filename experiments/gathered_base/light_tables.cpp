#include "experiments/gathered_base/light_tables.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/gi/gather.h"

namespace lte::experiments {
namespace {

constexpr uint64_t kPlaces = 1, kDirect = 2, kTraced = 3, kSweeps = 4;
constexpr int kMoreSweeps = 2;

}  // namespace

LightTables::LightTables(const render::TracedScene& scene, const TableOptions& options)
    : scene_(scene), options_(options) {
  const double start = processor_seconds();
  places_ = gi::sample_records(scene.bvh, options.records, hash_combine(options.seed, kPlaces));
  direct_ = gi::estimate_records(scene.bvh, scene.lights, places_, options.direct_paths, 1,
                                 hash_combine(options.seed, kDirect))
                .direct;
  direct_seconds_ = processor_seconds() - start;
}

LightTable LightTables::table(const std::string& name, std::vector<Rgb> indirect,
                              double seconds) const {
  LightTable out{name, {}, seconds};
  out.light.direct = direct_;
  out.light.indirect = std::move(indirect);
  return out;
}

LightTable LightTables::swept(const LightTable& from, const std::string& name, int number) const {
  const double start = processor_seconds();
  gi::GatherOptions options;
  options.rays = std::max(1, options_.paths / gi::kRecordPoints);
  options.max_depth = options_.max_depth;
  options.seed = hash_combine(hash_combine(options_.seed, kSweeps), static_cast<uint64_t>(number));
  const gi::IrradianceCache cache = cache_of(from);
  std::vector<Rgb> indirect =
      gi::record_means(places_, gi::gather_irradiance(scene_.bvh, scene_.lights, cache,
                                                      places_.start, places_.start_normal, options)
                                    .indirect);
  return table(name, std::move(indirect), from.seconds + processor_seconds() - start);
}

LightTable LightTables::traced(const std::string& name, int paths) const {
  const double start = processor_seconds();
  LightTable out{name, {}, 0};
  out.light = gi::estimate_records(scene_.bvh, scene_.lights, places_, paths,
                                   options_.max_depth - 1, hash_combine(options_.seed, kTraced));
  out.seconds = processor_seconds() - start;
  return out;
}

gi::IrradianceCache LightTables::cache_of(const LightTable& table) const {
  return gi::IrradianceCache::of(std::make_shared<const gi::CacheGeometry>(scene_.bvh, places_),
                                 places_, table.light);
}

std::vector<LightTable> LightTables::make(const runtime::SceneEmbedding& embedding) const {
  const runtime::QueryPoints queries{places_.position, places_.normal, places_.albedo};
  std::vector<LightTable> out;
  const auto sweep = [&](LightTable from, int count) {
    const std::string name = from.name;
    for (int k = 1; k <= count; ++k) {
      from = swept(from, concat(name.empty() ? "" : name + "-", "swept-", k), k);
      out.push_back(from);
    }
  };
  const int more = std::min(options_.sweeps, kMoreSweeps);
  double start = processor_seconds();
  out.push_back(table("solved", embedding.light_prior(queries), 0));
  out.back().seconds = processor_seconds() - start;
  sweep(LightTable(out.back()), more);
  start = processor_seconds();
  out.push_back(table("network", embedding.decode(queries), 0));
  out.back().seconds = processor_seconds() - start;
  sweep(LightTable(out.back()), more);
  sweep(table("", std::vector<Rgb>(direct_.size()), 0), options_.sweeps);
  out.push_back(traced("raw", options_.paths));
  out.back().light.direct = direct_;
  if (options_.reference_paths > 0) out.push_back(traced("truth", options_.reference_paths));
  return out;
}

}  // namespace lte::experiments
