#include "infer/check/light_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "infer/check/checked_regions.h"
#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/gi/expected_error.h"
#include "lte/pathtrace/irradiance.h"

namespace lte::infer {
namespace {

// Few, so that the paths come from many places.
constexpr int kPathsAtOnce = 4;
/// In whose time a path of the check is traced, ten times.
constexpr int64_t kRaysOfPath = 32;
// Regions are cut in two as long as both halves know their ratio to this.
constexpr double kRegionError = 0.04;
// An error below this share of all light that reaches the surfaces is not seen.
constexpr double kSeen = 0.01;
// What regions are off by counts by their share of the places: a fiftieth of a picture that is off
// by a tenth is nothing to warn of.
constexpr double kMinFault = 0.01;
// Estimates keep two colors a place: blocks bound that memory.
constexpr size_t kEstimateBlock = size_t{1} << 20;
// Streams of what suspects and of what confirms.
constexpr uint64_t kSuspect = 51, kConfirm = 52, kPlaces = 53;

double mean(const Rgb& color) { return (double{color.x} + double{color.y} + double{color.z}) / 3; }

using Ratio = BatchSums::Ratio;

/// Whether an answer is off by more than is let pass and by more than chance explains.
bool is_off(const Ratio& ratio, double let_pass, size_t tests) {
  const double off = std::fabs(ratio.ratio - 1);
  return ratio.sums.traced > 0 && off > let_pass &&
         off > three_errors(tests, kCheckBatches) * ratio.standard_error &&
         std::fabs(ratio.sums.answered - ratio.sums.traced) > kSeen * ratio.sums.all;
}

class Checker {
 public:
  Checker(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights, const AnsweredLight& answered,
          const CheckOptions& options)
      : bvh_(bvh),
        lights_(lights),
        answered_(answered),
        options_(options),
        tree_(answered.position),
        first_(tree_.cells(), kCheckBatches),
        second_(tree_.cells(), kCheckBatches) {}

  LightCheck run() {
    LightCheck out;
    suspect();
    std::vector<Region> regions;
    divide(1, &regions);
    Region whole{1, first_.ratio(tree_.cells_of(1))};
    out.whole.off = is_off(whole.found, kCheckedOff, 1);
    size_t suspicions = out.whole.off ? 1 : 0;
    for (Region& region : regions) {
      region.off = is_off(region.found, kCheckedRegionOff, 1);
      suspicions += region.off ? 1 : 0;
    }
    if (suspicions > 0) confirm(out.whole.off, regions);
    settle(&whole, &out.whole, kCheckedOff, suspicions);
    std::vector<Region> wrong;
    out.region_of.resize(answered_.size());
    for (Region& region : regions) {
      out.regions.emplace_back().off = region.off;
      settle(&region, &out.regions.back(), kCheckedRegionOff, suspicions);
      if (out.regions.back().off) wrong.push_back(region);
      for (const uint32_t place : tree_.places(region.node))
        out.region_of[place] = static_cast<int32_t>(out.regions.size()) - 1;
    }
    if (!wrong.empty()) out.fault = fault_of(wrong);
    if (out.fault && out.fault->share * std::fabs(out.fault->ratio - 1) < kMinFault)
      out.fault.reset();
    out.paths = paths_;
    out.seconds = timer_.seconds();
    return out;
  }

 private:
  struct Region {
    size_t node;
    Ratio found;
    bool off = false;
  };

  /// Adds paths until the regions are as small as the tree has them, or count or time are used.
  void suspect() {
    std::vector<uint32_t> ranks(answered_.size());
    std::iota(ranks.begin(), ranks.end(), uint32_t{0});
    for (uint64_t round = 0; paths_ == 0 || may_go_on(); ++round)
      trace(ranks, std::max(kMinCheckPaths, paths_), hash_combine(kSuspect, round), &first_);
  }

  /// Whether twice the paths would still be of use, and leave time to confirm what they suspect.
  bool may_go_on() const {
    if (2 * paths_ > options_.max_paths || 4 * timer_.seconds() > options_.seconds) return false;
    std::vector<Region> regions;
    divide(1, &regions);
    return regions.size() < tree_.cells();
  }

  /// With fresh paths from the suspected places.
  void confirm(bool whole, const std::vector<Region>& regions) {
    std::vector<uint32_t> ranks;
    const auto add = [&](size_t node) {
      const auto first = tree_.places(node).data() - tree_.order().data();
      for (size_t i = 0; i < tree_.places(node).size(); ++i)
        ranks.push_back(static_cast<uint32_t>(first) + static_cast<uint32_t>(i));
    };
    if (whole) add(1);
    for (const Region& region : regions) {
      if (!whole && region.off) add(region.node);
    }
    const double left = std::max(0.0, options_.seconds - timer_.seconds()) / timer_.seconds();
    const auto paths = static_cast<double>(paths_) * std::min(left, 1.0);
    trace(ranks, std::max(kMinCheckPaths, static_cast<int64_t>(paths)), kConfirm, &second_);
  }

  /// @param ranks  of the places in the tree's order
  void trace(const std::vector<uint32_t>& ranks, int64_t paths, uint64_t stream, BatchSums* sums) {
    const auto in_batch = static_cast<size_t>(paths / (kPathsAtOnce * kCheckBatches));
    const std::vector<uint32_t> drawn = draw(ranks, in_batch, stream);
    for (size_t begin = 0; begin < drawn.size(); begin += kEstimateBlock) {
      const size_t count = std::min(kEstimateBlock, drawn.size() - begin);
      const pathtrace::Irradiance traced =
          estimate(std::span(drawn).subspan(begin, count), stream, begin);
      for (size_t i = 0; i < count; ++i) {
        const uint32_t rank = drawn[begin + i];
        const double direct = mean(traced.direct_sum(static_cast<int64_t>(i)));
        const double indirect = mean(traced.indirect_sum(static_cast<int64_t>(i)));
        sums->at(tree_.cell_of_rank(rank), (begin + i) / in_batch) +=
            {mean(answered_.irradiance[tree_.order()[rank]]), indirect, direct + indirect};
      }
    }
    paths_ += static_cast<int64_t>(drawn.size()) * kPathsAtOnce;
  }

  /// Batch by batch, one in each of as many equal parts of the ranks: evenly over regions.
  std::vector<uint32_t> draw(const std::vector<uint32_t>& ranks, size_t in_batch,
                             uint64_t stream) const {
    Rng rng(hash_combine(options_.seed, kPlaces), stream);
    std::vector<uint32_t> out;
    out.reserve(in_batch * kCheckBatches);
    const double part = static_cast<double>(ranks.size()) / static_cast<double>(in_batch);
    for (int batch = 0; batch < kCheckBatches; ++batch) {
      for (size_t k = 0; k < in_batch; ++k) {
        const double at = (static_cast<double>(k) + double{rng.uniform()}) * part;
        out.push_back(ranks[std::min(static_cast<size_t>(at), ranks.size() - 1)]);
      }
    }
    return out;
  }

  pathtrace::Irradiance estimate(std::span<const uint32_t> ranks, uint64_t stream,
                                 size_t first_index) const {
    std::vector<Vec3> positions, normals;
    for (const uint32_t rank : ranks) {
      positions.push_back(answered_.position[tree_.order()[rank]]);
      normals.push_back(answered_.normal[tree_.order()[rank]]);
    }
    pathtrace::IrradianceOptions options;
    options.rays = kPathsAtOnce;
    options.max_depth = options_.max_depth;
    options.seed = hash_combine(options_.seed, stream);
    options.variance = options.by_group = false;
    return pathtrace::estimate_irradiance(bvh_, lights_, positions, normals, options,
                                          static_cast<int64_t>(first_index));
  }

  void divide(size_t node, std::vector<Region>* out) const {
    const auto known = [&](size_t half) {
      const Ratio found = first_.ratio(tree_.cells_of(half));
      return found.sums.traced > 0 && found.standard_error <= kRegionError;
    };
    if (tree_.is_cell(node) || !known(2 * node) || !known(2 * node + 1)) {
      out->push_back({node, first_.ratio(tree_.cells_of(node))});
      return;
    }
    divide(2 * node, out);
    divide(2 * node + 1, out);
  }

  /// A suspicion gives way to what the fresh paths have found.
  /// @param out  its `off` says whether there is one, and then whether it is confirmed
  void settle(Region* region, CheckedRatio* out, double let_pass, size_t suspicions) const {
    if (out->off) {
      region->found = second_.ratio(tree_.cells_of(region->node));
      out->off = is_off(region->found, let_pass, suspicions);
    }
    out->ratio = region->found.ratio;
    out->standard_error = region->found.standard_error;
    const double shift = out->ratio - 1;
    out->expected_square = out->off ? shift * shift + std::pow(out->standard_error, 2)
                                    : gi::shifted_square(shift, out->standard_error);
    out->share = share_of(region->node);
    out->centre = centre_of(region->node);
  }

  double share_of(size_t node) const {
    return static_cast<double>(tree_.places(node).size()) / static_cast<double>(answered_.size());
  }

  Vec3 centre_of(size_t node) const {
    std::array<double, 3> sum{};
    const auto places = tree_.places(node);
    for (const uint32_t place : places) {
      for (int axis = 0; axis < 3; ++axis)
        sum[static_cast<size_t>(axis)] += double{answered_.position[place][axis]};
    }
    const double share = 1 / static_cast<double>(places.size());
    const Vec3 middle{static_cast<float>(sum[0] * share), static_cast<float>(sum[1] * share),
                      static_cast<float>(sum[2] * share)};
    const auto nearest =
        std::min_element(places.begin(), places.end(), [&](uint32_t a, uint32_t b) {
          return length(answered_.position[a] - middle) < length(answered_.position[b] - middle);
        });
    return answered_.position[*nearest];
  }

  static double error_of(const Region& region) {
    return region.found.sums.answered - region.found.sums.traced;
  }

  CheckedRatio fault_of(const std::vector<Region>& wrong) const {
    double below = 0, above = 0;
    for (const Region& region : wrong) (error_of(region) < 0 ? below : above) += error_of(region);
    const bool dark = -below >= above;
    CheckedRatio out;
    out.share = 0;
    std::vector<size_t> cells;
    const Region* worst = nullptr;
    for (const Region& region : wrong) {
      if ((error_of(region) < 0) != dark) continue;
      const auto [first, last] = tree_.cells_of(region.node);
      for (size_t cell = first; cell < last; ++cell) cells.push_back(cell);
      out.share += share_of(region.node);
      if (!worst || std::fabs(error_of(region)) > std::fabs(error_of(*worst))) worst = &region;
    }
    const Ratio found = second_.ratio(cells);
    out.ratio = found.ratio;
    out.standard_error = found.standard_error;
    out.centre = centre_of(worst->node);
    out.off = true;
    return out;
  }

  const pathtrace::Bvh& bvh_;
  const pathtrace::Lights& lights_;
  const AnsweredLight& answered_;
  const CheckOptions& options_;
  const PlaceTree tree_;
  BatchSums first_, second_;
  const Timer timer_;
  int64_t paths_ = 0;
};

}  // namespace

int64_t paths_to_check(int64_t rays) {
  return std::clamp(rays / kRaysOfPath, kMinCheckPaths, kMaxCheckPaths);
}

void AnsweredLight::add(const Vec3& at, const Vec3& side, const Rgb& light) {
  position.push_back(at);
  normal.push_back(side);
  irradiance.push_back(light);
}

LightCheck check_light(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                       const AnsweredLight& answered, const CheckOptions& options) {
  LTE_CHECK(
      answered.normal.size() == answered.size() && answered.irradiance.size() == answered.size(),
      "checked light: ", answered.size(), " places, ", answered.normal.size(), " normals and ",
      answered.irradiance.size(), " answers");
  for (const Rgb& light : answered.irradiance)
    LTE_CHECK(std::isfinite(mean(light)), "checked light: an answer is not finite");
  if (answered.size() == 0 || lights.empty()) return {};
  return Checker(bvh, lights, answered, options).run();
}

}  // namespace lte::infer
