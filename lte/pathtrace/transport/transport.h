// Internal: the light transport that irradiance and images share. A path is a random walk over
// diffuse and metallic surfaces with next-event estimation at each vertex; both ways of meeting a
// light are weighted by the balance heuristic.
//
// Paths advance in blocks (path_block.h): at each depth all nearest hits, then shading, then all
// light samples and their shadow rays, then the next directions. A query point is treated as a
// white diffuse vertex whose reflected radiance is E / π, so irradiance needs no code of its own.
// Metallic vertices (bsdf.h) are the exception among the lanes and go one by one. They draw the
// same numbers as diffuse ones.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/embree_scene.h"
#include "lte/pathtrace/lights.h"
#include "lte/pathtrace/materials/bsdf.h"
#include "lte/pathtrace/transport/path_block.h"
#include "lte/pathtrace/transport/path_sampler.h"

namespace lte::pathtrace {

/// Light that a path brings to its start.
struct Contribution {
  Rgb value;
  int32_t light_group;
  int32_t path;  ///< number in the block
};

/// Where contributions go.
class LightSink {
 public:
  virtual ~LightSink() = default;
  /// @param depth  surface hits after the query point or the camera, the light's included
  virtual void add(int depth, std::span<const Contribution> contributions) = 0;
};

/// Sees every ray.
class RayRecorder {
 public:
  virtual ~RayRecorder() = default;
  virtual void nearest(int depth, const PathBlock& rays) = 0;
  virtual void shadow(const ShadowBlock& rays) = 0;
};

/// One for each thread; large, so not for the stack.
class Transport {
 public:
  Transport(const Bvh& bvh, const Lights& lights, int max_depth, int roulette_depth,
            LightSink& sink);

  /// Rays from here on go to `recorder` too; null for none.
  void record(RayRecorder* recorder) { recorder_ = recorder; }

  int64_t rays_traced() const { return rays_traced_; }

  /// Traces the paths of the sampler's block from one diffuse surface point.
  /// @param position  relative to the frame origin, already off the surface
  void trace_from_surface(const Vec3& position, const Vec3& normal, PathSampler& sampler);

  /// Traces the paths of the sampler's block along rays that the caller has put into its lanes of
  /// `start()`: origin relative to the frame origin, and unit direction.
  void trace_from_camera(PathSampler& sampler);
  PathBlock& start() { return paths_; }

 private:
  void follow(PathSampler& sampler);
  void shade(int depth);
  void collect_emission(int depth);
  void add_emission(int lane, const Rgb& emission, float cos_front);
  void add_environment(int lane);
  void sample_lights(int vertex, PathSampler& sampler);
  void weigh_metal();
  void cast_shadows(int depth);
  void play(int vertex, PathSampler& sampler);
  void scatter(int vertex, PathSampler& sampler);
  void scatter_metal();
  void move_lane(int from, int to);
  void deliver(int depth);

  const Bvh::Handles& handles_;
  const scene::Scene& scene_;
  const Lights& lights_;
  const int max_depth_, roulette_depth_;
  LightSink& sink_;
  RayRecorder* recorder_ = nullptr;
  int64_t rays_traced_ = 0;

  PathBlock paths_;
  std::vector<GlossyBsdf> metal_;         ///< metallic vertices where paths stand
  alignas(64) int32_t metal_of_[kBlock];  ///< lane's index into metal_, kNone if it is diffuse
  HitBlock hits_;
  LightBlock light_samples_;
  ShadowBlock shadows_;
  LightNumbers light_numbers_;
  DirectionNumbers direction_numbers_;
  alignas(64) uint32_t roulette_numbers_[kBlock];
  alignas(64) int32_t flags_[kBlock];
  alignas(64) float light_weight_[kBlock];
  int contribution_count_ = 0;
  Contribution contributions_[kBlock];
};

}  // namespace lte::pathtrace
