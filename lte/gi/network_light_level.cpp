#include "lte/gi/network_light_level.h"

#include <algorithm>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/gi/gather.h"

namespace lte::gi {
namespace {

// One record in so many of those that light reaches is sampled for the share of its light that the
// scene passes on. Odd, as the two sides of a place follow each other.
constexpr size_t kSampled = 3;
// Light in the housing of a lamp is many times what any guess of a room has there, and nobody sees
// it: ratios beyond so many medians count as so many.
constexpr float kOutlier = 4;

// Reflections of the leveled guess. One level for a whole scene is wrong in the single rooms of
// it, the less so the more often the scene itself has carried the light. At the usual depth of 5 a
// third would leave nothing of the guess.
constexpr int kReflections = 2;

CacheRecords picked(const CacheRecords& records, std::span<const size_t> which) {
  CacheRecords out;
  for (const size_t i : which) {
    out.position.push_back(records.position[i]);
    out.normal.push_back(records.normal[i]);
    out.albedo.push_back(records.albedo[i]);
    out.area.push_back(records.area[i]);
    for (size_t k = records.first[i]; k < records.first[i + 1]; ++k) {
      out.start.push_back(records.start[k]);
      out.start_normal.push_back(records.start_normal[k]);
      if (!records.start_shading.empty()) out.start_shading.push_back(records.start_shading[k]);
    }
    out.first.push_back(out.start.size());
  }
  return out;
}

std::vector<Rgb> sum_of(std::span<const Rgb> a, std::span<const Rgb> b) {
  std::vector<Rgb> out(a.begin(), a.end());
  for (size_t i = 0; i < out.size(); ++i) out[i] += b[i];
  return out;
}

std::vector<Rgb> picked(std::span<const Rgb> of_all, std::span<const size_t> which) {
  std::vector<Rgb> out;
  for (const size_t i : which) out.push_back(of_all[i]);
  return out;
}

/// The records that a cache knows to say something.
std::vector<size_t> speaking(const IrradianceCache& cache) {
  std::vector<size_t> out;
  for (int64_t i = 0; i < cache.size(); ++i) {
    if (!cache.silent(i)) out.push_back(static_cast<size_t>(i));
  }
  return out;
}

/// The guess at these records, and darkness at all others.
std::vector<Rgb> guessed_at(const CacheRecords& records, std::span<const size_t> which,
                            const IrradianceSource& guess) {
  std::vector<Rgb> out(records.position.size());
  if (which.empty()) return out;
  std::vector<Vec3> position, normal;
  for (const size_t i : which) {
    position.push_back(records.position[i]);
    normal.push_back(records.normal[i]);
  }
  const std::vector<Rgb> found = guess(position, normal, picked(records.albedo, which));
  LTE_CHECK(found.size() == which.size(), "a guess of indirect light has ", found.size(),
            " values for ", which.size(), " records");
  for (size_t k = 0; k < which.size(); ++k) out[which[k]] = found[k];
  return out;
}

/// The weighted median of values.
float median(std::vector<std::pair<float, float>> value_and_weight) {
  std::sort(value_and_weight.begin(), value_and_weight.end());
  double all = 0, below = 0;
  for (const auto& [value, weight] : value_and_weight) all += double{weight};
  for (const auto& [value, weight] : value_and_weight) {
    below += double{weight};
    if (2 * below >= all) return value;
  }
  return 0;
}

/// How bright the guess has to be in a channel, for light of so many bounces. What counts is area:
/// weights that favor bright places speak of the insides of lamps.
/// @param both, direct  a reflection of direct light with the guess and without it, [records]
float level_of(const CacheRecords& records, std::span<const Rgb> guess, std::span<const Rgb> both,
               std::span<const Rgb> direct, int channel, int bounces) {
  std::vector<std::pair<float, float>> ratios;
  for (size_t i = 0; i < guess.size(); ++i) {
    const float f = guess[i][channel];
    if (f > 0) ratios.emplace_back(direct[i][channel] / f, records.area[i]);
  }
  const float most = kOutlier * median(std::move(ratios));
  double guessed = 0, once = 0, more = 0;
  for (size_t i = 0; i < guess.size(); ++i) {
    const float f = guess[i][channel];
    if (!(f > 0)) continue;
    const double area{records.area[i]};
    guessed += area * double{f};
    once += area * double{std::min(direct[i][channel], most * f)};
    more += area * double{both[i][channel] - direct[i][channel]};
  }
  if (!(guessed > 0)) return 0;
  const double passed = std::clamp(more / guessed, 0.0, 1.0);
  double series = 0;
  for (int bounce = 0; bounce < bounces; ++bounce) series = 1 + passed * series;
  return static_cast<float>(once * series / guessed);
}

}  // namespace

IrradianceCache level_network_light(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                    const std::shared_ptr<const CacheGeometry>& geometry,
                                    const CacheRecords& records, const RecordLight& light,
                                    const IrradianceSource& guess, const LevelOptions& options) {
  const std::vector<Rgb>& direct = light.direct;
  GatherOptions gather;
  gather.rays = options.rays;
  gather.seed = options.seed;
  // A gather over the cache adds a bounce to the last.
  const int bounces = options.max_depth - 2, rounds = std::min(kReflections, bounces);
  // Where a ray finds no record that it may read, it goes on as a path: to the depth that what it
  // would have read has after a reflection, or light of more bounces would be found by chance.
  const auto gathered = [&](const IrradianceCache& cache, int depth, const CacheRecords& at) {
    gather.max_depth = depth + 1;
    const bool bumpy = !at.start_shading.empty();
    return record_means(
        at, gather_irradiance(
                bvh, lights, cache, at.start, bumpy ? at.start_shading : at.start_normal, gather, 0,
                bumpy ? std::span<const Vec3>(at.start_normal) : std::span<const Vec3>())
                .indirect);
  };
  const std::vector<Rgb> nothing(direct.size());
  IrradianceCache cache(geometry, records, direct, direct, light.direct_variance, nothing);
  if (bounces < 1 || direct.empty()) return cache;
  // A guess is a guess inside of things, too, where no light comes.
  const std::vector<size_t> lit = speaking(cache);
  const std::vector<Rgb> reached = guessed_at(records, lit, guess);
  std::vector<size_t> which;
  for (size_t k = 0; k < lit.size(); k += kSampled) which.push_back(lit[k]);
  const IrradianceCache both = cache.relit(records, sum_of(direct, reached));
  CacheRecords some = picked(records, which);
  // In gaps a network says too much, and few rays come there.
  for (size_t k = 0; k < which.size(); ++k)
    some.area[k] *= geometry->share(static_cast<uint32_t>(which[k]));
  const std::vector<Rgb> f = picked(reached, which);
  const std::vector<Rgb> of_direct = gathered(both.answering(direct), 1, some);
  // Of one bounce, nothing is passed on.
  const std::vector<Rgb> of_both = bounces - rounds > 1 ? gathered(both, 1, some) : of_direct;
  const auto leveled = [&](int depth) {
    Rgb level;
    for (int c = 0; c < 3; ++c) level[c] = level_of(some, f, of_both, of_direct, c, depth - 1);
    std::vector<Rgb> out(reached.size());
    for (size_t i = 0; i < out.size(); ++i) out[i] = direct[i] + reached[i] * level;
    return out;
  };
  const int guessed = 1 + bounces - rounds;  // depth of the leveled guess with direct light
  std::vector<Rgb> shorter = guessed > 1 ? leveled(guessed - 1) : nothing;
  std::vector<Rgb> total = leveled(guessed);
  for (int round = 0; round < rounds; ++round) {
    gather.seed = hash_combine(options.seed, static_cast<uint64_t>(round));
    cache = cache.relit(records, total, shorter);
    shorter = std::move(total);
    if (round == 0) {  // by which light may come to any
      total = sum_of(direct, gathered(cache, guessed, records));
      continue;
    }
    const std::vector<size_t> at = speaking(cache);
    const std::vector<Rgb> found = gathered(cache, guessed + round, picked(records, at));
    total = direct;
    for (size_t k = 0; k < at.size(); ++k) total[at[k]] += found[k];
  }
  return cache.relit(records, total, shorter);
}

}  // namespace lte::gi
