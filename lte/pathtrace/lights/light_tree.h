// A tree over lights that draws them by what they may bring to a point: power, distance, and the
// cones that they shine into and are seen under (Conty Estevez and Kulla 2018, as in pbrt-v4).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lte/base/math.h"

namespace lte::pathtrace {

/// Where lights are, and which way they shine: within the angle θe of some direction that lies
/// within θo of `axis`.
struct LightCluster {
  Bounds bounds;
  Vec3 axis{0, 0, 1};
  float power = 0;
  float cos_o = 1, cos_e = 1;
  bool two_sided = false;
};

class LightTreeWalk;

/// Thread-safe once built.
class LightTree {
 public:
  LightTree() = default;
  /// Lights without power are left out: they are never drawn and have probability 0.
  explicit LightTree(const std::vector<LightCluster>& lights);

  bool empty() const { return nodes_.empty(); }

  /// Draws a light for a point; false if none can bring anything there.
  /// @param normal  unit; zero if light may come from anywhere
  /// @param u       uniform in [0, 1)
  bool sample(const Vec3& position, const Vec3& normal, double u, uint32_t* light,
              float* probability) const;

  /// Probability with which sample() draws `light`.
  float probability(const Vec3& position, const Vec3& normal, uint32_t light) const;

 private:
  friend class LightTreeWalk;

  struct Node {
    LightCluster cluster;
    uint32_t index = 0;  ///< of the second child (the first follows its parent), or of the light
    bool leaf = false;
  };
  /// The clusters of a node's two children as their importance needs them.
  struct Children {
    float x[2], y[2], z[2], radius2[2];  ///< of the sphere around the bounds
    float axis_x[2], axis_y[2], axis_z[2];
    float power[2], cos_o[2], sin_o[2], cos_e[2];
    int32_t two_sided[2];  ///< all bits set, or none
  };
  struct Item {
    LightCluster cluster;
    Vec3 center;
    uint32_t light = 0;
  };

  static Children children_of(const LightCluster& first, const LightCluster& second);
  void build(std::vector<Item>& items, size_t begin, size_t end, uint64_t trail, int depth);
  /// Share of draws that the first of a node's two children gets; false if neither can be drawn.
  bool first_share(uint32_t node, const Vec3& position, const Vec3& normal, double* share) const;
  /// sample() with any `share_of(node, share)` in the place of first_share().
  template <typename ShareOf>
  bool descend(const ShareOf& share_of, double u, uint32_t* light, float* probability) const;

  std::vector<Node> nodes_;
  std::vector<Children> children_;  ///< by node; of a leaf nothing
  std::vector<uint64_t> trails_;    ///< by light: bit k says which child to take at depth k
  std::vector<uint8_t> present_;    ///< by light
};

/// Draws many lights for one point: what a node's children may bring there is worked out once.
/// Gives what LightTree::sample() gives. One for each thread.
class LightTreeWalk {
 public:
  /// The point that lights are drawn for from here on. The tree must outlive its draws.
  void start(const LightTree& tree, const Vec3& position, const Vec3& normal) {
    tree_ = &tree;
    position_ = position;
    normal_ = normal;
    ++point_;
  }
  bool sample(double u, uint32_t* light, float* probability);

 private:
  /// Of a node for point number `point`; nodes share entries, the last one stays.
  struct Entry {
    uint64_t point = 0;
    uint32_t node = 0;
    bool drawn = false;  ///< whether either child can be
    double share = 0;
  };

  const LightTree* tree_ = nullptr;
  Vec3 position_, normal_;
  uint64_t point_ = 0;
  std::array<Entry, 512> entries_;
};

}  // namespace lte::pathtrace
