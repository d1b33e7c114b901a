#include "lte/radiosity/point_radiosity.h"

#include <algorithm>
#include <array>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/radiosity/constants.h"
#include "lte/radiosity/layout.h"
#include "lte/radiosity/patches.h"

namespace lte::radiosity {
namespace {

constexpr int64_t kGrain = 16;

/// Light that goes from a sender to a receiver.
struct Link {
  size_t sender;    ///< index among the senders
  float weight;     ///< irradiance here over radiosity there
  size_t from, to;  ///< sides
};

/// What one thread uses again and again.
struct Work {
  Transfers transfers;
  std::vector<Link> links;
  std::vector<size_t> queried;  ///< clusters
  std::vector<Vec3> ends;
  std::vector<uint8_t> visible;
};

class Solver {
 public:
  Solver(const Points& points, int64_t groups, const Options& options)
      : points_(points),
        groups_(groups),
        options_(options),
        count_(points.position.size()),
        layout_(points) {
    for (const size_t i : layout_.luminaires())
      luminaire_patches_.add(points.position[i], points.normal[i], points.area[i]);
    direct_.resize(static_cast<size_t>(groups) * count_);
    indirect_.resize(direct_.size());
  }

  PointIrradiance run() {
    const std::vector<size_t>& dark = layout_.dark();
    parallel_for(static_cast<int64_t>(dark.size()), kGrain, [&](int64_t first, int64_t last) {
      Work work;
      for (int64_t i = first; i < last; ++i) add_direct(dark[static_cast<size_t>(i)], &work);
    });
    if (!points_.direct.empty()) add_given_light();
    choose_senders();
    const std::vector<Sides> reflected = bounce();
    parallel_for(static_cast<int64_t>(dark.size()), kGrain, [&](int64_t first, int64_t last) {
      Work work;
      for (int64_t i = first; i < last; ++i) {
        const size_t point = dark[static_cast<size_t>(i)];
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
      for (const size_t i : layout_.dark()) {
        const Rgb& back = points_.direct_back[row(g) + i];
        direct_[row(g) + i][0] += points_.direct[row(g) + i] - back;
        direct_[row(g) + i][1] += back;
      }
    }
  }

  size_t row(int64_t group) const { return static_cast<size_t>(group) * count_; }
  size_t sender_row(int64_t group) const { return static_cast<size_t>(group) * senders_.size(); }

  void add_direct(size_t i, Work* work) {
    luminaire_patches_.transfer_to(layout_.place_of(i), &work->transfers);
    const std::vector<float>& weight = work->transfers.weight;
    const std::vector<int32_t>& sides = work->transfers.sides;
    const auto counts = [&](size_t k) {
      return weight[k] >= kMinDirect && (sides[k] & Transfers::kFromBack) == 0;
    };
    const std::vector<Cluster>& clusters = layout_.clusters();
    work->queried.clear();
    work->ends.clear();
    for (size_t c = 0; c < clusters.size(); ++c) {
      const Cluster& cluster = clusters[c];
      for (size_t k = cluster.first; k < cluster.last; ++k) {
        if (!counts(k)) continue;
        work->queried.push_back(c);
        work->ends.push_back(cluster.middle);
        break;
      }
    }
    layout_.grid().see(points_.position[i], work->ends, &work->visible);
    for (size_t a = 0; a < work->queried.size(); ++a) {
      if (work->visible[a] == 0) continue;
      const Cluster& cluster = clusters[work->queried[a]];
      for (size_t k = cluster.first; k < cluster.last; ++k) {
        if (!counts(k)) continue;
        const size_t j = layout_.luminaires()[k], to = (sides[k] & Transfers::kToBack) != 0 ? 1 : 0;
        const auto group = points_.light_group.empty() ? 0 : int64_t{points_.light_group[j]};
        direct_[row(group) + i][to] += points_.emission[j] * weight[k];
      }
    }
  }

  void choose_senders() {
    for (const Sender& sender :
         layout_.choose_senders(direct_, groups_, static_cast<size_t>(options_.senders))) {
      const Place place = layout_.place_of(sender.point);
      senders_.push_back(sender.point);
      sender_patches_.add(place.position, place.normal, sender.area);
    }
  }

  /// What point `i` receives from all senders that it sees. What their areas overlap is taken off:
  /// a side gets at most what a full hemisphere gives.
  void find_links(size_t i, Work* work) const {
    sender_patches_.transfer_to(layout_.place_of(i), &work->transfers);
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
    layout_.grid().see(points_.position[i], work->ends, &work->visible);
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
  Layout layout_;
  Patches luminaire_patches_, sender_patches_;
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
