#include "experiments/guiding/guide_table.h"

#include <algorithm>

#include "lte/base/check.h"

namespace lte::experiments {

using namespace pathtrace;

namespace {

constexpr float kBelowOne = 1 - 0x1p-24f;

}  // namespace

bool takes_first(float share, float* u) {
  const bool first = *u < share;
  *u = std::min(first ? *u / share : (*u - share) / (1 - share), kBelowOne);
  return first;
}

GuideTable::GuideTable(const DirectionMap& map, float even_share)
    : GuideTable(map.bins, map.normal) {
  check(map, even_share);
  std::vector<double> weight(map.radiance.size());
  std::transform(map.radiance.begin(), map.radiance.end(), weight.begin(), luminance);
  fill(weight, even_share);
}

void GuideTable::check(const DirectionMap& map, float even_share) {
  const size_t cells = map.radiance.size();
  LTE_CHECK(map.bins >= 2 && map.bins % 2 == 0 && cells == static_cast<size_t>(map.bins) * map.bins,
            "a guide needs an even number of bins and their square of cells, got ", map.bins,
            " and ", cells);
  LTE_CHECK(even_share > 0 && even_share <= 1, "a guide's even share must lie in (0, 1], got ",
            even_share);
  for (size_t i = 0; i < cells; ++i) {
    const Rgb& light = map.radiance[i];
    LTE_CHECK(is_finite(light) && light.x >= 0 && light.y >= 0 && light.z >= 0,
              "a guide's radiance must be finite and not negative, in cell ", i);
  }
}

void GuideTable::fill(const std::vector<double>& weight, float even_share) {
  double sum = 0;
  for (const double w : weight) sum += w;
  const double even = sum > 0 ? double{even_share} : 1;
  const auto cells = static_cast<double>(weight.size());
  double below = 0;
  for (const double w : weight) {
    const double share = even / cells + (sum > 0 ? (1 - even) * w / sum : 0);
    share_.push_back(static_cast<float>(share));
    below_.push_back(below += share);
  }
}

Vec3 GuideTable::centre(size_t cell) const {
  const auto at = static_cast<int>(cell);
  return frame_.to_world(bin_centre(bins_, at / bins_, at % bins_));
}

float GuideTable::pdf(const Vec3& direction) const {
  const Vec3 local = frame_.to_local(direction);
  if (!(local.z > 0)) return 0;
  const Vec2 place = bin_place(local);
  const auto at = [this](float x) {
    return std::min(static_cast<int>(x * static_cast<float>(bins_)), bins_ - 1);
  };
  const auto cell = static_cast<size_t>(at(place.y) * bins_ + at(place.x));
  // A cell has a projected solid angle of π / bins².
  return share_[cell] * static_cast<float>(share_.size()) * local.z / kPi;
}

Vec3 GuideTable::sample(const Vec2& u) const {
  const auto found = std::upper_bound(below_.begin(), below_.end(), double{u.x});
  const auto cell = std::min(static_cast<size_t>(found - below_.begin()), share_.size() - 1);
  const double before = cell == 0 ? 0 : below_[cell - 1];
  const float inside =
      std::clamp(static_cast<float>((u.x - before) / share_[cell]), 0.0f, kBelowOne);
  const auto n = static_cast<size_t>(bins_);
  const auto row = static_cast<float>(cell / n), column = static_cast<float>(cell % n);
  const auto size = static_cast<float>(bins_);
  return frame_.to_world(bin_direction({(column + inside) / size, (row + u.y) / size}));
}

}  // namespace lte::experiments
