#include "lte/pathtrace/reach/reach.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <numeric>
#include <unordered_map>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/pathtrace/reach/reach_memory.h"
#include "lte/pathtrace/reach/reach_samples.h"
#include "lte/pathtrace/transport/irradiance_kernel.h"
#include "lte/pathtrace/transport/transport_impl.h"
#include "lte/scene/light_points.h"

namespace lte::pathtrace {
namespace {

constexpr int kPathsOfRounds[] = {4, 16, 64};
constexpr int64_t kGrain = 16;
constexpr int kVerticesPerDepth = 4;  // that are kept of a dark point's paths, for condition 2
constexpr int kMaxNeighbours = 40;    // points that a vertex looks for
constexpr double kSearchRadius = 2;   // in units of the spacing of points
constexpr double kMaxOversampling = 8;
constexpr int64_t kProbePoints = 256;  // they estimate the reached share of the surface
constexpr float kSamePlace = 1e-3f;    // of the scene's extent, to recall what was dark

struct LightFound : public LightSink {
  void add(int, std::span<const Contribution> contributions) override {
    for (const Contribution& c : contributions) lit = lit || max_component(c.value) > 0;
  }
  bool lit = false;
};

/// Observes where paths go on from and keeps some of these vertices, as many of each depth: points
/// just off their surfaces, relative to the frame. The first is the point itself.
struct VertexRecorder {
  void nearest(int depth, const PathBlock& rays) {
    for (int lane = 0; lane < rays.size; ++lane) bounds->extend(rays.origin.at(lane));
    const int count = std::min(depth == 1 ? 1 : kVerticesPerDepth, rays.size);
    for (int lane = 0; lane < count; ++lane) vertices->push_back(rays.origin.at(lane));
  }
  void shadow(const ShadowBlock& rays) {
    for (int lane = 0; lane < rays.size; ++lane) bounds->extend(rays.origin.at(lane));
  }

  std::vector<Vec3>* vertices = nullptr;
  Bounds* bounds = nullptr;
};

/// Points by the cubic cells that they lie in.
class PointGrid {
 public:
  PointGrid(float edge, const Vec3& low) : edge_(edge), low_(low) {}
  void add(const Vec3& p, uint32_t index) { cells_[key(cell(p))].push_back(index); }
  /// Calls `use(index)` for the points of the 27 cells around `p` until it returns true.
  template <typename Use>
  bool any_near(const Vec3& p, const Use& use) const {
    const std::array<int64_t, 3> c = cell(p);
    for (int64_t x = -1; x <= 1; ++x) {
      for (int64_t y = -1; y <= 1; ++y) {
        for (int64_t z = -1; z <= 1; ++z) {
          const auto found = cells_.find(key({c[0] + x, c[1] + y, c[2] + z}));
          if (found == cells_.end()) continue;
          for (const uint32_t index : found->second)
            if (use(index)) return true;
        }
      }
    }
    return false;
  }

 private:
  std::array<int64_t, 3> cell(const Vec3& p) const {
    const auto along = [this](float x) {
      return static_cast<int64_t>(std::clamp(std::floor(x / edge_), -1e6f, 1e6f));
    };
    return {along(p.x - low_.x), along(p.y - low_.y), along(p.z - low_.z)};
  }
  static uint64_t key(const std::array<int64_t, 3>& c) {
    return (static_cast<uint64_t>(c[0] + (1 << 20)) << 42) ^
           (static_cast<uint64_t>(c[1] + (1 << 20)) << 21) ^
           static_cast<uint64_t>(c[2] + (1 << 20));
  }
  float edge_;
  Vec3 low_;
  std::unordered_map<uint64_t, std::vector<uint32_t>> cells_;
};

bool overlap(const Bounds& a, const Bounds& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

/// Decides which points to keep, by the two conditions of reach.h.
class ReachSearch {
 public:
  ReachSearch(const Bvh& bvh, std::span<const Vec3> positions, std::span<const Vec3> normals,
              Sides sides, const ReachOptions& options, const ReachRecall& recall = {})
      : bvh_(bvh),
        lights_(bvh.scene(), LightChoice::EachGroup),
        positions_(positions),
        normals_(normals),
        sides_(sides),
        options_(options),
        recall_(recall),
        half_extent_(0.5f * max_component(bvh.bounds().extent())),
        keep_(positions.size()),
        origin_(positions.size()),
        vertices_(positions.size()),
        front_vertices_(positions.size()),
        bounds_(positions.size()),
        recalled_(positions.size()) {
    recall_dark_points();
  }

  std::vector<uint8_t> run() {
    if (lights_.empty()) return std::vector<uint8_t>(positions_.size(), 1);
    for (const int paths : std::span(kPathsOfRounds).first(static_cast<size_t>(recall_.rounds))) {
      parallel_for(static_cast<int64_t>(keep_.size()), kGrain, [&](int64_t begin, int64_t end) {
        if (recall_.check) recall_.check();
        for (int64_t i = begin; i < end; ++i)
          if (!keep_[static_cast<size_t>(i)] && !recalled_[static_cast<size_t>(i)])
            trace(static_cast<size_t>(i), paths);
      });
    }
    if (now_ != nullptr) remember();
    spread_from_kept();
    return std::move(keep_);
  }

 private:
  /// Takes over what is still dark from the search of the same number.
  void recall_dark_points() {
    now_ = recall_.now;
    const size_t number = now_ != nullptr ? now_->searches.size() : 0;
    if (recall_.before == nullptr || number >= recall_.before->searches.size()) return;
    const ReachMemory::Search& before = recall_.before->searches[number];
    const Vec3 frame = bvh_.handles().origin;
    if (before.dark_of_point.size() != positions_.size() || !(before.frame == frame)) return;
    const float near = kSamePlace * 2 * half_extent_;
    for (size_t i = 0; i < positions_.size(); ++i) {
      if (before.dark_of_point[i] < 0) continue;
      const auto& dark = before.dark[static_cast<size_t>(before.dark_of_point[i])];
      if (max_component(abs(dark.position - positions_[i])) > near) continue;
      const bool touched =
          std::any_of(recall_.changed.begin(), recall_.changed.end(), [&](const Bounds& box) {
            const Vec3 slack{near, near, near};
            return overlap(dark.paths, {box.low - frame - slack, box.high - frame + slack});
          });
      if (touched) continue;
      recalled_[i] = 1;
      origin_[i] = dark.origin;
      vertices_[i] = dark.vertices;
      front_vertices_[i] = dark.front_vertices;
      bounds_[i] = dark.paths;
    }
  }

  void remember() const {
    ReachMemory::Search& search = now_->searches.emplace_back();
    search.frame = bvh_.handles().origin;
    search.dark_of_point.assign(positions_.size(), -1);
    for (size_t i = 0; i < positions_.size(); ++i) {
      if (keep_[i]) continue;
      search.dark_of_point[i] = static_cast<int32_t>(search.dark.size());
      search.dark.push_back(
          {positions_[i], bounds_[i], origin_[i], vertices_[i], front_vertices_[i]});
    }
  }

  Vec3 start(size_t i, const Vec3& side) const {
    return offset_origin(positions_[i], side, half_extent_) - bvh_.handles().origin;
  }

  /// Condition 1 for one point. If it stays dark, its vertices are there for condition 2.
  void trace(size_t i, int paths) {
    vertices_[i].clear();
    front_vertices_[i] = SIZE_MAX;
    for (const Vec3& side : {normals_[i], -normals_[i]}) {
      origin_[i] = start(i, side);
      if (finds_light(origin_[i], side, paths, i)) {
        keep_[i] = 1;
        vertices_[i] = {};
        return;
      }
      if (sides_ == Sides::Front) return;
      front_vertices_[i] = std::min(front_vertices_[i], vertices_[i].size());
    }
  }

  bool finds_light(const Vec3& origin, const Vec3& side, int paths, size_t i) {
    constexpr int kNoRoulette = 1 << 20;
    LightFound found;
    const auto transport = std::make_unique<BasicTransport<VertexRecorder>>(
        bvh_, lights_, options_.max_depth, kNoRoulette, found,
        VertexRecorder{&vertices_[i], &bounds_[i]});
    const auto sampler = std::make_unique<PathSampler>(Sampling::Sobol, paths);
    sampler->start_stream(hash_combine(options_.seed, static_cast<uint64_t>(paths)), i);
    sampler->start_set();
    for (int p = 0; p < paths; ++p) sampler->add_path();
    transport->trace_from_surface(origin, side, *sampler);
    return found.lit;
  }

  /// Condition 2. Round by round, dark points look for those that the last round kept.
  void spread_from_kept() {
    const double area = std::max(scene::surface_area(bvh_.scene()), 1e-30);
    const auto radius = static_cast<float>(
        kSearchRadius * std::sqrt(area / static_cast<double>(std::max<size_t>(1, keep_.size()))));
    const Vec3 low = bvh_.bounds().low - bvh_.handles().origin;
    std::vector<uint32_t> newly_kept, dark;
    for (uint32_t i = 0; i < keep_.size(); ++i) (keep_[i] ? newly_kept : dark).push_back(i);
    while (!newly_kept.empty() && !dark.empty()) {
      PointGrid grid(radius, low);
      for (const uint32_t i : newly_kept) grid.add(origin_[i], i);
      std::vector<uint8_t> found(dark.size());
      parallel_for(static_cast<int64_t>(dark.size()), kGrain, [&](int64_t begin, int64_t end) {
        for (int64_t k = begin; k < end; ++k)
          found[static_cast<size_t>(k)] = sees_kept(dark[static_cast<size_t>(k)], grid) ? 1 : 0;
      });
      newly_kept.clear();
      std::vector<uint32_t> rest;
      for (size_t k = 0; k < dark.size(); ++k) (found[k] ? newly_kept : rest).push_back(dark[k]);
      for (const uint32_t i : newly_kept) keep_[i] = 1;
      dark = std::move(rest);
    }
  }

  /// Also settles which side of the point the way goes out from.
  bool sees_kept(uint32_t i, const PointGrid& grid) {
    for (size_t k = 0; k < vertices_[i].size(); ++k) {
      const Vec3& vertex = vertices_[i][k];
      int tried = 0;
      bool seen = false;
      grid.any_near(vertex, [&](uint32_t j) {
        seen = !occluded(bvh_.handles().top, vertex, origin_[j] - vertex, 1);
        return seen || ++tried == kMaxNeighbours;
      });
      if (!seen) continue;
      origin_[i] = start(i, k < front_vertices_[i] ? normals_[i] : -normals_[i]);
      return true;
    }
    return false;
  }

  const Bvh& bvh_;
  const Lights lights_;
  std::span<const Vec3> positions_, normals_;
  const Sides sides_;
  const ReachOptions& options_;
  const ReachRecall recall_;
  const float half_extent_;
  std::vector<uint8_t> keep_;
  std::vector<Vec3> origin_;  ///< off the side that light reaches, relative to the frame
  /// The vertices of dark points: those of the paths from the front, then those from the back.
  std::vector<std::vector<Vec3>> vertices_;
  std::vector<size_t> front_vertices_;  ///< how many of them are the front's
  std::vector<Bounds> bounds_;          ///< of all vertices of their paths
  std::vector<uint8_t> recalled_;       ///< known to be dark
  ReachMemory* now_ = nullptr;
};

void check_search(std::span<const Vec3> positions, std::span<const Vec3> normals,
                  const ReachOptions& options) {
  IrradianceOptions check;
  check.max_depth = options.max_depth;
  check_points(positions, normals);
  check_irradiance_options(check);
}

/// Indices of the samples to keep.
KeptSamples kept_samples(const Bvh& bvh, const scene::SurfaceSamples& samples, Sides sides,
                         const ReachOptions& options, const ReachRecall& recall) {
  check_search(samples.position, samples.normal, options);
  const std::vector<uint8_t> keep =
      ReachSearch(bvh, samples.position, samples.normal, sides, options, recall).run();
  KeptSamples kept;
  for (size_t i = 0; i < keep.size(); ++i) {
    const bool emits = sides == Sides::Either && samples.light_group[i] != scene::kNone;
    if (emits) {
      kept.luminaires.push_back(i);
    } else if (keep[i]) {
      kept.others.push_back(i);
    }
  }
  return kept;
}

/// sample_reached_surface() without the lights that are no surface.
scene::SurfaceSamples sample_surfaces(const Bvh& bvh, int64_t count,
                                      const scene::SamplerOptions& sampler, Sides sides,
                                      const ReachOptions& options, const ReachRecall& recall,
                                      PruneCounts* counts) {
  scene::SamplerOptions plain = sampler;
  plain.emissive_share = 0;
  const scene::SurfaceSamples probe = scene::sample_surface(bvh.scene(), kProbePoints, plain);
  const auto found = static_cast<double>(kept_samples(bvh, probe, sides, options, recall).size());
  const double share = std::max(1.0, found) / kProbePoints;
  // Draws three standard errors of the share more than it asks for.
  const double error = std::sqrt((1 - share) / (share * kProbePoints));
  double oversampling = (1 + 3 * error) / share;
  for (;;) {
    oversampling = std::min(oversampling, kMaxOversampling);
    const auto drawn = static_cast<int64_t>(std::ceil(static_cast<double>(count) * oversampling));
    scene::SurfaceSamples samples = scene::sample_surface(bvh.scene(), drawn, sampler);
    KeptSamples kept = kept_samples(bvh, samples, sides, options, recall);
    const int64_t left = kept.size();
    if (left < count && oversampling < kMaxOversampling) {
      oversampling *=
          1.05 * static_cast<double>(count) / static_cast<double>(std::max<int64_t>(1, left));
      continue;
    }
    if (left == 0) return scene::sample_surface(bvh.scene(), count, sampler);
    counts->drawn = drawn;
    counts->pruned = drawn - left;
    reduce_samples(bvh.scene(), std::move(kept), count, &samples);
    return samples;
  }
}

}  // namespace

std::vector<uint8_t> reached(const Bvh& bvh, std::span<const Vec3> positions,
                             std::span<const Vec3> normals, Sides sides,
                             const ReachOptions& options) {
  check_search(positions, normals, options);
  return ReachSearch(bvh, positions, normals, sides, options).run();
}

scene::SurfaceSamples sample_reached_surface(const Bvh& bvh, int64_t count,
                                             const scene::SamplerOptions& sampler, Sides sides,
                                             const ReachOptions& options, PruneCounts* counts) {
  return sample_reached_surface(bvh, count, sampler, sides, options, ReachRecall{}, counts);
}

scene::SurfaceSamples sample_reached_surface(const Bvh& bvh, int64_t count,
                                             const scene::SamplerOptions& sampler, Sides sides,
                                             const ReachOptions& options, const ReachRecall& recall,
                                             PruneCounts* counts) {
  LTE_CHECK(recall.rounds >= 1 && recall.rounds <= std::ssize(kPathsOfRounds),
            "rounds of the search for light: expected 1 to ", std::ssize(kPathsOfRounds), ", got ",
            recall.rounds);
  // Lights that are no surface are neither reached nor missed: they are added at the end.
  const scene::Scene& scene = bvh.scene();
  scene::SamplerOptions surfaces = sampler;
  surfaces.environment_share = 0;
  surfaces.punctual_lights = false;
  scene::SurfaceSamples samples =
      sample_surfaces(bvh, scene::surface_point_count(scene, count, sampler), surfaces, sides,
                      options, recall, counts);
  const double area = std::accumulate(samples.area.begin(), samples.area.end(), 0.0);
  scene::append_light_points(scene, count,
                             static_cast<float>(area / static_cast<double>(samples.size())),
                             sampler, &samples);
  return samples;
}

}  // namespace lte::pathtrace
