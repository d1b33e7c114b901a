// Internal: the triangles of a scene cut finer where that is asked for, without cracks.
//
// Longest edges are halved (Rivara, "Algorithms for refining triangular grids", 1984), and so are
// those of every triangle that has a halved edge, whatever mesh it is of: an edge that two
// triangles shared stays shared.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <unordered_map>
#include <vector>

#include "lte/scene/scene.h"

namespace lte::bake {

struct Leaf {
  uint32_t instance = 0;
  std::array<uint32_t, 3> vertex{};  ///< of the instance's mesh
  std::array<uint32_t, 3> point{};   ///< the same for all vertices at one place of the world
  Vec3 normal;                       ///< world, unit, front side; 0 without area
};

class RefinedScene {
 public:
  /// @param scene  instance i has mesh i, as Lightmap::scene
  explicit RefinedScene(scene::Scene scene);

  const std::vector<Leaf>& leaves() const { return leaves_; }
  /// Meshes have the vertices of leaves, may have more, and the triangles that they came with.
  const scene::Scene& scene() const { return scene_; }
  /// Halves some leaves, and others so that edges fit; numbers of leaves change. Where there would
  /// be more than `most`, nothing does.
  /// @return  whether they were halved
  bool halve(std::span<const uint32_t> which, size_t most = std::numeric_limits<size_t>::max());

 private:
  /// What takes a halving back.
  struct Halving {
    uint32_t number = 0;
    Leaf leaf;          ///< as it was
    uint64_t edge = 0;  ///< that was halved
    bool is_new = false;
  };

  uint64_t edge(const Leaf& leaf, size_t k) const;
  size_t longest_edge(const Leaf& leaf) const;
  uint32_t middle_vertex(uint32_t instance, uint32_t a, uint32_t b);
  void halve(uint32_t leaf, std::vector<Halving>* done);
  void take_back(std::vector<Halving> done);

  scene::Scene scene_;
  std::vector<Leaf> leaves_;
  std::vector<Vec3> points_;                                  ///< world
  std::unordered_map<uint64_t, uint32_t> middle_;             ///< points, of halved edges
  std::vector<std::unordered_map<uint64_t, uint32_t>> made_;  ///< vertices of an instance
};

}  // namespace lte::bake
