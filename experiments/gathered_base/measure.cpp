#include "experiments/gathered_base/measure.h"

#include <algorithm>

#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/gi/gather.h"

namespace lte::experiments {
namespace {

constexpr uint64_t kGather = 21, kAgain = 22;

AnswerRow row(const PointErrors& errors, const std::string& name, int rays,
              const std::vector<Rgb>& answers, double seconds) {
  AnswerRow out{name, rays};
  out.mse = errors.mse(answers);
  out.worth = errors.worth(out.mse);
  out.mean_ratio = errors.mean_ratio(answers);
  out.microseconds = 1e6 * seconds / static_cast<double>(answers.size());
  return out;
}

/// The answers of one table by all numbers of rays.
void measure_table(const render::TracedScene& scene, const gi::IrradianceCache& cache,
                   const LightTable& table, const Queries& queries, const PointErrors& errors,
                   const MeasureOptions& options, Measured* out) {
  const auto gather = [&](int rays, uint64_t stream) {
    gi::GatherOptions gathering;
    gathering.rays = rays;
    gathering.max_depth = options.max_depth;
    gathering.seed = hash_combine(options.seed, stream);
    return gi::gather_irradiance(scene.bvh, scene.lights, cache, queries.position, queries.normal,
                                 gathering)
        .indirect;
  };
  std::vector<Rgb> last;
  for (const int rays : options.rays) {
    const double start = processor_seconds();
    last = gather(rays, kGather);
    out->answers.push_back(row(errors, table.name, rays, last, processor_seconds() - start));
  }
  const double bias = errors.product(last, gather(options.rays.back(), kAgain));
  out->tables.push_back({table.name, table.seconds, bias});
}

}  // namespace

Measured measure(const render::TracedScene& scene, const LightTables& maker,
                 const std::vector<LightTable>& tables, const runtime::SceneEmbedding& embedding,
                 const Queries& queries, const MeasureOptions& options) {
  const PointErrors errors(queries.references);
  const runtime::QueryPoints points{queries.position, queries.normal, queries.albedo};
  Measured out;
  out.mean = errors.mean();
  double start = processor_seconds();
  const std::vector<Rgb> prior = embedding.light_prior(points);
  out.answers.push_back(row(errors, "prior", 0, prior, processor_seconds() - start));
  start = processor_seconds();
  const std::vector<Rgb> decoded = embedding.decode(points);
  out.answers.push_back(row(errors, "decoded", 0, decoded, processor_seconds() - start));
  for (const LightTable& table : tables)
    measure_table(scene, maker.cache_of(table), table, queries, errors, options, &out);
  return out;
}

}  // namespace lte::experiments
