#include "lte/gi/gather.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/blocks/tile_sequence.h"
#include "lte/pathtrace/ray_offset.h"
#include "lte/pathtrace/transport/irradiance_kernel.h"
#include "lte/pathtrace/transport/transport_impl.h"
#include "lte/scene/texel_densities.h"

namespace lte::gi {
namespace {

using pathtrace::kBlock;

constexpr int kRouletteDepth = 3;  // that of irradiance
constexpr int kMaxRays = 1 << 20;
constexpr int64_t kGrain = 64;  // points
// Points whose rays are stratified together. Each takes a run of one sequence, so that those of
// neighbors fill each other's gaps: where they see about the same, the noise of their mean falls
// faster than with as many sequences, and what is left lies in the fine detail that a denoiser
// takes (Ahmed and Wonka, "Screen-space blue-noise diffusion of Monte Carlo sampling error via
// hierarchical ordering of pixels", 2020).
constexpr int kStratified = 64;
// Of sets that go on over calls, more than any has.
constexpr int kLongSet = 1 << 30;
// Of the edge of what a ray stands for: textures are filtered over a part of it.
constexpr float kFiltered = 0.25f;

/// Metres a metre of a ray's length. A coarse texture has less noise and lies in the cache. Paths
/// that no cache ends are to converge to those of the path tracer, which filters nothing.
float spread_of(const IrradianceCache& cache, int rays) {
  if (cache.size() == 0) return 0;
  return kFiltered * std::sqrt(2 * kPi / static_cast<float>(rays));
}

struct Counts {
  int64_t lookups = 0, misses = 0;
};

/// Ends paths where the cache knows the light.
struct CacheReader {
  void nearest(int, const pathtrace::PathBlock&) {}
  void shadow(const pathtrace::ShadowBlock&) {}
  bool known_irradiance(int depth, float distance, const Vec3& position, const Vec3& side,
                        Rgb* irradiance) {
    if (depth <= near_hits && distance < near_m) return false;
    ++counts->lookups;
    if (cache->lookup(position + frame, side, irradiance, depth)) return true;
    ++counts->misses;
    return false;
  }

  float footprint(float distance) const { return spread * distance; }

  const IrradianceCache* cache;
  Vec3 frame;
  float near_m;
  int near_hits;
  float spread;
  scene::TexelDensities* texels;
  Counts* counts;
};

/// Aims the first rays of paths at the bright places of the cache.
struct AimedDirections {
  /// Direct light is sampled elsewhere, against rays by the cosine.
  static constexpr bool kWeighsAsCosine = true;

  int32_t vertex(int depth, int32_t path, const Vec3&, const Vec3&) const {
    if (depth > 0 || aims->empty()) return scene::kNone;
    const size_t point = point_of_path[path];
    return (*aims)[point].share() > 0 ? static_cast<int32_t>(point) : scene::kNone;
  }
  Vec3 sample(int32_t point, const Vec3& normal, const Vec2& u) const {
    return (*aims)[static_cast<size_t>(point)].sample(normal, u);
  }
  float pdf(int32_t point, float cosine, const Vec3& direction) const {
    return (*aims)[static_cast<size_t>(point)].pdf(cosine, direction);
  }

  const std::vector<Aim>* aims;  ///< of points; empty: all rays by the cosine
  const size_t* point_of_path;
};

/// Gathers for points in blocks of paths that hold several points or a part of one.
class Gatherer : public pathtrace::LightSink {
 public:
  Gatherer(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights, const IrradianceCache& cache,
           const GatherOptions& options)
      : options_(options),
        bright_(cache.bright_places()),
        frame_(bvh.handles().origin),
        half_extent_(0.5f * max_component(bvh.bounds().extent())),
        sampler_(pathtrace::Sampling::Sobol,
                 options.numbers.empty() ? kStratified * options.rays : kLongSet,
                 options.numbers.empty() ? 0 : pathtrace::kTileDimensions),
        transport_(
            bvh, lights, options.max_depth, kRouletteDepth, *this,
            CacheReader{&cache, frame_, options.near * cache.radius(), options.near_hits,
                        spread_of(cache, options.rays * options.together), &texels_, &counts_},
            AimedDirections{&aims_, point_.data()}) {}

  /// @param geometric     may be empty
  /// @param numbers       GatherOptions::numbers of these points
  /// @param first_stream  the number of the first point
  void gather(std::span<const Vec3> positions, std::span<const Vec3> normals,
              std::span<const Vec3> geometric, std::span<const pathtrace::SampleNumber> numbers,
              int64_t first_stream, std::span<Rgb> out, std::span<Rgb> met, std::span<Rgb> last) {
    sums_.assign(positions.size(), {});
    met_.assign(positions.size(), {});
    last_.assign(options_.last ? positions.size() : 0, {});
    aims_.clear();
    for (size_t i = 0; !bright_.empty() && i < positions.size(); ++i) {
      const bool first =
          i == 0 ||
          (static_cast<size_t>(first_stream) + i) % static_cast<size_t>(options_.together) == 0;
      if (first) {
        aims_.push_back(bright_.aim(positions[i], normals[i]));
      } else {
        aims_.push_back(Aim(aims_.back()));
      }
    }
    for (size_t i = 0; i < positions.size(); ++i) {
      // The offset follows the world coordinates, as that of irradiance does.
      const Vec3& side = geometric.empty() ? normals[i] : geometric[i];
      const Vec3 origin = pathtrace::offset_origin(positions[i], side, half_extent_) - frame_;
      if (numbers.empty()) {
        start_point(static_cast<uint64_t>(first_stream) + i, i == 0);
      } else if (i == 0 || numbers[i].set != numbers[i - 1].set) {
        sampler_.start_stream(numbers[i].set, 0);
        sampler_.start_set();
      }
      for (int k = 0; k < options_.rays; ++k) {
        if (sampler_.paths() == kBlock) flush();
        const int lane = sampler_.paths();
        if (!numbers.empty()) {
          sampler_.go_to(pathtrace::tile_index(numbers[i].number + static_cast<uint32_t>(k),
                                               numbers[i].place));
        }
        transport_.start().origin.put(lane, origin);
        transport_.start().normal.put(lane, normals[i]);
        if (!geometric.empty()) geometric_.push_back(side);
        point_[static_cast<size_t>(lane)] = i;
        sampler_.add_path();
      }
    }
    flush();
    const double scale = double{kPi} / options_.rays;
    for (size_t i = 0; i < out.size(); ++i) {
      out[i] = scaled(sums_[i], scale);
      met[i] = scaled(met_[i], scale);
    }
    for (size_t i = 0; i < last.size(); ++i) last[i] = scaled(last_[i], scale);
  }

  void add(int depth, std::span<const pathtrace::Contribution> contributions) override {
    for (const pathtrace::Contribution& c : contributions) {
      // What an emitter sends out by itself to the point is direct light there. What it or another
      // surface reflects comes from the cache.
      std::vector<Sum>& kind = depth == 1 && c.light_group != scene::kNone ? met_ : sums_;
      const size_t point = point_[static_cast<size_t>(c.path)];
      add_to(&kind[point], c.value);
      if (options_.last && depth == options_.max_depth && c.light_group != scene::kNone)
        add_to(&last_[point], c.value);
    }
  }

  int64_t rays_traced() const { return transport_.rays_traced(); }
  const Counts& counts() const { return counts_; }

 private:
  using Sum = std::array<double, 3>;

  static void add_to(Sum* sum, const Rgb& value) {
    (*sum)[0] += double{value.x};
    (*sum)[1] += double{value.y};
    (*sum)[2] += double{value.z};
  }
  static Rgb scaled(const Sum& sum, double scale) {
    return {static_cast<float>(sum[0] * scale), static_cast<float>(sum[1] * scale),
            static_cast<float>(sum[2] * scale)};
  }

  /// Points are numbered through all calls: any of them may be the first of its set here.
  void start_point(uint64_t number, bool first) {
    const auto place = static_cast<uint32_t>(number % kStratified);
    if (place != 0 && !first) return;
    sampler_.start_stream(options_.seed, number / kStratified);
    sampler_.start_set();
    sampler_.skip_paths(place * static_cast<uint32_t>(options_.rays));
  }

  void flush() {
    transport_.trace_indirect(sampler_, geometric_);
    geometric_.clear();
    sampler_.clear();
  }

  const GatherOptions& options_;
  const BrightPlaces& bright_;
  const Vec3 frame_;
  const float half_extent_;
  Counts counts_;
  scene::TexelDensities texels_;
  pathtrace::PathSampler sampler_;
  std::vector<Aim> aims_;  ///< [points], or empty
  pathtrace::BasicTransport<CacheReader, AimedDirections> transport_;
  std::array<size_t, kBlock> point_;
  std::vector<Vec3> geometric_;  ///< normals of the paths' surfaces; empty as they are given
  std::vector<Sum> sums_, met_, last_;
};

}  // namespace

Gathered gather_irradiance(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                           const IrradianceCache& cache, std::span<const Vec3> positions,
                           std::span<const Vec3> normals, const GatherOptions& options,
                           int64_t first_index, std::span<const Vec3> geometric_normals) {
  LTE_CHECK(&bvh.scene() == &lights.scene(), "the BVH and the lights are of two scenes");
  LTE_CHECK(options.rays >= 1 && options.rays <= kMaxRays, "gather: rays must be 1 to ", kMaxRays,
            ", got ", options.rays);
  LTE_CHECK(options.max_depth >= 2, "gather: max_depth must be at least 2, got ",
            options.max_depth);
  LTE_CHECK(options.near >= 0, "gather: near must not be negative, got ", options.near);
  LTE_CHECK(options.numbers.empty() || options.numbers.size() == positions.size(),
            "gather: ", options.numbers.size(), " numbers of ", positions.size(), " points");
  pathtrace::check_points(positions, normals);
  if (!geometric_normals.empty()) pathtrace::check_points(positions, geometric_normals);
  Gathered out;
  out.indirect.resize(positions.size());
  out.met.resize(positions.size());
  out.last.resize(options.last ? positions.size() : 0);
  if (lights.empty()) return out;
  std::atomic<int64_t> rays_traced{0}, lookups{0}, misses{0};
  // Whole blocks of paths, where points have few rays.
  const int64_t grain = std::max<int64_t>(kGrain, kBlock / options.rays);
  parallel_for(static_cast<int64_t>(positions.size()), grain, [&](int64_t begin, int64_t end) {
    const auto gatherer = std::make_unique<Gatherer>(bvh, lights, cache, options);
    const auto first = static_cast<size_t>(begin), count = static_cast<size_t>(end - begin);
    const auto geometric =
        geometric_normals.empty() ? geometric_normals : geometric_normals.subspan(first, count);
    const auto numbers =
        options.numbers.empty() ? options.numbers : options.numbers.subspan(first, count);
    gatherer->gather(positions.subspan(first, count), normals.subspan(first, count), geometric,
                     numbers, first_index + begin, std::span(out.indirect).subspan(first, count),
                     std::span(out.met).subspan(first, count),
                     options.last ? std::span(out.last).subspan(first, count) : std::span<Rgb>());
    rays_traced += gatherer->rays_traced();
    lookups += gatherer->counts().lookups;
    misses += gatherer->counts().misses;
  });
  out.rays_traced = rays_traced;
  out.lookups = lookups;
  out.misses = misses;
  return out;
}

}  // namespace lte::gi
