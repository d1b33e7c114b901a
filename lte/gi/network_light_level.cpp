#include "lte/gi/network_light_level.h"

#include <algorithm>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/gi/gather.h"

namespace lte::gi {
namespace {

// One record in so many is sampled for the share of its light that the scene passes on.
constexpr size_t kSampled = 4;
// The guess, brought to the level of light that the scene has reflected once, is at most so many
// times brighter or darker than that. In twelve homes and wild rooms 2 to 8 are worth the same, and
// 1, which leaves no guess, a twentieth less.
constexpr float kBound = 4;

/// Of records, every kSampled-th.
CacheRecords picked(const CacheRecords& records) {
  CacheRecords out;
  for (size_t i = 0; i < records.position.size(); i += kSampled) {
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

std::vector<Rgb> difference_of(std::span<const Rgb> a, std::span<const Rgb> b) {
  std::vector<Rgb> out(a.begin(), a.end());
  for (size_t i = 0; i < out.size(); ++i) out[i] = out[i] - b[i];
  return out;
}

std::vector<Rgb> picked(std::span<const Rgb> of_all) {
  std::vector<Rgb> out;
  for (size_t i = 0; i < of_all.size(); i += kSampled) out.push_back(of_all[i]);
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

/// The guess as bright as `once` by the median of records, within kBound of it everywhere.
std::vector<Rgb> bounded(const CacheRecords& records, std::span<const Rgb> guess,
                         std::span<const Rgb> once) {
  std::vector<Rgb> out(guess.size());
  for (int c = 0; c < 3; ++c) {
    std::vector<std::pair<float, float>> ratios;
    for (size_t i = 0; i < guess.size(); ++i)
      if (guess[i][c] > 0) ratios.emplace_back(once[i][c] / guess[i][c], records.area[i]);
    const float level = median(std::move(ratios));
    for (size_t i = 0; i < guess.size(); ++i)
      out[i][c] = std::clamp(level * guess[i][c], once[i][c] / kBound, once[i][c] * kBound);
  }
  return out;
}

/// How bright a guess has to be in a channel, for light of so many bounces.
/// @param guess, reflected  [records], and after one more reflection
/// @param first             light of the first of these bounces
float level_of(const CacheRecords& records, std::span<const Rgb> guess,
               std::span<const Rgb> reflected, std::span<const Rgb> first, int channel,
               int bounces) {
  double guessed = 0, once = 0, more = 0;
  for (size_t i = 0; i < guess.size(); ++i) {
    const double area{records.area[i]};
    guessed += area * double{guess[i][channel]};
    once += area * double{first[i][channel]};
    more += area * double{reflected[i][channel]};
  }
  if (!(guessed > 0)) return 0;
  const double passed = std::clamp(more / guessed, 0.0, 1.0);
  double series = 0;
  for (int bounce = 0; bounce < bounces; ++bounce) series = 1 + passed * series;
  return static_cast<float>(once * series / guessed);
}

}  // namespace

IrradianceCache level_network_light(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                    const CacheRecords& records, const RecordLight& light,
                                    const LevelOptions& options) {
  const std::vector<Rgb>& direct = light.direct;
  LTE_CHECK(light.indirect.size() == direct.size(), "a guess of indirect light has ",
            light.indirect.size(), " values for ", direct.size(), " records");
  const IrradianceCache cache(bvh, records, direct, direct, light.direct_variance);
  // A gather over the cache adds a bounce to the last.
  const int bounces = options.max_depth - 2;
  if (bounces < 1 || direct.empty()) return cache;
  GatherOptions gather;
  gather.rays = options.rays;
  // Where a ray finds no record that it may read, it goes on as a path: to the depth that what it
  // would have read has after a reflection, or light of more bounces would be found by chance.
  const auto gathered = [&](const IrradianceCache& read, int depth, const CacheRecords& at,
                            uint64_t pass) {
    gather.max_depth = depth + 1;
    gather.seed = hash_combine(options.seed, pass);
    const bool bumpy = !at.start_shading.empty();
    return record_means(
        at, gather_irradiance(
                bvh, lights, read, at.start, bumpy ? at.start_shading : at.start_normal, gather, 0,
                bumpy ? std::span<const Vec3>(at.start_normal) : std::span<const Vec3>())
                .indirect);
  };
  // Places are read where direct light is even beside all light, of which the guess gives an idea.
  const std::vector<Rgb> once = gathered(
      cache.relit(records, sum_of(direct, light.indirect)).answering(direct), 1, records, 0);
  std::vector<Rgb> indirect = once;
  if (bounces > 1) {
    const IrradianceCache lit = cache.relit(records, sum_of(direct, once));
    if (bounces > 2) {
      const std::vector<Rgb> guess = bounded(records, light.indirect, once);
      const CacheRecords some = picked(records);
      // Rays that go on would add direct light: they do so with nothing to read as well.
      gather.near = 0;
      const auto of = [&](const std::vector<Rgb>& read) {
        return gathered(lit.answering_everywhere(read), 1, some, 1);
      };
      const std::vector<Rgb> none = of(std::vector<Rgb>(direct.size()));
      const std::vector<Rgb> twice = difference_of(of(once), none);
      const std::vector<Rgb> reflected = difference_of(of(guess), none);
      gather.near = GatherOptions().near;
      Rgb level;
      for (int c = 0; c < 3; ++c)
        level[c] = level_of(some, picked(guess), reflected, twice, c, bounces - 2);
      for (size_t i = 0; i < indirect.size(); ++i) indirect[i] += guess[i] * level;
    }
    indirect = gathered(lit.relit(records, sum_of(direct, indirect)), bounces, records, 2);
  }
  return cache.relit(records, sum_of(direct, indirect));
}

}  // namespace lte::gi
