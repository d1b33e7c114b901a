// A tree over lights that draws them by what they may bring to a point: power, distance, and the
// cones that they shine into and are seen under (Conty Estevez and Kulla 2018, as in pbrt-v4).
#pragma once

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
  struct Node {
    LightCluster cluster;
    uint32_t index = 0;  ///< of the second child (the first follows its parent), or of the light
    bool leaf = false;
  };
  struct Item {
    LightCluster cluster;
    Vec3 center;
    uint32_t light = 0;
  };

  void build(std::vector<Item>& items, size_t begin, size_t end, uint64_t trail, int depth);
  /// Share of draws that the first of a node's two children gets; false if neither can be drawn.
  bool first_share(uint32_t node, const Vec3& position, const Vec3& normal, double* share) const;

  std::vector<Node> nodes_;
  std::vector<uint64_t> trails_;  ///< by light: bit k says which child to take at depth k
  std::vector<uint8_t> present_;  ///< by light
};

/// An upper estimate, up to a factor, of what a cluster brings to a point: zero only if it brings
/// nothing.
float cluster_importance(const LightCluster& cluster, const Vec3& position, const Vec3& normal);

}  // namespace lte::pathtrace
