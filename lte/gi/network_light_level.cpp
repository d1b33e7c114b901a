#include "lte/gi/network_light_level.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/morton.h"
#include "lte/base/random.h"
#include "lte/gi/gather.h"

namespace lte::gi {
namespace {

// Records whose guess has one level: they face the same way, and lie side by side.
constexpr size_t kRegion = 256;
// Of those, one in so many is sampled for what the scene passes on.
constexpr size_t kSampled = 4;
// Of a mean region, what a region's level is drawn by to that of the scene: where a region has
// little light, few samples say little.
constexpr double kUsual = 0.25;
// The guess, brought to the level of light that the scene has reflected once, is at most so many
// times brighter or darker than that. In twelve homes and wild rooms 2 to 8 are worth the same.
constexpr float kBound = 4;

/// Numbers of the records, so that each kRegion of them are a region.
std::vector<size_t> by_region(const CacheRecords& records) {
  constexpr float kCells = (1 << 20) - 1;
  Bounds bounds;
  for (const Vec3& position : records.position) bounds.extend(position);
  const float scale = kCells / std::max(max_component(bounds.extent()), 1e-20f);
  std::vector<std::pair<std::pair<int, uint64_t>, size_t>> keys;
  for (size_t i = 0; i < records.position.size(); ++i) {
    const Vec3& n = records.normal[i];
    int axis = 0;
    for (int k = 1; k < 3; ++k) axis = std::fabs(n[k]) > std::fabs(n[axis]) ? k : axis;
    const Vec3 cell = (records.position[i] - bounds.low) * scale;
    keys.push_back({{2 * axis + (n[axis] < 0 ? 1 : 0),
                     morton_code({static_cast<uint32_t>(cell.x), static_cast<uint32_t>(cell.y),
                                  static_cast<uint32_t>(cell.z)})},
                    i});
  }
  std::sort(keys.begin(), keys.end());
  std::vector<size_t> out;
  for (const auto& [key, record] : keys) out.push_back(record);
  return out;
}

/// These records alone.
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

std::vector<Rgb> difference_of(std::span<const Rgb> a, std::span<const Rgb> b) {
  std::vector<Rgb> out(a.begin(), a.end());
  for (size_t i = 0; i < out.size(); ++i) out[i] = out[i] - b[i];
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

/// What brings a guess to the level of light, by the median of records, and channel.
Rgb median_ratio(const CacheRecords& records, std::span<const size_t> which,
                 std::span<const Rgb> light, std::span<const Rgb> guess) {
  Rgb out;
  for (int c = 0; c < 3; ++c) {
    std::vector<std::pair<float, float>> ratios;
    for (size_t k = 0; k < which.size(); ++k) {
      // A guess is a guess inside of things, too, where no light comes.
      const float f = guess[which[k]][c];
      if (f > 0 && light[k][c] > 0) ratios.emplace_back(light[k][c] / f, records.area[which[k]]);
    }
    out[c] = median(std::move(ratios));
  }
  return out;
}

struct Bounded {
  std::vector<Rgb> guess;
  /// Where it was darker than the bound: in the housings of lamps and beside them, of which a guess
  /// of a room knows nothing, and whose light would count for the room around them.
  std::vector<std::array<bool, 3>> raised;
};

/// The guess times a level, within kBound of `once` everywhere.
Bounded bounded_by(std::span<const Rgb> once, std::span<const Rgb> guess, const Rgb& level) {
  Bounded out{std::vector<Rgb>(guess.size()), std::vector<std::array<bool, 3>>(guess.size())};
  for (size_t i = 0; i < guess.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const float least = once[i][c] / kBound, f = level[c] * guess[i][c];
      out.guess[i][c] = std::clamp(f, least, once[i][c] * kBound);
      out.raised[i][static_cast<size_t>(c)] = f < least;
    }
  }
  return out;
}

/// Sums over records, by which the level of a guess is found.
struct LevelSums {
  double guess = 0;      ///< of all records
  double first = 0;      ///< light of the first bounce that the guess is to stand for, W
  double reflected = 0;  ///< the guess after one more reflection

  LevelSums operator+(const LevelSums& more) const {
    return {guess + more.guess, first + more.first, reflected + more.reflected};
  }
  LevelSums operator*(double scale) const {
    return {guess * scale, first * scale, reflected * scale};
  }
  /// For light of so many bounces. Sums are of differences, and below 0 by rounding.
  float level(int bounces) const {
    if (!(guess > 0) || !(first > 0)) return 0;
    const double passed = std::clamp(reflected / guess, 0.0, 1.0);
    double series = 0;
    for (int bounce = 0; bounce < bounces; ++bounce) series = 1 + passed * series;
    return static_cast<float>(first * series / guess);
  }
};

/// The bounded guess at the level of light of so many bounces, region by region, and in each apart
/// where it was raised.
/// @param order             by_region(), of which every kSampled-th record is sampled
/// @param reflected, first  of the sampled records: the guess after one more reflection, and light
///                          of the first of these bounces
std::vector<Rgb> leveled(const CacheRecords& records, std::span<const size_t> order,
                         std::span<const Rgb> reflected, std::span<const Rgb> first, int bounces,
                         const Bounded& bounded) {
  const size_t regions = (order.size() + kRegion - 1) / kRegion;
  std::vector<Rgb> out(bounded.guess.size());
  for (size_t c = 0; c < 3; ++c) {
    const auto channel = static_cast<int>(c);
    for (const bool raised : {false, true}) {
      std::vector<LevelSums> sums(regions);
      LevelSums all;
      // By the light of the sampled records and the guess of all, sums are right in the mean, as
      // ratios of two noisy ones are not.
      for (size_t k = 0; k < order.size(); ++k) {
        const size_t i = order[k];
        if (bounded.raised[i][c] != raised) continue;
        const double area{records.area[i]};
        LevelSums one{area * double{bounded.guess[i][channel]}, 0, 0};
        if (k % kSampled == 0) {
          const double stands_for =
              area * static_cast<double>(std::min(kSampled, order.size() - k));
          one.first = stands_for * double{first[k / kSampled][channel]};
          one.reflected = stands_for * double{reflected[k / kSampled][channel]};
        }
        sums[k / kRegion] = sums[k / kRegion] + one;
        all = all + one;
      }
      const LevelSums usual = all * (kUsual / static_cast<double>(regions));
      for (size_t k = 0; k < order.size(); ++k) {
        const size_t i = order[k];
        if (bounded.raised[i][c] != raised) continue;
        out[i][channel] = bounded.guess[i][channel] * (sums[k / kRegion] + usual).level(bounces);
      }
    }
  }
  return out;
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
  const std::vector<size_t> order = by_region(records);
  const auto every = [&](size_t step) {
    std::vector<size_t> which;
    for (size_t k = 0; k < order.size(); k += step) which.push_back(order[k]);
    return which;
  };
  // Places are read where direct light is even beside all light, of which the guess gives an idea.
  const std::vector<size_t> few = every(kSampled * kSampled);
  const Rgb level =
      median_ratio(records, few, gathered(cache, 1, picked(records, few), 3), light.indirect);
  std::vector<Rgb> idea = direct;
  for (size_t i = 0; i < idea.size(); ++i) idea[i] += light.indirect[i] * level;
  const std::vector<Rgb> once =
      gathered(cache.relit(records, idea).answering(direct), 1, records, 0);
  std::vector<Rgb> indirect = once;
  if (bounces > 1) {
    const IrradianceCache lit = cache.relit(records, sum_of(direct, once));
    if (bounces > 2) {
      const Bounded bounded = bounded_by(once, light.indirect, level);
      const CacheRecords some = picked(records, every(kSampled));
      // Rays that go on would add direct light: they do so with nothing to read as well.
      gather.near = 0;
      const auto of = [&](const std::vector<Rgb>& read) {
        return gathered(lit.answering_everywhere(read), 1, some, 1);
      };
      const std::vector<Rgb> none = of(std::vector<Rgb>(direct.size()));
      const std::vector<Rgb> twice = difference_of(of(once), none);
      const std::vector<Rgb> reflected = difference_of(of(bounded.guess), none);
      gather.near = GatherOptions().near;
      indirect = sum_of(once, leveled(records, order, reflected, twice, bounces - 2, bounded));
    }
    indirect = gathered(lit.relit(records, sum_of(direct, indirect)), bounces, records, 2);
  }
  return cache.relit(records, sum_of(direct, indirect));
}

}  // namespace lte::gi
