// Light sampling: emissive triangles, punctual lights, and the environment beside them.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/blocks/path_block.h"
#include "lte/pathtrace/blocks/path_kernels.h"
#include "lte/pathtrace/blocks/path_sampler.h"
#include "lte/pathtrace/lights/alias_table.h"
#include "lte/pathtrace/lights/environment_sampler.h"
#include "lte/pathtrace/lights/light_sample.h"
#include "lte/pathtrace/lights/light_tree.h"
#include "lte/scene/scene.h"

namespace lte::pathtrace {

struct EmissiveTriangle {
  int instance = 0;
  uint32_t triangle = 0;
  float area = 0;         ///< m²
  Vec3 p0, edge1, edge2;  ///< world axes, relative to frame_origin()
  Vec3 normal;            ///< unit, front
  float offset = 0;       ///< distance off the surface at which shadow rays end, not to meet it
  Rgb emission;           ///< factor; the whole of it unless `textured`
  bool textured = false;
  bool two_sided = false;
  int light_group = scene::kNone;
};

/// How a light is drawn. An environment is drawn beside the others, in proportion to its power
/// through the scene's bounding sphere but with 1/10 to 1/2 of the draws, as nobody knows how much
/// of it gets in; with EachGroup it is drawn as often as any group.
enum class LightChoice {
  Automatic,  ///< Power for one or two emissive triangles or punctual lights, Tree for more
  Power,      ///< in proportion to its power
  Tree,       ///< by what it may bring to the point (light_tree.h); directional lights all alike
  EachGroup,  ///< every group alike, by power within it: finds a faint lamp beside bright ones
};

/// The light sampler of a scene. Keeps a reference to it, which must outlive it. Black lights are
/// left out, so they are never sampled. Thread-safe.
class Lights {
 public:
  /// @throws lte::Error if an emissive instance or a punctual light has no light group.
  explicit Lights(const scene::Scene& scene, LightChoice choice = LightChoice::Automatic);

  bool empty() const { return table_.empty() && environment_.black(); }
  /// Whether a ray can find light by itself: area lights or an environment.
  bool can_be_hit() const { return !triangles_.empty() || has_environment(); }
  bool has_environment() const { return !environment_.black(); }
  const EnvironmentSampler& environment() const { return environment_; }
  /// Solid-angle density with which sample_in_frame() makes the direction of `seen`, which
  /// environment().evaluate() gave.
  float environment_pdf(const EnvironmentSample& seen) const {
    return environment_share_ * seen.pdf;
  }
  int groups() const { return groups_; }
  const scene::Scene& scene() const { return scene_; }

  /// Draws a light for a point and a place on it. pdf 0 means: nothing arrives.
  /// @param normal  unit, of the side that light is to arrive on; zero for either
  LightSample sample(const Vec3& position, const Vec3& normal, double u_choice,
                     const Vec2& u_point) const {
    return sample_in_frame(position - origin_, normal, u_choice, u_point);
  }

  /// The same for a position relative to frame_origin(): what paths use.
  LightSample sample_in_frame(const Vec3& position, const Vec3& normal, double u_choice,
                              const Vec2& u_point) const;

  /// Solid-angle density with which sample_in_frame(position, normal) makes the direction that met
  /// `triangle` of `instance` at squared distance `distance2` under `cos_light` (absolute cosine at
  /// the light). 0 if it is not drawn.
  float pdf(const Vec3& position, const Vec3& normal, int instance, uint32_t triangle,
            float distance2, float cos_light) const {
    const int64_t first = first_of_instance_[instance];
    if (first < 0) return 0;
    const auto index = static_cast<uint32_t>(first + triangle);
    const float probability =
        uses_tree_ ? (1 - directional_share_) * tree_.probability(position, normal, index)
                   : table_.probability(index);
    return (1 - environment_share_) * probability * distance2 /
           (triangles_[index].area * cos_light);
  }

 private:
  friend void sample_light_lanes(const Lights&, const Lanes3&, const Lanes3&, const LightNumbers&,
                                 int, LightBlock*);

  double add_triangle(int instance, uint32_t triangle);
  void add_environment(const Bounds& bounds, LightChoice choice,
                       const std::vector<double>& weights);
  LightSample sample_environment(const Vec3& normal, const Vec2& u_point) const;
  /// Brings the weight of each group that has any to 1.
  void equalize_groups(std::vector<double>* weights) const;
  /// The tree holds all lights but directional ones, which have no place and are drawn beside it.
  void build_tree(const std::vector<double>& weights);
  /// @param walk  started for the point, where it asks for many lights; may be null
  bool choose(const Vec3& position, const Vec3& normal, double u, uint32_t* index,
              float* probability, LightTreeWalk* walk = nullptr) const;
  LightSample sample_triangle(const EmissiveTriangle& light, const Vec3& position,
                              const Vec2& u_point) const;

  const scene::Scene& scene_;
  Vec3 origin_;
  int groups_ = 0;
  std::vector<EmissiveTriangle> triangles_;
  std::vector<TriangleLight> triangle_lights_;  ///< triangles_ as blocks of paths need them
  AliasTable table_;                            ///< emissive triangles, then punctual lights
  LightTree tree_;                              ///< the same but directional lights; if uses_tree_
  bool uses_tree_ = false;
  bool only_plain_triangles_ = false;  ///< neither textured ones nor punctual lights
  std::vector<uint32_t> directional_;  ///< entries of the table
  float directional_share_ = 0;        ///< of draws, with the tree
  EnvironmentSampler environment_;
  float environment_share_ = 0;  ///< of draws
  /// Index of an instance's first emissive triangle, −1 for none.
  std::vector<int64_t> first_of_instance_;
};

}  // namespace lte::pathtrace
