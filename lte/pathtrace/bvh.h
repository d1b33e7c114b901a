// The Embree BVH of a scene: one geometry a mesh, one Embree instance a placement.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "lte/base/math.h"
#include "lte/scene/scene.h"

namespace lte::pathtrace {

struct Ray {
  Vec3 origin;
  Vec3 direction;  ///< any length; t counts in its units
  float t_min = 0, t_max = INFINITY;
};

struct Hit {
  float t = INFINITY;
  int instance = scene::kNone;  ///< kNone for a miss
  uint32_t triangle = 0;
  float u = 0, v = 0;
  Vec3 normal;  ///< world, unit, geometric, front side (mirroring transforms accounted for)

  bool valid() const { return instance != scene::kNone; }
};

/// Keeps a reference to the scene, which must outlive it. Queries are const and thread-safe.
class Bvh {
 public:
  /// @throws lte::Error if Embree fails (out of memory), or the scene is too large for it
  ///         (scene/number_check.h).
  explicit Bvh(const scene::Scene& scene);
  /// A tree that others may be built on: its meshes' trees borrow nothing of the scene, for 12
  /// bytes a triangle.
  static std::unique_ptr<Bvh> with_own_meshes(const scene::Scene& scene);
  /// The tree of a scene made of meshes that `trees` has: those are shared, and only the tree over
  /// the instances is built. Either may be destroyed first.
  /// @param trees         made by with_own_meshes()
  /// @param tree_of_mesh  for each mesh of `scene` the mesh of trees.scene() of the same positions
  ///                      and triangles
  /// @throws lte::Error as Bvh(), and if sizes differ
  Bvh(const scene::Scene& scene, const Bvh& trees, std::span<const int> tree_of_mesh);
  ~Bvh();
  Bvh(const Bvh&) = delete;
  Bvh& operator=(const Bvh&) = delete;

  Hit intersect(const Ray& ray) const;
  bool occluded(const Ray& ray) const;

  const scene::Scene& scene() const { return scene_; }
  const Bounds& bounds() const { return bounds_; }

  /// What the transport of this folder reads directly: Embree's scene and a record an instance
  /// (embree_scene.h).
  struct Handles;
  const Handles& handles() const { return *handles_; }

 private:
  enum class Indices { Borrowed, Own };
  Bvh(const scene::Scene& scene, Indices indices);
  void start();
  void attach_all(Indices indices);

  const scene::Scene& scene_;
  Bounds bounds_;
  std::unique_ptr<Handles> handles_;
};

/// Where ray tracing puts its origin: zero for scenes around theirs; the centre of the bounds for
/// scenes so far off that float coordinates are coarse, whose paths are then as exact as anywhere.
Vec3 frame_origin(const Bounds& bounds);

}  // namespace lte::pathtrace
