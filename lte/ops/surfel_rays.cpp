#include "lte/ops/surfel_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lte/base/math.h"
#include "lte/ops/dispatch.h"
#include "lte/ops/surfel_rays_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def(
      "see_surfels(Tensor position, Tensor directions, Tensor discs, Tensor geometry, "
      "Tensor first, Tensor member, float[] numbers, int[] size) -> Tensor");
}

namespace lte::ops {
namespace {

using Column = SurfelColumn;

constexpr int kMaxCells = 128;  ///< along an axis
/// A back that sends out less than this share of the front's light is the inside of a body: rays
/// come to it through gaps between discs only.
constexpr float kInside = 0.1f;

struct Disc {
  Vec3 position, normal;
  float radius;
  Rgb front, back;

  explicit Disc(const float* row)
      : position(at(row, Column::kPosition)),
        normal(at(row, Column::kNormal)),
        radius(row[Column::kRadius]),
        front(at(row, Column::kFront)),
        back(at(row, Column::kBack)) {}

  bool has_back() const { return luminance(back) > kInside * luminance(front); }

 private:
  static Vec3 at(const float* row, int64_t column) {
    return {row[column], row[column + 1], row[column + 2]};
  }
};

/// Finds a grid's place and the discs in its cells.
class GridMaker {
 public:
  GridMaker(const at::Tensor& discs, SurfelGrid* grid) : grid_(*grid) {
    const auto* rows = discs.const_data_ptr<float>();
    for (int64_t i = 0; i < discs.size(0); ++i) discs_.emplace_back(rows + i * kSurfelColumns);
  }

  void run() {
    if (!discs_.empty()) place();
    fill();
  }

 private:
  void place() {
    Bounds bounds;
    double radius = 0, area = 0, sent[3] = {0, 0, 0};
    for (const Disc& d : discs_) {
      bounds.extend(d.position - Vec3{d.radius, d.radius, d.radius});
      bounds.extend(d.position + Vec3{d.radius, d.radius, d.radius});
      radius += d.radius;
      area += d.radius * d.radius;
      for (int c = 0; c < 3; ++c) sent[c] += d.radius * d.radius * d.front[c];
    }
    const Vec3 extent = bounds.extent();
    cell_ = std::max({2 * static_cast<float>(radius / static_cast<double>(discs_.size())),
                      max_component(extent) / kMaxCells, 1e-6f});
    low_ = bounds.low;
    grid_.cell = cell_;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<size_t>(axis);
      grid_.low[a] = low_[axis];
      grid_.ambient[a] = sent[axis] / std::max(area, 1e-30);
      grid_.size[a] = std::clamp(static_cast<int>(extent[axis] / cell_) + 1, 1, kMaxCells + 1);
    }
  }

  void fill() {
    const auto& size = grid_.size;
    const int64_t cells = size[0] * size[1] * size[2];
    std::vector<int64_t> next(static_cast<size_t>(cells) + 1, 0);
    visit([&](size_t cell, size_t) { ++next[cell + 1]; });
    for (size_t cell = 1; cell < next.size(); ++cell) next[cell] += next[cell - 1];
    const int64_t E = next.back();
    TORCH_CHECK(E < std::numeric_limits<int32_t>::max(), "make_surfel_grid: ", discs_.size(),
                " discs lie in too many cells: ", E);
    grid_.first = at::empty({cells + 1}, at::kInt);
    std::copy(next.begin(), next.end(), grid_.first.data_ptr<int32_t>());
    grid_.member = at::empty({E}, at::kInt);
    grid_.geometry = at::zeros({kSurfelGeometry, E + kSurfelPadding}, at::kFloat);
    auto* member = grid_.member.data_ptr<int32_t>();
    auto* geometry = grid_.geometry.data_ptr<float>();
    const int64_t stride = grid_.geometry.size(1);
    visit([&](size_t cell, size_t i) {
      const int64_t entry = next[cell]++;
      const Disc& d = discs_[i];
      member[entry] = static_cast<int32_t>(i);
      for (int axis = 0; axis < 3; ++axis) {
        geometry[axis * stride + entry] = d.position[axis];
        geometry[(3 + axis) * stride + entry] = d.normal[axis];
      }
      geometry[6 * stride + entry] = d.has_back() ? d.radius : -d.radius;
    });
  }

  /// Calls each(cell, disc) for the cells that a disc may reach into.
  template <typename Each>
  void visit(const Each& each) const {
    const auto& size = grid_.size;
    for (size_t i = 0; i < discs_.size(); ++i) {
      const Disc& d = discs_[i];
      int64_t from[3], to[3];
      for (int axis = 0; axis < 3; ++axis) {
        const float reach =
            d.radius * std::sqrt(std::max(0.0f, 1 - d.normal[axis] * d.normal[axis]));
        const auto cell = [&](float at) {
          return std::clamp<int64_t>(static_cast<int64_t>((at - low_[axis]) / cell_), 0,
                                     size[static_cast<size_t>(axis)] - 1);
        };
        // A little more, so that rounding loses no place of the disc.
        from[axis] = cell(d.position[axis] - reach - 1e-3f * cell_);
        to[axis] = cell(d.position[axis] + reach + 1e-3f * cell_);
      }
      for (int64_t z = from[2]; z <= to[2]; ++z)
        for (int64_t y = from[1]; y <= to[1]; ++y)
          for (int64_t x = from[0]; x <= to[0]; ++x)
            each(static_cast<size_t>((z * size[1] + y) * size[0] + x), i);
    }
  }

  std::vector<Disc> discs_;
  SurfelGrid& grid_;
  Vec3 low_;
  float cell_ = 1;
};

}  // namespace

SurfelGrid make_surfel_grid(const at::Tensor& discs) {
  TORCH_CHECK(discs.dim() == 2, "make_surfel_grid: discs must be [M, ", kSurfelColumns, "], got ",
              discs.sizes());
  check_shape(discs, {discs.size(0), kSurfelColumns}, at::kFloat, "make_surfel_grid", "discs");
  SurfelGrid grid;
  GridMaker(discs.cpu().contiguous(), &grid).run();
  grid.discs = discs.contiguous();
  for (at::Tensor* t : {&grid.geometry, &grid.first, &grid.member}) *t = t->to(discs.device());
  return grid;
}

at::Tensor see_surfels(const at::Tensor& position, const at::Tensor& directions,
                       const SurfelGrid& grid) {
  using Signature =
      at::Tensor(const at::Tensor&, const at::Tensor&, const at::Tensor&, const at::Tensor&,
                 const at::Tensor&, const at::Tensor&, at::ArrayRef<double>, at::IntArrayRef);
  static const auto op = find_operator<Signature>("lte::see_surfels");
  return op.call(position, directions, grid.discs, grid.geometry, grid.first, grid.member,
                 numbers_of(grid), grid.size);
}

}  // namespace lte::ops
