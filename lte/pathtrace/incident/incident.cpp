#include "lte/pathtrace/incident/incident.h"

#include <algorithm>
#include <atomic>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/incident/guide.h"
#include "lte/pathtrace/incident/hemisphere_bins.h"
#include "lte/pathtrace/materials/glossy_bsdf.h"
#include "lte/pathtrace/materials/lambert.h"
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

/// Unit axes around a normal, and directions from them.
class Frame {
 public:
  explicit Frame(const Vec3& normal)
      : normal_(normal), tangent_(bin_tangent(normal)), bitangent_(cross(normal, tangent_)) {}
  Vec3 to_world(const Vec3& v) const { return tangent_ * v.x + bitangent_ * v.y + normal_ * v.z; }

 private:
  Vec3 normal_, tangent_, bitangent_;
};

/// Adds up what paths bring, by group and slot.
class SlotSums : public LightSink {
 public:
  struct Sum {
    double x = 0, y = 0, z = 0;
  };

  SlotSums(int64_t groups, int64_t slots)
      : slots_(static_cast<size_t>(slots)),
        direct_(static_cast<size_t>(groups) * slots_),
        indirect_(direct_.size()) {}

  void clear() {
    std::fill(direct_.begin(), direct_.end(), Sum{});
    std::fill(indirect_.begin(), indirect_.end(), Sum{});
  }
  /// Sets the slot of a path of the block that is traced next.
  void assign(int path, int64_t slot) {
    slot_of_path_[static_cast<size_t>(path)] = static_cast<size_t>(slot);
  }
  void add(int depth, std::span<const Contribution> contributions) override {
    std::vector<Sum>& sums = depth == 1 ? direct_ : indirect_;
    for (const Contribution& c : contributions) {
      Sum& sum = sums[static_cast<size_t>(c.light_group) * slots_ +
                      slot_of_path_[static_cast<size_t>(c.path)]];
      sum.x += c.value.x;
      sum.y += c.value.y;
      sum.z += c.value.z;
    }
  }
  /// Writes the means over `count` paths of all slots of a group.
  void store(int64_t group, int count, Rgb* direct, Rgb* indirect) const {
    const size_t first = static_cast<size_t>(group) * slots_;
    const auto mean = [count](const Sum& s) {
      return Rgb{static_cast<float>(s.x / count), static_cast<float>(s.y / count),
                 static_cast<float>(s.z / count)};
    };
    std::transform(direct_.begin() + first, direct_.begin() + first + slots_, direct, mean);
    std::transform(indirect_.begin() + first, indirect_.begin() + first + slots_, indirect, mean);
  }

 private:
  size_t slots_;
  std::vector<Sum> direct_, indirect_;
  std::array<size_t, kBlock> slot_of_path_{};
};

/// Traces all cells of one point.
/// @param origin  in the frame of the BVH, already off the surface
void trace_cells(Transport& transport, const Vec3& origin, const Vec3& normal,
                 const IncidentOptions& options, PathSampler& sampler, SlotSums& sums) {
  const Frame frame(normal);
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

Vec3 off_surface(const Bvh& bvh, const Vec3& position, const Vec3& normal) {
  const float half_extent = 0.5f * max_component(bvh.bounds().extent());
  return offset_origin(position, normal, half_extent) - bvh.handles().origin;
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

struct IncidentSampler::State {
  State(const Bvh& the_bvh, const Lights& lights, int max_depth, int roulette_depth)
      : bvh(the_bvh),
        groups(lights.groups()),
        lit(!lights.empty()),
        block_sums(groups, kBlock),
        sampler(Sampling::Sobol, kBlock),
        transport(the_bvh, lights, max_depth, roulette_depth, block_sums) {}

  /// `scatter` makes a ScatteringSample of a point of the unit square.
  template <typename Scatter>
  const IncidentSamples& draw(const Vec3& position, const Vec3& normal, int64_t count, Rng& rng,
                              const Scatter& scatter) {
    LTE_CHECK(count >= 0, "count must not be negative, got ", count);
    check_points({&position, 1}, {&normal, 1});
    out.groups = groups;
    out.count = count;
    const auto total = static_cast<size_t>(count);
    out.direction.assign(total, {});
    out.pdf.assign(total, 0);
    out.direct.assign(static_cast<size_t>(groups) * total, {});
    out.indirect.assign(out.direct.size(), {});
    const Vec3 origin = off_surface(bvh, position, normal);
    sampler.start_stream(rng.next_u64(), 0);
    for (int64_t first = 0; first < count; first += kBlock)
      trace_block(origin, normal, first, static_cast<int>(std::min<int64_t>(kBlock, count - first)),
                  scatter);
    return out;
  }

  template <typename Scatter>
  void trace_block(const Vec3& origin, const Vec3& normal, int64_t first, int size,
                   const Scatter& scatter) {
    std::array<int32_t, kBlock> paths;
    sampler.start_set();
    for (int i = 0; i < size; ++i) {
      paths[static_cast<size_t>(i)] = i;
      block_sums.assign(i, i);
      sampler.add_path();
    }
    sampler.direction(0, paths.data(), size, &numbers);
    for (int i = 0; i < size; ++i) {
      const ScatteringSample sample = scatter(Vec2{to_unit(numbers.x[i]), to_unit(numbers.y[i])});
      const auto at = static_cast<size_t>(first + i);
      out.direction[at] = sample.direction;
      out.pdf[at] = sample.pdf;
      transport.start().origin.put(i, origin);
      transport.start().direction.put(i, sample.pdf > 0 ? sample.direction : normal);
    }
    block_sums.clear();
    if (lit) transport.trace_from_camera(sampler);
    sampler.clear();
    for (int64_t g = 0; g < groups; ++g) {
      block_sums.store(g, 1, block_direct.data(), block_indirect.data());
      for (int i = 0; i < size; ++i) {
        const auto from = static_cast<size_t>(i),
                   to = static_cast<size_t>(g * out.count + first + i);
        if (!(out.pdf[static_cast<size_t>(first + i)] > 0)) continue;
        out.direct[to] = block_direct[from];
        out.indirect[to] = block_indirect[from];
      }
    }
  }

  const Bvh& bvh;
  const int groups;
  const bool lit;
  SlotSums block_sums;
  PathSampler sampler;
  Transport transport;
  DirectionNumbers numbers;
  std::array<Rgb, kBlock> block_direct, block_indirect;
  IncidentSamples out;
};

IncidentSampler::IncidentSampler(const Bvh& bvh, const Lights& lights, int max_depth,
                                 int roulette_depth) {
  LTE_CHECK(&bvh.scene() == &lights.scene(), "the BVH and the lights are of two scenes");
  IrradianceOptions shared;
  shared.max_depth = max_depth;
  shared.roulette_depth = roulette_depth;
  check_irradiance_options(shared);
  state_ = std::make_unique<State>(bvh, lights, max_depth, roulette_depth);
}

IncidentSampler::~IncidentSampler() = default;

const IncidentSamples& IncidentSampler::draw(const Vec3& position, const Vec3& normal,
                                             int64_t count, Rng& rng) {
  return state_->draw(position, normal, count, rng, [&normal](const Vec2& u) {
    ScatteringSample out;
    out.direction = sample_lambert(normal, u, &out.pdf);
    return out;
  });
}

const IncidentSamples& IncidentSampler::draw(const Vec3& position, const Vec3& normal,
                                             const Reflector& reflector, int64_t count, Rng& rng) {
  LTE_CHECK(reflector.gloss.metallic > 0 && reflector.gloss.metallic <= 1,
            "a reflector's metallic must lie in (0, 1], got ", reflector.gloss.metallic);
  LTE_CHECK(dot(normal, reflector.outgoing) > 0,
            "a reflector's outgoing direction must be on the side of the normal");
  const GlossyBsdf bsdf(reflector.color, reflector.gloss.metallic, reflector.gloss.roughness,
                        normal, reflector.outgoing);
  return state_->draw(position, normal, count, rng,
                      [&bsdf](const Vec2& u) { return bsdf.sample(u); });
}

const IncidentSamples& IncidentSampler::draw(const Vec3& position, const Vec3& normal,
                                             const Guide& guide, int64_t count, Rng& rng) {
  return state_->draw(position, normal, count, rng, [&guide](const Vec2& u) {
    const Guide::Draw drawn = guide.draw(u);
    return ScatteringSample{drawn.direction, drawn.weight, drawn.pdf};
  });
}

}  // namespace lte::pathtrace
