#include "lte/radiosity/point_radiosity.h"

#include <cmath>
#include <numeric>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/radiosity/occupancy_grid.h"

namespace lte::radiosity {
namespace {

// Cells of so many spacings of the points: surfaces are closed for a march but for few holes. Of
// 0.9 to 1.3, and with what a cell's own surface is (occupancy_grid.cpp), this agreed best with
// path-traced light in twelve rooms of boxes and ten homes.
constexpr float kCellSpacings = 0.9f;
// What weighs less is left out: emission and radiosity times these.
constexpr float kLeastDirect = 1e-6f, kLeastTransfer = 2e-4f;
constexpr int64_t kGrain = 16;

/// Light that goes from a sender to a receiver.
struct Link {
  int32_t sender;            ///< index among the senders
  float weight;              ///< irradiance here over radiosity there
  uint8_t from = 0, to = 0;  ///< sides
};

/// Of the side of the normal, and of the other.
using Sides = std::array<Rgb, 2>;

/// What one thread uses again and again.
struct Work {
  std::vector<Link> links;
  std::vector<OccupancyGrid::End> ends;
  std::vector<uint8_t> visible;
};

class Solver {
 public:
  Solver(const Points& points, int64_t groups, const Options& options)
      : points_(points),
        groups_(groups),
        options_(options),
        count_(points.position.size()),
        blockers_(choose_roles()),
        grid_(blockers_, kCellSpacings * spacing_) {
    direct_.resize(static_cast<size_t>(groups) * count_);
    indirect_.resize(direct_.size());
  }

  PointLight run() {
    parallel_for(static_cast<int64_t>(dark_.size()), kGrain, [&](int64_t first, int64_t last) {
      Work work;
      for (int64_t i = first; i < last; ++i) add_direct(dark_[static_cast<size_t>(i)], &work);
    });
    draw_senders();
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
    PointLight light;
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

  bool emits(size_t i) const { return max_component(points_.emission[i]) > 0; }
  size_t row(int64_t group) const { return static_cast<size_t>(group) * count_; }
  size_t sender_row(int64_t group) const { return static_cast<size_t>(group) * senders_.size(); }

  /// Sorts points into those that emit and those that do not, and returns what blocks the view:
  /// the latter, and luminaires among them. Lights of the sky stand far outside.
  std::vector<Vec3> choose_roles() {
    std::vector<Vec3> blockers;
    Bounds bounds;
    for (size_t i = 0; i < count_; ++i) {
      (emits(i) ? luminaires_ : dark_).push_back(i);
      if (emits(i)) continue;
      dark_area_ += points_.area[i];
      blockers.push_back(points_.position[i]);
      bounds.extend(points_.position[i]);
    }
    const auto dark = static_cast<double>(std::max<size_t>(dark_.size(), 1));
    spacing_ = static_cast<float>(std::sqrt(dark_area_ / dark));
    for (const size_t i : luminaires_) {
      const Vec3& p = points_.position[i];
      if (min(p, bounds.low) == bounds.low && max(p, bounds.high) == bounds.high)
        blockers.push_back(p);
    }
    return blockers;
  }

  /// cos cos′ A / (d² + A/π) of receiver `i` and sender `j` of area A: π times the form
  /// factor of a disc, exact where it is seen head-on. It stays finite where the two touch.
  float transfer(size_t i, size_t j, float area) const {
    const Vec3 d = points_.position[j] - points_.position[i];
    const float d2 = dot(d, d);
    if (!(d2 > 0)) return 0;
    const float cosines = std::abs(dot(d, points_.normal[i]) * dot(d, points_.normal[j])) / d2;
    return cosines * area / (d2 + area / kPi);
  }
  OccupancyGrid::End end_of(size_t i) const { return {points_.position[i], points_.normal[i]}; }

  /// What point `i` receives from those of `from` whose weight is at least `least`, visible or not;
  /// `area(k)` is that of the k-th.
  template <typename Area>
  void weigh(size_t i, const std::vector<size_t>& from, float least, const Area& area,
             Work* work) const {
    work->links.clear();
    work->ends.clear();
    for (size_t k = 0; k < from.size(); ++k) {
      const size_t j = from[k];
      const float weight = transfer(i, j, area(j));
      if (!(weight >= least)) continue;
      const Vec3 d = points_.position[j] - points_.position[i];
      const auto side = static_cast<uint8_t>(dot(d, points_.normal[j]) > 0 ? 1 : 0);
      const auto to = static_cast<uint8_t>(dot(d, points_.normal[i]) < 0 ? 1 : 0);
      work->links.push_back({static_cast<int32_t>(k), weight, side, to});
      work->ends.push_back(end_of(j));
    }
  }
  /// Takes away those that point `i` does not see.
  void drop_hidden(size_t i, Work* work) const {
    grid_.see(end_of(i), work->ends, &work->visible);
    size_t kept = 0;
    for (size_t k = 0; k < work->links.size(); ++k) {
      if (work->visible[k] != 0) work->links[kept++] = work->links[k];
    }
    work->links.resize(kept);
  }

  void add_direct(size_t i, Work* work) {
    weigh(
        i, luminaires_, kLeastDirect, [&](size_t j) { return points_.area[j]; }, work);
    std::erase_if(work->links, [](const Link& link) { return link.from != 0; });
    work->ends.clear();
    for (const Link& link : work->links)
      work->ends.push_back(end_of(luminaires_[static_cast<size_t>(link.sender)]));
    drop_hidden(i, work);
    for (const Link& link : work->links) {
      const size_t j = luminaires_[static_cast<size_t>(link.sender)];
      const auto group = points_.light_group.empty() ? 0 : int64_t{points_.light_group[j]};
      direct_[row(group) + i][link.to] += points_.emission[j] * link.weight;
    }
  }

  void draw_senders() {
    senders_ = dark_;
    Rng rng(0);
    const size_t wanted = std::min(senders_.size(), static_cast<size_t>(options_.senders));
    double area = 0;
    for (size_t k = 0; k < wanted; ++k) {
      std::swap(senders_[k], senders_[k + rng.below(senders_.size() - k)]);
      area += points_.area[senders_[k]];
    }
    senders_.resize(wanted);
    area_factor_ = area > 0 ? static_cast<float>(dark_area_ / area) : 0;
  }

  /// What point `i` receives from all senders. What their areas overlap is taken off: a side gets
  /// at most what a full hemisphere gives.
  void find_links(size_t i, Work* work) const {
    weigh(
        i, senders_, kLeastTransfer, [&](size_t j) { return points_.area[j] * area_factor_; },
        work);
    drop_hidden(i, work);
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
      sum[link.to] +=
          radiosity[sender_row(group) + static_cast<size_t>(link.sender)][link.from] * link.weight;
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
  std::vector<Vec3> blockers_;
  OccupancyGrid grid_;
  std::vector<size_t> senders_;
  float area_factor_ = 0;                 ///< by which the senders stand for the others as well
  std::vector<Sides> direct_, indirect_;  ///< [groups, points]
};

void check(const Points& points, int64_t groups, const Options& options) {
  const size_t count = points.position.size();
  LTE_CHECK(points.normal.size() == count && points.albedo.size() == count &&
                points.emission.size() == count && points.area.size() == count &&
                (points.light_group.empty() || points.light_group.size() == count),
            "radiosity: arrays of scene points differ in length");
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

PointLight solve(const Points& points, int64_t groups, const Options& options) {
  check(points, groups, options);
  return Solver(points, groups, options).run();
}

}  // namespace lte::radiosity
