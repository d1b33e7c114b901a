#include "lte/radiosity/point_radiosity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/morton.h"
#include "lte/base/parallel.h"
#include "lte/radiosity/occupancy_grid.h"
#include "lte/radiosity/patches.h"

namespace lte::radiosity {
namespace {

// Cells of so many spacings of the points. Of 0.6 to 1.1, and with how far planes are closed
// (surfels.cpp) and what an end's own surface is (occupancy_grid.cpp), this agreed best with
// path-traced light in homes and boxes, by lamps and by daylight.
constexpr float kCellSpacings = 0.6f;
// Luminaires are near each other in cubes of so many spacings: those of the points there are, or of
// as many as this where there are more. A march for each luminaire of each point grows with the
// square of the points, and tells the network no more.
constexpr float kClusterSpacings = 0.9f;
constexpr double kFinestClusters = 8192;
// What weighs less is left out: emission and radiosity times these. A small lamp of many points
// weighs little by each of them.
constexpr float kMinDirect = 1e-9f, kMinTransfer = 2e-4f;
/// Of what senders stand for, the share that is reflected light; the other is area.
constexpr double kShareByLight = 0.5;
/// Normals are alike that agree, axis by axis, on being above it, below −it or between.
constexpr float kMinAxisCosine = 0.5f;
constexpr int64_t kGrain = 16;

/// Light that goes from a sender to a receiver.
struct Link {
  size_t sender;    ///< index among the senders
  float weight;     ///< irradiance here over radiosity there
  size_t from, to;  ///< sides
};

/// Of the side of the normal, and of the other.
using Sides = std::array<Rgb, 2>;

/// What one thread uses again and again.
struct Work {
  Transfers transfers;
  std::vector<Link> links;
  std::vector<size_t> queried;  ///< clusters
  std::vector<Vec3> ends;
  std::vector<uint8_t> visible;
};

/// Luminaires near each other that face alike: hardly finer does the grid tell who sees them, so
/// one march is for all.
struct Cluster {
  size_t first, last;  ///< of the luminaires
  Vec3 middle;         ///< one of them
};

class Solver {
 public:
  Solver(const Points& points, int64_t groups, const Options& options)
      : points_(points),
        groups_(groups),
        options_(options),
        count_(points.position.size()),
        blockers_(choose_roles()),
        grid_(blockers_.position, blockers_.normal, kCellSpacings * spacing_) {
    cluster_luminaires();
    direct_.resize(static_cast<size_t>(groups) * count_);
    indirect_.resize(direct_.size());
  }

  PointIrradiance run() {
    parallel_for(static_cast<int64_t>(dark_.size()), kGrain, [&](int64_t first, int64_t last) {
      Work work;
      for (int64_t i = first; i < last; ++i) add_direct(dark_[static_cast<size_t>(i)], &work);
    });
    if (!points_.direct.empty()) add_given_light();
    choose_senders();
    const std::vector<Sides> reflected = bounce();
    parallel_for(static_cast<int64_t>(dark_.size()), kGrain, [&](int64_t first, int64_t last) {
      Work work;
      for (int64_t i = first; i < last; ++i) {
        const size_t point = dark_[static_cast<size_t>(i)];
        find_links(point, &work);
        for (int64_t g = 0; g < groups_; ++g)
          indirect_[row(g) + point] = gather(work.links, g, reflected);
      }
    });
    PointIrradiance light;
    add_sides(direct_, &light.direct, &light.direct_back);
    add_sides(indirect_, &light.indirect, &light.indirect_back);
    return light;
  }

 private:
  static void add_sides(const std::vector<Sides>& sides, std::vector<Rgb>* both,
                        std::vector<Rgb>* back) {
    for (const auto& [front_side, back_side] : sides) {
      both->push_back(front_side + back_side);
      back->push_back(back_side);
    }
  }

  void add_given_light() {
    for (int64_t g = 0; g < groups_; ++g) {
      for (const size_t i : dark_) {
        const Rgb& back = points_.direct_back[row(g) + i];
        direct_[row(g) + i][0] += points_.direct[row(g) + i] - back;
        direct_[row(g) + i][1] += back;
      }
    }
  }

  bool emits(size_t i) const { return max_component(points_.emission[i]) > 0; }
  size_t row(int64_t group) const { return static_cast<size_t>(group) * count_; }
  size_t sender_row(int64_t group) const { return static_cast<size_t>(group) * senders_.size(); }

  struct Blockers {
    std::vector<Vec3> position, normal;
    void add(const Vec3& p, const Vec3& n) {
      position.push_back(p);
      normal.push_back(n);
    }
  };

  /// Sorts points into those that emit and those that do not, and returns what blocks the view:
  /// the latter, and luminaires among them. Lights of the sky stand far outside.
  Blockers choose_roles() {
    Blockers blockers;
    Bounds bounds;
    for (size_t i = 0; i < count_; ++i) {
      (emits(i) ? luminaires_ : dark_).push_back(i);
      if (emits(i)) continue;
      dark_area_ += points_.area[i];
      blockers.add(points_.position[i], points_.normal[i]);
      bounds.extend(points_.position[i]);
    }
    const auto dark = static_cast<double>(std::max<size_t>(dark_.size(), 1));
    spacing_ = static_cast<float>(std::sqrt(dark_area_ / dark));
    for (const size_t i : luminaires_) {
      const Vec3& p = points_.position[i];
      if (min(p, bounds.low) == bounds.low && max(p, bounds.high) == bounds.high)
        blockers.add(p, points_.normal[i]);
    }
    return blockers;
  }

  Place place_of(size_t i) const { return {points_.position[i], points_.normal[i]}; }

  /// Brings luminaires into the order of their clusters. Each that stands outside the grid has one
  /// of its own.
  void cluster_luminaires() {
    const double finer = std::max(1.0, static_cast<double>(count_) / kFinestClusters);
    const GridShape cubes = GridShape::around(
        blockers_.position, kClusterSpacings * spacing_ * static_cast<float>(std::sqrt(finer)));
    const auto alone = static_cast<int64_t>(std::numeric_limits<int32_t>::max());
    std::vector<std::pair<int64_t, size_t>> keyed;
    for (const size_t i : luminaires_) {
      const Vec3& n = points_.normal[i];
      int64_t facing = 0;
      for (int axis = 0; axis < 3; ++axis)
        facing = 3 * facing + (n[axis] > kMinAxisCosine ? 2 : n[axis] < -kMinAxisCosine ? 1 : 0);
      const std::optional<int32_t> cell = cubes.cell_of(points_.position[i]);
      keyed.emplace_back(
          cell ? 27 * int64_t{*cell} + facing : 27 * (alone + static_cast<int64_t>(i)), i);
    }
    std::sort(keyed.begin(), keyed.end());
    for (size_t k = 0; k < keyed.size(); ++k) {
      const size_t i = luminaires_[k] = keyed[k].second;
      luminaire_patches_.add(points_.position[i], points_.normal[i], points_.area[i]);
      if (k == 0 || keyed[k].first != keyed[k - 1].first) clusters_.push_back({k, k, {}});
      clusters_.back().last = k + 1;
    }
    for (Cluster& cluster : clusters_)
      cluster.middle = luminaire_patches_.place(middle_of(cluster)).position;
  }
  /// The luminaire that is nearest to the mean of its cluster.
  size_t middle_of(const Cluster& cluster) const {
    Vec3 mean;
    for (size_t k = cluster.first; k < cluster.last; ++k)
      mean +=
          luminaire_patches_.place(k).position / static_cast<float>(cluster.last - cluster.first);
    size_t best = cluster.first;
    float least = std::numeric_limits<float>::infinity();
    for (size_t k = cluster.first; k < cluster.last; ++k) {
      const float distance = length(luminaire_patches_.place(k).position - mean);
      if (distance < least) least = distance, best = k;
    }
    return best;
  }

  void add_direct(size_t i, Work* work) {
    luminaire_patches_.transfer_to(place_of(i), &work->transfers);
    const std::vector<float>& weight = work->transfers.weight;
    const std::vector<int32_t>& sides = work->transfers.sides;
    const auto counts = [&](size_t k) {
      return weight[k] >= kMinDirect && (sides[k] & Transfers::kFromBack) == 0;
    };
    work->queried.clear();
    work->ends.clear();
    for (size_t c = 0; c < clusters_.size(); ++c) {
      const Cluster& cluster = clusters_[c];
      for (size_t k = cluster.first; k < cluster.last; ++k) {
        if (!counts(k)) continue;
        work->queried.push_back(c);
        work->ends.push_back(cluster.middle);
        break;
      }
    }
    grid_.see(points_.position[i], work->ends, &work->visible);
    for (size_t a = 0; a < work->queried.size(); ++a) {
      if (work->visible[a] == 0) continue;
      const Cluster& cluster = clusters_[work->queried[a]];
      for (size_t k = cluster.first; k < cluster.last; ++k) {
        if (!counts(k)) continue;
        const size_t j = luminaires_[k], to = (sides[k] & Transfers::kToBack) != 0 ? 1 : 0;
        const auto group = points_.light_group.empty() ? 0 : int64_t{points_.light_group[j]};
        direct_[row(group) + i][to] += points_.emission[j] * weight[k];
      }
    }
  }

  /// Chooses points that reflect light to others: all, or where those are more than are queried
  /// for, points each of which stands for as much as any other along a curve through all, half of
  /// it area and half the direct light that it reflects. Drawn at random, or by area alone, too few
  /// lie where a lamp shines.
  void choose_senders() {
    const auto wanted = static_cast<size_t>(options_.senders);
    if (dark_.size() <= wanted) {
      for (const size_t i : dark_) add_sender(i, 1);
      return;
    }
    const std::vector<double> importance = importance_of_senders();
    const double total = std::accumulate(importance.begin(), importance.end(), 0.0);
    if (wanted == 0 || !(total > 0)) return;
    const double step = total / static_cast<double>(wanted);
    double passed = 0;
    int64_t marks = 0;  // passed, of one in the middle of each step
    for (const size_t k : along_curve()) {
      passed += importance[k];
      const int64_t times = int64_t{std::llround(passed / step)} - marks;
      if (times == 0) continue;
      marks += times;
      add_sender(dark_[k], static_cast<double>(times) * step / importance[k]);
    }
  }

  /// @param points  that it stands for
  void add_sender(size_t i, double points) {
    senders_.push_back(i);
    sender_patches_.add(points_.position[i], points_.normal[i],
                        static_cast<float>(points_.area[i] * points));
  }

  /// Of each dark point; they add up to 1, or to 0 where there is no area.
  std::vector<double> importance_of_senders() const {
    // Groups alike: which of them is bright is not known yet.
    std::vector<double> reflected(dark_.size());
    double lit_groups = 0;
    for (int64_t g = 0; g < groups_; ++g) {
      const auto power = [&](size_t i) {
        const auto& [front, back] = direct_[row(g) + i];
        const Rgb light = points_.albedo[i] * (front + back);
        return points_.area[i] * (double{light.x} + light.y + light.z);
      };
      double sum = 0;
      for (const size_t i : dark_) sum += power(i);
      if (!(sum > 0 && std::isfinite(sum))) continue;
      ++lit_groups;
      for (size_t k = 0; k < dark_.size(); ++k) reflected[k] += power(dark_[k]) / sum;
    }
    std::vector<double> importance(dark_.size());
    if (!(dark_area_ > 0)) return importance;
    const double by_light = lit_groups > 0 ? kShareByLight : 0;
    for (size_t k = 0; k < dark_.size(); ++k)
      importance[k] = (1 - by_light) * points_.area[dark_[k]] / dark_area_ +
                      by_light * reflected[k] / std::max(lit_groups, 1.0);
    return importance;
  }

  /// Places in `dark_` along Morton's curve.
  std::vector<size_t> along_curve() const {
    const GridShape cubes = GridShape::around(blockers_.position, spacing_);
    std::vector<std::pair<uint64_t, size_t>> keyed;
    for (size_t k = 0; k < dark_.size(); ++k) {
      const Vec3 cube = cubes.place(points_.position[dark_[k]]);
      keyed.emplace_back(morton_code({static_cast<uint32_t>(cube.x), static_cast<uint32_t>(cube.y),
                                      static_cast<uint32_t>(cube.z)}),
                         k);
    }
    std::sort(keyed.begin(), keyed.end());
    std::vector<size_t> order;
    order.reserve(keyed.size());
    for (const auto& [code, k] : keyed) order.push_back(k);
    return order;
  }

  /// What point `i` receives from all senders that it sees. What their areas overlap is taken off:
  /// a side gets at most what a full hemisphere gives.
  void find_links(size_t i, Work* work) const {
    sender_patches_.transfer_to(place_of(i), &work->transfers);
    const auto& [weight, sides] = work->transfers;
    work->links.clear();
    work->ends.clear();
    for (size_t k = 0; k < senders_.size(); ++k) {
      if (!(weight[k] >= kMinTransfer)) continue;
      const size_t from = (sides[k] & Transfers::kFromBack) != 0 ? 1 : 0;
      work->links.push_back(
          {k, weight[k], from, (sides[k] & Transfers::kToBack) != 0 ? size_t{1} : 0});
      work->ends.push_back(sender_patches_.place(k).position);
    }
    grid_.see(points_.position[i], work->ends, &work->visible);
    size_t kept = 0;
    for (size_t k = 0; k < work->links.size(); ++k) {
      if (work->visible[k] != 0) work->links[kept++] = work->links[k];
    }
    work->links.resize(kept);
    std::array<float, 2> covered{};
    for (Link& link : work->links) covered[link.to] += link.weight /= kPi;
    for (Link& link : work->links) {
      if (covered[link.to] > 1) link.weight /= covered[link.to];
    }
  }

  Sides gather(const std::vector<Link>& links, int64_t group,
               const std::vector<Sides>& radiosity) const {
    Sides sum{};
    for (const Link& link : links) {
      sum[link.to] += radiosity[sender_row(group) + link.sender][link.from] * link.weight;
    }
    return sum;
  }

  /// Radiosity of the senders after all but the last reflection, [groups, senders].
  std::vector<Sides> bounce() const {
    const size_t m = senders_.size();
    std::vector<std::vector<Link>> links(m);
    parallel_for(static_cast<int64_t>(m), kGrain, [&](int64_t first, int64_t last) {
      Work work;
      for (auto k = static_cast<size_t>(first); k < static_cast<size_t>(last); ++k) {
        find_links(senders_[k], &work);
        links[k] = work.links;
      }
    });
    std::vector<Sides> radiosity(static_cast<size_t>(groups_) * m), next = radiosity;
    for (int bounces = 0; bounces < options_.bounces; ++bounces) {
      parallel_for(groups_ * static_cast<int64_t>(m), kGrain, [&](int64_t first, int64_t last) {
        for (int64_t at = first; at < last; ++at) {
          const int64_t group = at / static_cast<int64_t>(m);
          const size_t k = static_cast<size_t>(at) - sender_row(group), point = senders_[k];
          const Sides received = gather(links[k], group, radiosity);
          const Sides& direct = direct_[row(group) + point];
          for (size_t side = 0; side < 2; ++side) {
            next[static_cast<size_t>(at)][side] =
                points_.albedo[point] * (direct[side] + received[side]);
          }
        }
      });
      std::swap(radiosity, next);
    }
    return radiosity;
  }

  const Points& points_;
  int64_t groups_;
  Options options_;
  size_t count_;
  std::vector<size_t> luminaires_, dark_;
  double dark_area_ = 0;
  float spacing_ = 0;
  Blockers blockers_;
  OccupancyGrid grid_;
  Patches luminaire_patches_, sender_patches_;
  std::vector<Cluster> clusters_;
  std::vector<size_t> senders_;
  std::vector<Sides> direct_, indirect_;  ///< [groups, points]
};

void check(const Points& points, int64_t groups, const Options& options) {
  const size_t count = points.position.size();
  LTE_CHECK(points.normal.size() == count && points.albedo.size() == count &&
                points.emission.size() == count && points.area.size() == count &&
                (points.light_group.empty() || points.light_group.size() == count),
            "radiosity: arrays of scene points differ in length");
  const size_t given = points.direct.empty() ? 0 : static_cast<size_t>(groups) * count;
  LTE_CHECK(points.direct.size() == given && points.direct_back.size() == given,
            "radiosity: direct light of ", points.direct.size(), " and ", points.direct_back.size(),
            " rows where ", groups, " groups of ", count, " points have ", given);
  LTE_CHECK(groups >= 0 && options.senders >= 0 && options.bounces >= 0,
            "radiosity: groups, senders and bounces must not be negative");
  for (size_t i = 0; i < count; ++i) {
    if (max_component(points.emission[i]) <= 0) continue;
    const int64_t group = points.light_group.empty() ? 0 : points.light_group[i];
    LTE_CHECK(group >= 0 && group < groups, "radiosity: point ", i, " emits in light group ", group,
              ", of ", groups);
  }
}

}  // namespace

PointIrradiance solve(const Points& points, int64_t groups, const Options& options) {
  check(points, groups, options);
  return Solver(points, groups, options).run();
}

}  // namespace lte::radiosity
