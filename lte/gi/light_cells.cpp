#include "lte/gi/light_cells.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/random.h"

namespace lte::gi {
namespace {

constexpr size_t kFirstSlots = 1 << 10;
constexpr float kFinest = 1e-6f;  // metres
constexpr int kFinerLevels = 2;
/// Walls lie at round coordinates, where rounding would put a place now into one cell and now into
/// the next.
constexpr float kShift = 0.3183f;
/// Steps of a normal's component from 0 to 1. Normals along an axis lie in the middle of a step.
constexpr float kTurns = 3;

/// Two cells of 2^20 share a number with a chance of 3e-8.
uint64_t key_of(const Vec3& position, const Vec3& normal, float extent) {
  const int level = std::ilogb(std::max(extent, kFinest)) + 1;
  const float scale = std::ldexp(1.0f, -level);
  uint64_t key = static_cast<uint64_t>(level + 1024);
  for (int k = 0; k < 3; ++k) {
    const auto cell = static_cast<int64_t>(std::floor(position[k] * scale + kShift));
    const auto turn = static_cast<int64_t>(std::lround(normal[k] * kTurns));
    key = hash_combine(key, static_cast<uint64_t>(8 * cell + turn));
  }
  return std::max<uint64_t>(key, 1);
}

void add_rays(const Rgb& other, float other_rays, Rgb* mean, float* rays) {
  if (!(other_rays > 0)) return;
  *rays += other_rays;
  *mean += (other - *mean) * (other_rays / *rays);
}

}  // namespace

void CellLight::add(const CellLight& other) {
  add_rays(other.direct, other.direct_rays, &direct, &direct_rays);
  add_rays(other.indirect, other.indirect_rays, &indirect, &indirect_rays);
}

LightCells::LightCells(int64_t most) : most_(most), cells_(kFirstSlots) {
  LTE_CHECK(most >= 1, "cells of light: at least 1 must be kept, got ", most);
}

int LightCells::begin_view() {
  // Those of the last view and of the one before stay, or all would go if views take turns.
  if (size_ > most_) rebuild(kFirstSlots, views_ - 2);
  return views_++;
}

const CellLight* LightCells::find(const Vec3& position, const Vec3& normal, float extent) const {
  const Cell& cell = cells_[known_slot(position, normal, extent)];
  return cell.key != 0 ? &cell.light : nullptr;
}

size_t LightCells::known_slot(const Vec3& position, const Vec3& normal, float extent) const {
  const size_t own = slot(key_of(position, normal, extent));
  size_t at = own;
  for (int finer = 1; finer <= kFinerLevels && cells_[at].key == 0; ++finer)
    at = slot(key_of(position, normal, std::ldexp(extent, -finer)));
  return cells_[at].key != 0 ? at : own;
}

void LightCells::add(const Vec3& position, const Vec3& normal, float extent,
                     const CellLight& light) {
  const uint64_t key = key_of(position, normal, extent);
  size_t at = slot(key);
  if (cells_[at].key == 0) {
    Cell& known = cells_[known_slot(position, normal, extent)];
    const CellLight before = known.light;
    if (known.key != 0) known.view = std::max(views_ - 1, 0);
    if (!(light.direct_rays > 0) && !(light.indirect_rays > 0)) return;
    if (2 * static_cast<size_t>(size_ + 1) > cells_.size()) {
      rebuild(2 * cells_.size(), 0);
      at = slot(key);
    }
    cells_[at].key = key;
    cells_[at].light = before;
    ++size_;
  }
  cells_[at].view = std::max(views_ - 1, 0);
  cells_[at].light.add(light);
}

/// Where the cell stands, or the empty slot for it.
size_t LightCells::slot(uint64_t key) const {
  const size_t mask = cells_.size() - 1;
  size_t at = key & mask;
  while (cells_[at].key != 0 && cells_[at].key != key) at = (at + 1) & mask;
  return at;
}

void LightCells::rebuild(size_t slots, int oldest_view) {
  std::vector<Cell> old = std::move(cells_);
  const auto stays = [&](const Cell& cell) { return cell.key != 0 && cell.view >= oldest_view; };
  size_ = std::count_if(old.begin(), old.end(), stays);
  while (slots < 2 * static_cast<size_t>(size_ + 1)) slots *= 2;
  cells_.assign(slots, {});
  for (const Cell& cell : old) {
    if (stays(cell)) cells_[slot(cell.key)] = cell;
  }
}

}  // namespace lte::gi
