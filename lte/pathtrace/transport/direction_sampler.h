// Internal: how paths choose their next direction at diffuse vertices, a template argument of
// BasicTransport (transport.h).
#pragma once

#include <concepts>
#include <cstdint>

#include "lte/base/math.h"
#include "lte/pathtrace/balance_heuristic.h"
#include "lte/pathtrace/blocks/path_block.h"
#include "lte/pathtrace/materials/lambert.h"
#include "lte/scene/scene.h"

namespace lte::pathtrace {

/// By the cosine, a block at a time (blocks/path_kernels.h): the library's own choice.
struct CosineDirections {};

/// Another sampler takes some vertices from the cosine:
/// - vertex() numbers a diffuse vertex, or returns kNone to leave it to the cosine; `path` is its
///   number in the block, `position` relative to the frame origin, `side` the unit normal.
/// - sample() draws the next direction there; one below the surface ends the path.
/// - pdf() is the solid-angle density of sample(), positive wherever light may come from.
///
/// Lights that its rays meet are weighed against light samples by that density; with a member
/// kWeighsAsCosine by that of the cosine, which is as right, where light is sampled elsewhere.
template <typename Sampler>
concept DirectionSampler = std::same_as<Sampler, CosineDirections> ||
    requires(const Sampler& sampler, int32_t vertex, const Vec3& vector, const Vec2& u) {
  {
    sampler.vertex(/*depth=*/1, /*path=*/vertex, /*position=*/vector, /*side=*/vector)
    } -> std::same_as<int32_t>;
  { sampler.sample(vertex, /*normal=*/vector, u) } -> std::same_as<Vec3>;
  { sampler.pdf(vertex, /*cosine=*/1.0f, /*direction=*/vector) } -> std::same_as<float>;
};

/// The lanes of a block whose vertices `Sampler` has taken.
template <DirectionSampler Sampler>
class SampledLanes {
 public:
  explicit SampledLanes(const Sampler& sampler) : sampler_(sampler) {}

  void clear() { any_ = false; }
  bool any() const { return any_; }
  bool has(int lane) const { return any_ && vertex_[lane] != scene::kNone; }
  void put(int lane, int depth, int32_t path, const Vec3& position, const Vec3& side) {
    vertex_[lane] = sampler_.vertex(depth, path, position, side);
    any_ |= vertex_[lane] != scene::kNone;
  }
  void leave(int lane) { vertex_[lane] = scene::kNone; }
  void move(int from, int to) { vertex_[to] = vertex_[from]; }

  /// Weighs the light samples of these lanes anew, by the balance heuristic with pdf().
  void weigh(const PathBlock& paths, const LightBlock& lights, float* weight) const {
    for (int lane = 0; lane < paths.size; ++lane) {
      if (!has(lane) || weight[lane] == 0) continue;
      const Vec3 direction = lights.direction.at(lane);
      const float cosine = dot(paths.normal.at(lane), direction);
      const float own = sampler_.pdf(vertex_[lane], cosine, direction);
      weight[lane] = lambert_pdf(cosine) / balance_density(lights.pdf[lane], own);
    }
  }

  /// Draws the direction of a lane that has() one. @return  false if it points below the surface
  bool scatter(int lane, const Vec3& normal, const Vec2& u, Vec3* direction, Rgb* throughput,
               float* pdf) const {
    *direction = sampler_.sample(vertex_[lane], normal, u);
    const float cosine = dot(normal, *direction);
    if (!(cosine > 0)) return false;
    *pdf = sampler_.pdf(vertex_[lane], cosine, *direction);
    *throughput *= lambert_pdf(cosine) / *pdf;
    if constexpr (requires { Sampler::kWeighsAsCosine; }) *pdf = lambert_pdf(cosine);
    return true;
  }

 private:
  Sampler sampler_;
  bool any_ = false;
  alignas(64) int32_t vertex_[kBlock];
};

/// No lane: all of this compiles to nothing.
template <>
class SampledLanes<CosineDirections> {
 public:
  explicit SampledLanes(const CosineDirections&) {}

  void clear() {}
  static constexpr bool any() { return false; }
  static constexpr bool has(int) { return false; }
  void put(int, int, int32_t, const Vec3&, const Vec3&) {}
  void leave(int) {}
  void move(int, int) {}
  void weigh(const PathBlock&, const LightBlock&, float*) const {}
  static bool scatter(int, const Vec3&, const Vec2&, Vec3*, Rgb*, float*) { return true; }
};

}  // namespace lte::pathtrace
