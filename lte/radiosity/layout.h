// What is known of points before light flows between them: which of them shine, what blocks the
// view, which luminaires are asked for together; and, once direct light is known, which points
// reflect light to others.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/radiosity/occupancy_grid.h"
#include "lte/radiosity/patches.h"
#include "lte/radiosity/point_radiosity.h"

namespace lte::radiosity {

/// Light of the side of the normal, and of the other.
using Sides = std::array<Rgb, 2>;

/// Luminaires near each other that face alike: hardly finer does the grid tell who sees them, so
/// one march is for all.
struct Cluster {
  size_t first, last;  ///< of Layout::luminaires()
  Vec3 middle;         ///< one of them
};

/// A point that reflects light to others.
struct Sender {
  size_t point;
  float area;  ///< m² that it stands for among the senders
};

class Layout {
 public:
  /// @param points  borrowed
  explicit Layout(const Points& points);

  /// Points that shine, in the order of their clusters, and the others, ascending.
  const std::vector<size_t>& luminaires() const { return luminaires_; }
  const std::vector<size_t>& dark() const { return dark_; }
  const std::vector<Cluster>& clusters() const { return clusters_; }
  const OccupancyGrid& grid() const { return grid_; }
  Place place_of(size_t i) const { return {points_.position[i], points_.normal[i]}; }

  /// All dark points, or where those are more than are wanted, points each of which stands for as
  /// much as any other along a curve through all, half of it area and half the direct light that it
  /// reflects. Drawn at random, or by area alone, too few lie where a lamp shines.
  /// @param direct  [groups, points] on the two sides
  std::vector<Sender> choose_senders(std::span<const Sides> direct, int64_t groups,
                                     size_t wanted) const;

 private:
  struct Blockers {
    std::vector<Vec3> position, normal;
    void add(const Vec3& p, const Vec3& n) {
      position.push_back(p);
      normal.push_back(n);
    }
  };

  bool emits(size_t i) const { return max_component(points_.emission[i]) > 0; }
  Blockers choose_roles();
  void cluster_luminaires();
  size_t middle_of(const Cluster& cluster) const;
  std::vector<double> importance_of_senders(std::span<const Sides> direct, int64_t groups) const;
  std::vector<size_t> along_curve() const;

  Points points_;
  size_t count_;
  std::vector<size_t> luminaires_, dark_;
  double dark_area_ = 0;
  float spacing_ = 0;
  Blockers blockers_;
  OccupancyGrid grid_;
  std::vector<Cluster> clusters_;
};

}  // namespace lte::radiosity
