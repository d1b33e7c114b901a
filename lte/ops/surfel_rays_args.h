// What see_surfels() accepts, and its grid as the walk reads it.
#pragma once

#include "lte/ops/arguments.h"
#include "lte/ops/surfel_rays.h"
#include "lte/ops/surfel_walk.h"

namespace lte::ops {

/// Columns of geometry past the last disc of a grid, which loops over lanes may read.
inline constexpr int64_t kSurfelPadding = 16;

inline void check_see_surfels_args(const at::Tensor& position, const at::Tensor& directions,
                                   const SurfelGrid& grid) {
  const char* op = "see_surfels";
  TORCH_CHECK(directions.dim() == 3, op, ": directions must be [Q, N, 3], got ",
              directions.sizes());
  check_shape(directions, {directions.size(0), directions.size(1), 3}, at::kFloat, op,
              "directions");
  check_shape(position, {directions.size(0), 3}, at::kFloat, op, "position");
  const int64_t E = grid.member.numel(), cells = grid.size[0] * grid.size[1] * grid.size[2];
  TORCH_CHECK(grid.discs.dim() == 2, op, ": the grid must be of make_surfel_grid()");
  check_shape(grid.discs, {grid.discs.size(0), kSurfelColumns}, at::kFloat, op, "discs");
  check_shape(grid.geometry, {kSurfelGeometry, E + kSurfelPadding}, at::kFloat, op, "geometry");
  check_shape(grid.first, {cells + 1}, at::kInt, op, "first");
  check_shape(grid.member, {E}, at::kInt, op, "member");
  for (const at::Tensor& t : {directions, grid.discs, grid.geometry, grid.first, grid.member})
    check_device(t, "directions and the grid", position, "positions", op);
}

/// @param grid  of contiguous tensors
inline SurfelView view_of(const SurfelGrid& grid) {
  SurfelView view{};
  view.discs = grid.discs.const_data_ptr<float>();
  view.geometry = grid.geometry.const_data_ptr<float>();
  view.stride = grid.geometry.size(1);
  view.first = grid.first.const_data_ptr<int32_t>();
  view.member = grid.member.const_data_ptr<int32_t>();
  view.cell = static_cast<float>(grid.cell);
  const auto number = [](double value) { return static_cast<float>(value); };
  for (size_t axis = 0; axis < 3; ++axis) {
    view.low[axis] = number(grid.low[axis]);
    view.size[axis] = static_cast<int>(grid.size[axis]);
  }
  view.ambient = {number(grid.ambient[0]), number(grid.ambient[1]), number(grid.ambient[2])};
  return view;
}

/// The numbers of a grid as the schema takes them: low, ambient and cell.
inline std::array<double, 7> numbers_of(const SurfelGrid& grid) {
  return {grid.low[0],     grid.low[1],     grid.low[2], grid.ambient[0],
          grid.ambient[1], grid.ambient[2], grid.cell};
}

/// The grid from what the schema takes, its tensors contiguous.
inline SurfelGrid grid_of(const at::Tensor& discs, const at::Tensor& geometry,
                          const at::Tensor& first, const at::Tensor& member,
                          at::ArrayRef<double> numbers, at::IntArrayRef size) {
  TORCH_CHECK(numbers.size() == 7 && size.size() == 3,
              "see_surfels: the grid must be of make_surfel_grid()");
  return {discs.contiguous(),
          geometry.contiguous(),
          first.contiguous(),
          member.contiguous(),
          {numbers[0], numbers[1], numbers[2]},
          {numbers[3], numbers[4], numbers[5]},
          numbers[6],
          {size[0], size[1], size[2]}};
}

}  // namespace lte::ops
