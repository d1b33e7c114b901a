#include "infer/probe/gathered_probe.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/gi/gather.h"

namespace lte::infer {
namespace {

constexpr size_t kBlock = 4096;      // points between two looks at the progress
constexpr uint64_t kTableRays = 61;  // independent of the places and the light of the tables

/// Sums of a value's differences from the first of its kind, and of their squares.
struct Spread {
  Rgb first, sum, squares;
};

}  // namespace

GatheredProbe gather_at(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                        const scene::PointTable& points, const GatheredProbeOptions& options,
                        const std::function<gi::IrradianceCache(int)>& make_cache) {
  LTE_CHECK(options.tables >= 2, "gathered points: expected two tables at least, got ",
            options.tables);
  if (options.max_depth < 2)
    return {std::vector<Rgb>(points.size()), std::vector<Rgb>(points.size()), options.tables, 0};
  gi::GatherOptions gather;
  gather.rays = std::max(1, (options.rays + options.tables - 1) / options.tables);
  gather.max_depth = options.max_depth;
  std::vector<Spread> spread(points.size());
  for (int k = 0; k < options.tables; ++k) {
    const gi::IrradianceCache table = make_cache(k);
    gather.seed = hash_combine(hash_combine(options.seed, kTableRays), static_cast<uint64_t>(k));
    for (size_t begin = 0; begin < points.size(); begin += kBlock) {
      const size_t count = std::min(kBlock, points.size() - begin);
      const std::vector<Rgb> found =
          gi::gather_irradiance(
              bvh, lights, table, std::span(points.position).subspan(begin, count),
              std::span(points.normal).subspan(begin, count), gather, static_cast<int64_t>(begin))
              .indirect;
      for (size_t i = 0; i < count; ++i) {
        Spread& point = spread[begin + i];
        if (k == 0) point.first = found[i];
        const Rgb apart = found[i] - point.first;
        point.sum += apart;
        point.squares += apart * apart;
      }
      if (options.done) options.done(static_cast<int64_t>(count));
    }
  }
  GatheredProbe out;
  out.tables = options.tables;
  out.rays = int64_t{gather.rays} * options.tables;
  const auto tables = static_cast<float>(options.tables);
  for (const Spread& point : spread) {
    out.indirect.push_back(point.first + point.sum / tables);
    const Rgb variance = (point.squares - point.sum * point.sum / tables) / (tables * (tables - 1));
    out.standard_error.push_back({std::sqrt(std::max(0.0f, variance.x)),
                                  std::sqrt(std::max(0.0f, variance.y)),
                                  std::sqrt(std::max(0.0f, variance.z))});
  }
  return out;
}

}  // namespace lte::infer
