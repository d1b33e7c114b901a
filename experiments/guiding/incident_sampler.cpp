#include "experiments/guiding/incident_sampler.h"

#include <algorithm>
#include <array>
#include <functional>

#include "experiments/guiding/guide.h"
#include "experiments/guiding/guide_field.h"
#include "lte/base/check.h"
#include "lte/pathtrace/incident/slot_sums.h"
#include "lte/pathtrace/materials/glossy_bsdf.h"
#include "lte/pathtrace/materials/lambert.h"
#include "lte/pathtrace/transport/irradiance_kernel.h"
#include "lte/pathtrace/transport/transport_impl.h"

namespace lte::experiments {

using namespace pathtrace;

/// Makes a direction of a point of the unit square.
using Scatter = std::function<ScatteringSample(const Vec2&)>;

class IncidentSampler::State {
 public:
  virtual ~State() = default;
  virtual const IncidentSamples& draw(const Vec3& position, const Vec3& normal, int64_t count,
                                      Rng& rng, const Scatter& scatter) = 0;
};

namespace {

/// Directions by a field of guides at the first hits of a path.
class FieldDirections {
 public:
  FieldDirections(const Bvh& bvh, const GuideField& field)
      : origin_(bvh.handles().origin), field_(&field) {}

  int32_t vertex(int depth, int32_t, const Vec3& position, const Vec3& side) const {
    return depth > 0 && depth <= field_->hits() ? field_->at(position + origin_, side)
                                                : scene::kNone;
  }
  Vec3 sample(int32_t place, const Vec3& normal, const Vec2& u) const {
    return field_->direction(place, normal, u);
  }
  float pdf(int32_t place, float cosine, const Vec3& direction) const {
    return field_->pdf(place, cosine, direction);
  }

 private:
  Vec3 origin_;
  const GuideField* field_;
};

template <DirectionSampler Directions>
class Tracer : public IncidentSampler::State {
 public:
  Tracer(const Bvh& bvh, const Lights& lights, int max_depth, int roulette_depth,
         const Directions& directions)
      : bvh_(bvh),
        groups_(lights.groups()),
        lit_(!lights.empty()),
        block_sums_(groups_, kBlock),
        sampler_(Sampling::Sobol, kBlock),
        transport_(bvh, lights, max_depth, roulette_depth, block_sums_, NoObserver(), directions) {}

  const IncidentSamples& draw(const Vec3& position, const Vec3& normal, int64_t count, Rng& rng,
                              const Scatter& scatter) override {
    LTE_CHECK(count >= 0, "count must not be negative, got ", count);
    check_points({&position, 1}, {&normal, 1});
    out_.groups = groups_;
    out_.count = count;
    const auto total = static_cast<size_t>(count);
    out_.direction.assign(total, {});
    out_.pdf.assign(total, 0);
    out_.direct.assign(static_cast<size_t>(groups_) * total, {});
    out_.indirect.assign(out_.direct.size(), {});
    const Vec3 origin = off_surface(bvh_, position, normal);
    sampler_.start_stream(rng.next_u64(), 0);
    for (int64_t first = 0; first < count; first += kBlock)
      trace_block(origin, normal, first, static_cast<int>(std::min<int64_t>(kBlock, count - first)),
                  scatter);
    return out_;
  }

 private:
  void trace_block(const Vec3& origin, const Vec3& normal, int64_t first, int size,
                   const Scatter& scatter) {
    std::array<int32_t, kBlock> paths;
    sampler_.start_set();
    for (int i = 0; i < size; ++i) {
      paths[static_cast<size_t>(i)] = i;
      block_sums_.assign(i, i);
      sampler_.add_path();
    }
    sampler_.direction(0, paths.data(), size, &numbers_);
    for (int i = 0; i < size; ++i) {
      const ScatteringSample sample = scatter(Vec2{to_unit(numbers_.x[i]), to_unit(numbers_.y[i])});
      const auto at = static_cast<size_t>(first + i);
      out_.direction[at] = sample.direction;
      out_.pdf[at] = sample.pdf;
      transport_.start().origin.put(i, origin);
      transport_.start().direction.put(i, sample.pdf > 0 ? sample.direction : normal);
    }
    block_sums_.clear();
    if (lit_) transport_.trace_from_camera(sampler_);
    sampler_.clear();
    for (int64_t g = 0; g < groups_; ++g) {
      block_sums_.store(g, 1, block_direct_.data(), block_indirect_.data());
      for (int i = 0; i < size; ++i) {
        const auto from = static_cast<size_t>(i),
                   to = static_cast<size_t>(g * out_.count + first + i);
        if (!(out_.pdf[static_cast<size_t>(first + i)] > 0)) continue;
        out_.direct[to] = block_direct_[from];
        out_.indirect[to] = block_indirect_[from];
      }
    }
  }

  const Bvh& bvh_;
  const int groups_;
  const bool lit_;
  SlotSums block_sums_;
  PathSampler sampler_;
  BasicTransport<NoObserver, Directions> transport_;
  DirectionNumbers numbers_;
  std::array<Rgb, kBlock> block_direct_, block_indirect_;
  IncidentSamples out_;
};

}  // namespace

IncidentSampler::IncidentSampler(const Bvh& bvh, const Lights& lights, const GuideField* field,
                                 int max_depth, int roulette_depth) {
  LTE_CHECK(&bvh.scene() == &lights.scene(), "the BVH and the lights are of two scenes");
  IrradianceOptions shared;
  shared.max_depth = max_depth;
  shared.roulette_depth = roulette_depth;
  check_irradiance_options(shared);
  if (field == nullptr) {
    state_ = std::make_unique<Tracer<CosineDirections>>(bvh, lights, max_depth, roulette_depth,
                                                        CosineDirections());
  } else {
    state_ = std::make_unique<Tracer<FieldDirections>>(bvh, lights, max_depth, roulette_depth,
                                                       FieldDirections(bvh, *field));
  }
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

}  // namespace lte::experiments
