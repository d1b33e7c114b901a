// Internal: the light transport that irradiance and images share. A path is a random walk over
// diffuse and metallic surfaces with next-event estimation at each vertex; both ways of meeting a
// light are weighted by the balance heuristic.
//
// Paths advance in blocks (path_block.h): at each depth all nearest hits, then shading, then all
// light samples and their shadow rays, then the next directions. A query point is treated as a
// white diffuse vertex whose reflected radiance is E / π, so irradiance needs no code of its own.
// Diffuse vertices (materials/lambert.h) are weighed and sampled as a block. Metallic ones
// (materials/glossy_bsdf.h) are the exception among the lanes and go one by one; they draw the same
// numbers as diffuse ones.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/blocks/path_block.h"
#include "lte/pathtrace/blocks/path_sampler.h"
#include "lte/pathtrace/embree_scene.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/pathtrace/materials/glossy_bsdf.h"
#include "lte/pathtrace/transport/direction_sampler.h"

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

/// What BasicTransport tells of its rays before it traces them: nothing. Others have the same
/// functions, and cost nothing where they are empty.
///
/// An observer may also end paths, by a function `bool known_irradiance(int depth, float distance,
/// const Vec3& position, const Vec3& side, Rgb* irradiance)`. It is asked at every diffuse hit,
/// `distance` from where the ray began, for the irradiance on this side of it. Where it knows it,
/// the path ends there and brings that light, in light group kNone.
///
/// It may see what rays have met, by a function `void met(int depth, const PathBlock&, const
/// HitBlock&)`, before paths move on; not where they end without a look at it, at the last depth.
///
/// It may end paths unasked, by a function `bool wanted(int32_t path) const`, which is asked before
/// each of their rays.
///
/// And it may say, by a function `float footprint(float distance) const`, how many metres a ray of
/// that length stands for, over which textures are filtered; without, paths read them unfiltered. A
/// member `scene::TexelDensities* texels` beside it saves working out how dense they are each time.
struct NoObserver {
  void nearest(int /*depth*/, const PathBlock&) {}
  void shadow(const ShadowBlock&) {}
};

/// One for each thread; large, so not for the stack. Defined in transport_impl.h, which only the
/// files that bring an observer of their own include.
template <typename Observer, DirectionSampler Directions = CosineDirections>
class BasicTransport {
 public:
  BasicTransport(const Bvh& bvh, const Lights& lights, int max_depth, int roulette_depth,
                 LightSink& sink, Observer observer = {}, const Directions& directions = {});

  /// Rays from here on go to this one.
  void observe(const Observer& observer) { observer_ = observer; }

  int64_t rays_traced() const { return rays_traced_; }

  /// Traces the paths of the sampler's block from one diffuse surface point.
  /// @param position  relative to the frame origin, already off the surface
  void trace_from_surface(const Vec3& position, const Vec3& normal, PathSampler& sampler);

  /// The same from as many points as there are paths, whose origin and normal the caller has put
  /// into the lanes of `start()`.
  void trace_from_surfaces(PathSampler& sampler);

  /// The same, but no light is sampled at these points themselves: contributions of depth 1 are not
  /// whole.
  /// @param geometric  normals of the surfaces, a path each, where those of `start()` are shading
  ///                   normals; empty where they are the same
  void trace_indirect(PathSampler& sampler, std::span<const Vec3> geometric = {});

  /// Traces the paths of the sampler's block along rays that the caller has put into its lanes of
  /// `start()`: origin relative to the frame origin, and unit direction.
  void trace_from_camera(PathSampler& sampler);
  PathBlock& start() { return paths_; }

 private:
  void start_at_surfaces(const PathSampler& sampler);
  void follow(PathSampler& sampler);
  void end_unwanted();
  bool end_where_known(int lane, int depth, const SurfacePoint& point, const Vec3& side,
                       const Rgb& throughput);
  float footprint(float distance) const;
  bool leaves_below(int lane, const Vec3& direction) const {
    const int32_t at = geometric_of_[lane];
    return at != scene::kNone && !(dot(geometric_[static_cast<size_t>(at)], direction) > 0);
  }
  void shade(int depth);
  void collect_emission(int depth);
  void add_emission(int lane, const Rgb& emission, float cos_front);
  void add_environment(int lane);
  void sample_lights(int vertex, PathSampler& sampler);
  void weigh_metal();
  void drop_light_from_below();
  void cast_shadows(int depth);
  void russian_roulette(int vertex, PathSampler& sampler);
  void scatter(int vertex, PathSampler& sampler);
  void scatter_one_by_one();
  void move_lane(int from, int to);
  void deliver(int depth);

  const Bvh::Handles& handles_;
  const scene::Scene& scene_;
  const Lights& lights_;
  const int max_depth_, roulette_depth_;
  LightSink& sink_;
  [[no_unique_address]] Observer observer_;
  int64_t rays_traced_ = 0;

  PathBlock paths_;
  std::vector<GlossyBsdf> metal_;         ///< metallic vertices where paths stand
  alignas(64) int32_t metal_of_[kBlock];  ///< lane's index into metal_, kNone if it is diffuse
  /// Geometric normals where paths stand on surfaces with a normal map: nothing arrives from below
  /// those, whatever the shading normal, and nothing leaves there.
  std::vector<Vec3> geometric_;
  alignas(64) int32_t geometric_of_[kBlock];  ///< lane's index into geometric_, or kNone
  [[no_unique_address]] SampledLanes<Directions> sampled_;
  HitBlock hits_;
  LightBlock light_samples_;
  ShadowBlock shadows_;
  LightNumbers light_numbers_;
  DirectionNumbers direction_numbers_;
  alignas(64) uint32_t roulette_numbers_[kBlock];
  alignas(64) int32_t flags_[kBlock];
  alignas(64) float light_weight_[kBlock];
  int contribution_count_ = 0;
  Contribution contributions_[2 * kBlock];  ///< a hit may emit, and end its path
};

using Transport = BasicTransport<NoObserver>;
extern template class BasicTransport<NoObserver>;

}  // namespace lte::pathtrace
