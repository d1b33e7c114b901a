#include "lte/gi/surface_index.h"

#include <algorithm>
#include <array>
#include <bit>

#include "lte/base/check.h"
#include "lte/base/random.h"

namespace lte::gi {
namespace {

constexpr float kMaxRadii = 8;    // of the mean
constexpr float kMaxCells = 6;    // edges of a cell in the largest radius
constexpr double kAxisBits = 20;  // of a cell's coordinate
constexpr float kSlack = 1e-4f;   // of a cosine

/// 2 * axis, and 1 more for the negative direction.
int nearest_axis(const Vec3& n) {
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (std::fabs(n[k]) > std::fabs(n[axis])) axis = k;
  }
  return 2 * axis + (n[axis] < 0 ? 1 : 0);
}

/// The largest cosine between `n` and any normal whose nearest axis this is: the length of n's
/// projection onto the cone of such normals, a pyramid, by its interior, faces and edges.
float cosine_to_bin(const Vec3& n, int bin) {
  const int axis = bin / 2;
  const float a = bin % 2 == 0 ? n[axis] : -n[axis];
  const float b = std::fabs(n[(axis + 1) % 3]), c = std::fabs(n[(axis + 2) % 3]);
  if (a >= b && a >= c) return 1;
  float best = (a + b + c) / std::sqrt(3.0f);
  for (const auto& [face, other] : {std::array{b, c}, std::array{c, b}}) {
    const float along = (a + face) / 2;
    if (along > 0 && other <= along)
      best = std::max(best, std::sqrt(2 * along * along + other * other));
  }
  return best;
}

}  // namespace

SurfaceIndex::SurfaceIndex(std::span<const Vec3> positions, std::span<const Vec3> normals,
                           std::span<const float> radii, float cell_edge) {
  LTE_CHECK(positions.size() == normals.size() && positions.size() == radii.size(),
            "surface points: ", positions.size(), " positions, ", normals.size(), " normals and ",
            radii.size(), " radii");
  if (positions.empty()) return;
  double sum = 0;
  Bounds bounds;
  for (size_t i = 0; i < positions.size(); ++i) {
    LTE_CHECK(is_finite(positions[i]) && is_finite(normals[i]), "surface point ", i,
              " is not finite");
    LTE_CHECK(std::isfinite(radii[i]) && radii[i] > 0, "surface point ", i, ": radius ", radii[i],
              ", expected a positive one");
    sum += radii[i];
    bounds.extend(positions[i]);
  }
  const auto mean = static_cast<float>(sum / static_cast<double>(positions.size()));
  float largest = 0;
  points_.reserve(positions.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    const float radius = std::min(radii[i], kMaxRadii * mean);
    largest = std::max(largest, radius);
    points_.push_back({positions[i], 1 / (radius * radius), normals[i], radius});
  }
  low_ = bounds.low - Vec3{largest, largest, largest};
  const float extent = max_component(bounds.extent()) + 2 * largest;
  const float finest = extent * static_cast<float>(std::exp2(1 - kAxisBits));
  inverse_edge_ = 1 / std::max({cell_edge * mean, largest / kMaxCells, finest});

  cells_.assign(64, {});
  size_t used = 0;
  const auto count = [&](uint64_t key) {
    if (2 * (used + 1) > cells_.size()) {
      std::vector<Cell> old(2 * cells_.size());
      old.swap(cells_);
      for (const Cell& cell : old) {
        if (cell.key != kEmpty) slot(cell.key) = cell;
      }
    }
    Cell& cell = slot(key);
    if (cell.key == kEmpty) ++used;
    cell.key = key;
    ++cell.end;
  };
  for (const Point& point : points_) for_each_list(point, count);
  uint32_t begin = 0;
  for (Cell& cell : cells_) {
    const uint32_t length = cell.end;
    cell.begin = cell.end = begin;
    begin += length;
  }
  listed_.resize(begin);
  for (uint32_t i = 0; i < points_.size(); ++i)
    for_each_list(points_[i], [&](uint64_t key) { listed_[slot(key).end++] = i; });
}

void SurfaceIndex::pack() {
  constexpr uint32_t kLanes = SurfaceLanes::kLanes;
  if (!lanes_.empty()) return;
  uint32_t blocks = 0;
  for (const Cell& cell : cells_) blocks += (cell.end - cell.begin + kLanes - 1) / kLanes;
  lanes_.resize(blocks);
  blocks = 0;
  for (Cell& cell : cells_) {
    const uint32_t begin = blocks;
    for (uint32_t k = cell.begin; k < cell.end; ++k) {
      const uint32_t lane = (k - cell.begin) % kLanes;
      SurfaceLanes& block = lanes_[begin + (k - cell.begin) / kLanes];
      const Point& point = points_[listed_[k]];
      block.x[lane] = point.position.x;
      block.y[lane] = point.position.y;
      block.z[lane] = point.position.z;
      block.normal_x[lane] = point.normal.x;
      block.normal_y[lane] = point.normal.y;
      block.normal_z[lane] = point.normal.z;
      block.inverse_radius2[lane] = point.inverse_radius2;
      block.point[lane] = listed_[k];
    }
    blocks += (cell.end - cell.begin + kLanes - 1) / kLanes;
    cell.begin = begin;
    cell.end = blocks;
  }
  listed_ = {};
}

SurfaceIndex::Cell& SurfaceIndex::slot(uint64_t key) {
  size_t at = mix_bits(key) & (cells_.size() - 1);
  while (cells_[at].key != kEmpty && cells_[at].key != key) at = (at + 1) & (cells_.size() - 1);
  return cells_[at];
}

template <typename Use>
void SurfaceIndex::for_each_list(const Point& point, const Use& use) const {
  std::array<int64_t, 3> first, last;
  for (int k = 0; k < 3; ++k) {
    const float along = point.normal[k];
    const float reach =
        point.radius * (std::sqrt(std::max(0.0f, 1 - along * along)) + kPlane * std::fabs(along));
    const float p = point.position[k] - low_[k];
    first[static_cast<size_t>(k)] =
        std::clamp<int64_t>(static_cast<int64_t>((p - reach) * inverse_edge_), 0, kCells - 1);
    last[static_cast<size_t>(k)] =
        std::clamp<int64_t>(static_cast<int64_t>((p + reach) * inverse_edge_), 0, kCells - 1);
  }
  for (int bin = 0; bin < 6; ++bin) {
    if (cosine_to_bin(point.normal, bin) < kMinCosine - kSlack) continue;
    for (int64_t z = first[2]; z <= last[2]; ++z) {
      for (int64_t y = first[1]; y <= last[1]; ++y) {
        for (int64_t x = first[0]; x <= last[0]; ++x)
          use(static_cast<uint64_t>(bin) << 60 | static_cast<uint64_t>(z) << 40 |
              static_cast<uint64_t>(y) << 20 | static_cast<uint64_t>(x));
      }
    }
  }
}

const SurfaceIndex::Cell* SurfaceIndex::find(const Vec3& position, const Vec3& normal) const {
  if (cells_.empty()) return nullptr;
  const Vec3 p = (position - low_) * inverse_edge_;
  const auto inside = [](float x) { return x >= 0 && x < static_cast<float>(kCells); };
  if (!inside(p.x) || !inside(p.y) || !inside(p.z)) return nullptr;
  const uint64_t key = static_cast<uint64_t>(nearest_axis(normal)) << 60 |
                       static_cast<uint64_t>(p.z) << 40 | static_cast<uint64_t>(p.y) << 20 |
                       static_cast<uint64_t>(p.x);
  for (size_t at = mix_bits(key) & (cells_.size() - 1);; at = (at + 1) & (cells_.size() - 1)) {
    const Cell& cell = cells_[at];
    if (cell.key == key) return &cell;
    if (cell.key == kEmpty) return nullptr;
  }
}

}  // namespace lte::gi
