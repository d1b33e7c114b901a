// Integrators: irradiance at points of a scene's surfaces, each by a method of its own.
//
//   gather   rays from a point read light that is kept at records on surfaces     gather.cpp
//   network  the same, over light that a network knows at the records             gather.cpp
//   path     paths that are followed to their end                                 path.cpp
//
// An integrator is made once a scene, prepared once, and then serves pictures of any camera and
// points anywhere.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "lte/base/enum_names.h"
#include "lte/base/math.h"
#include "lte/gi/gather.h"
#include "lte/gi/irradiance_cache.h"
#include "lte/gi/network_light_level.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::render {

enum class Method { Gather, Network, Path };
constexpr EnumNames<Method, 3> enum_names(Method) {
  return {{{Method::Gather, "gather"}, {Method::Network, "network"}, {Method::Path, "path"}}};
}

/// A scene that rays can be traced in. Borrows both.
struct TracedScene {
  const pathtrace::Bvh& bvh;
  const pathtrace::Lights& lights;
};

/// Points on surfaces: world space, unit normals on the side whose irradiance is wanted. [points]
struct SurfacePoints {
  std::span<const Vec3> position, normal;
  /// Where `normal` is for shading: that of the surface, below which nothing arrives. Empty where
  /// they are the same.
  std::span<const Vec3> geometric_normal{};
};

/// How irradiance is sampled at each point.
struct PointSampling {
  int rays = 2;           ///< of indirect light; 0: none is wanted
  int light_samples = 2;  ///< of direct light; 0: none is wanted
  uint64_t seed = 0;
  int64_t first_index = 0;  ///< of the first point's random stream: (seed, first_index + i)
  int near_hits = 1;        ///< gi::GatherOptions::near_hits
  int together = 1;         ///< gi::GatherOptions::together
  /// [points] For rays, and light samples, that go on over several calls. Empty: points draw by
  /// seed and first_index.
  std::span<const pathtrace::SampleNumber> ray_numbers{}, light_numbers{};
};

/// Irradiance in W/m², an entry a point; empty where it is not wanted. Indirect light has been
/// reflected at least once.
struct PointIrradiance {
  std::vector<Rgb> direct, indirect;
};

class Integrator {
 public:
  virtual ~Integrator() = default;

  virtual Method method() const = 0;
  /// Does what all points share. Once, before irradiance().
  virtual void prepare() = 0;
  /// Estimates irradiance at points, in parallel. The result depends neither on the number of
  /// threads nor on how a set is cut into calls.
  /// @throws lte::Error if sizes differ, a value is not finite, or a count is out of range.
  virtual PointIrradiance irradiance(const SurfacePoints& points,
                                     const PointSampling& sampling) const = 0;
};

using gi::IrradianceSource;

/// The irradiance cache that gathered rays read.
struct CacheSettings {
  int64_t records = 4096;  ///< where surfaces are level; more where they are not
  int paths = 16;          ///< of each record
  int max_depth = 5;       ///< surface hits of a path of light after the first point
  uint64_t seed = 0;
};

/// What making and keeping a cache takes, in MiB. @param groups  light groups of the scene
double cache_mb(const CacheSettings& settings, int64_t groups);

/// Fills a cache of the scene.
/// @param source  of indirect light at the records; none: paths trace it
gi::IrradianceCache make_cache(const TracedScene& scene, const CacheSettings& settings,
                               const IrradianceSource& source = {});
/// The same where records and their direct light are known.
gi::IrradianceCache make_cache(const TracedScene& scene, const CacheSettings& settings,
                               const std::shared_ptr<const gi::CacheGeometry>& geometry,
                               const gi::CacheRecords& records, const gi::RecordLight& direct,
                               const IrradianceSource& source);

/// Gather, or network where there is a source. What is borrowed must outlive it.
std::unique_ptr<Integrator> make_gather(const TracedScene& scene, const CacheSettings& settings,
                                        IrradianceSource source = {});
/// The same over a cache that is there, for those who share one; prepare() then does nothing.
/// @param method  Gather or Network
std::unique_ptr<Integrator> make_gather(const TracedScene& scene,
                                        std::shared_ptr<const gi::IrradianceCache> cache,
                                        int max_depth, Method method = Method::Gather);
/// @param max_depth  surface hits of a path after the point
std::unique_ptr<Integrator> make_path(const TracedScene& scene, int max_depth);

}  // namespace lte::render
