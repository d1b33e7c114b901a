#include "experiments/gathered_base/ray_gather.h"

#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "lte/base/parallel.h"
#include "lte/pathtrace/blocks/ray_packets.h"
#include "lte/pathtrace/embree_scene.h"
#include "lte/pathtrace/transport/irradiance_kernel.h"
#include "lte/pathtrace/transport/transport_impl.h"
#include "lte/scene/texel_densities.h"

namespace lte::experiments {
namespace {

using pathtrace::kBlock;

// Those of lte/gi/gather.cpp.
constexpr int kRouletteDepth = 3;
constexpr float kFiltered = 0.25f;
constexpr size_t kStratified = 64;

constexpr int64_t kGrain = 64;  // points

/// Ends paths where the cache knows the light, and measures first rays.
struct Observer {
  void nearest(int depth, const pathtrace::PathBlock& paths) {
    if (depth != 1) return;
    pathtrace::intersect(handles->top, handles->packet_width, paths.origin, paths.direction,
                         paths.size, hits);
    for (int lane = 0; lane < paths.size; ++lane) {
      const bool met = hits->instance[lane] != scene::kNone;
      distance[slot_of_path[paths.path[lane]]] =
          met ? hits->t[lane] : std::numeric_limits<float>::infinity();
    }
  }
  void shadow(const pathtrace::ShadowBlock&) {}
  bool known_irradiance(int depth, float ray, const Vec3& position, const Vec3& side,
                        Rgb* irradiance) const {
    if (depth == 1 && ray < near_m) return false;
    return cache->lookup(position + frame, side, irradiance);
  }
  float footprint(float ray) const { return spread * ray; }

  const pathtrace::Bvh::Handles* handles;
  pathtrace::HitBlock* hits;
  const size_t* slot_of_path;
  float* distance;
  const gi::IrradianceCache* cache;
  Vec3 frame;
  float near_m, spread;
  scene::TexelDensities* texels;
};

class RayGatherer : public pathtrace::LightSink {
 public:
  RayGatherer(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
              const gi::IrradianceCache& cache, const gi::GatherOptions& options, RayGather* out)
      : options_(options),
        out_(*out),
        frame_(bvh.handles().origin),
        half_extent_(0.5f * max_component(bvh.bounds().extent())),
        sampler_(pathtrace::Sampling::Sobol, static_cast<int>(kStratified) * options.rays),
        transport_(bvh, lights, options.max_depth, kRouletteDepth, *this,
                   Observer{&bvh.handles(), &hits_, slot_of_path_.data(), out->distance.data(),
                            &cache, frame_, options.near * cache.radius(),
                            kFiltered * std::sqrt(2 * kPi / static_cast<float>(options.rays)),
                            &texels_}) {}

  void gather(int64_t begin, int64_t end, std::span<const Vec3> positions,
              std::span<const Vec3> normals) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      const Vec3 origin = pathtrace::offset_origin(positions[i], normals[i], half_extent_) - frame_;
      if (const size_t place = i % kStratified; place == 0 || i == static_cast<size_t>(begin)) {
        sampler_.start_stream(options_.seed, i / kStratified);
        sampler_.start_set();
        sampler_.skip_paths(static_cast<uint32_t>(place) * static_cast<uint32_t>(options_.rays));
      }
      for (int k = 0; k < options_.rays; ++k) {
        if (sampler_.paths() == kBlock) flush();
        const int lane = sampler_.paths();
        transport_.start().origin.put(lane, origin);
        transport_.start().normal.put(lane, normals[i]);
        slot_of_path_[static_cast<size_t>(lane)] =
            i * static_cast<size_t>(options_.rays) + static_cast<size_t>(k);
        sampler_.add_path();
      }
    }
    flush();
  }

  void add(int depth, std::span<const pathtrace::Contribution> contributions) override {
    for (const pathtrace::Contribution& c : contributions) {
      if (depth == 1 && c.light_group != scene::kNone) continue;  // direct light at the point
      out_.value[slot_of_path_[static_cast<size_t>(c.path)]] += c.value * kPi;
    }
  }

 private:
  void flush() {
    transport_.trace_indirect(sampler_);
    sampler_.clear();
  }

  const gi::GatherOptions& options_;
  RayGather& out_;
  const Vec3 frame_;
  const float half_extent_;
  scene::TexelDensities texels_;
  pathtrace::HitBlock hits_;
  std::array<size_t, kBlock> slot_of_path_{};
  pathtrace::PathSampler sampler_;
  pathtrace::BasicTransport<Observer> transport_;
};

}  // namespace

RayGather gather_rays(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                      const gi::IrradianceCache& cache, std::span<const Vec3> positions,
                      std::span<const Vec3> normals, const gi::GatherOptions& options) {
  pathtrace::check_points(positions, normals);
  RayGather out;
  out.value.resize(positions.size() * static_cast<size_t>(options.rays));
  out.distance.resize(out.value.size(), std::numeric_limits<float>::infinity());
  if (lights.empty()) return out;
  parallel_for(static_cast<int64_t>(positions.size()), kGrain, [&](int64_t begin, int64_t end) {
    std::make_unique<RayGatherer>(bvh, lights, cache, options, &out)
        ->gather(begin, end, positions, normals);
  });
  return out;
}

}  // namespace lte::experiments
