#include "infer/check/checked_regions.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lte::infer {

PlaceTree::PlaceTree(std::span<const Vec3> places) : order_(places.size()) {
  std::iota(order_.begin(), order_.end(), uint32_t{0});
  while (depth_ < kMaxDepth && (places.size() >> (depth_ + 1)) >= kMinPlaces) ++depth_;
  cut(places, 1, 0);
}

void PlaceTree::cut(std::span<const Vec3> places, size_t node, int depth) {
  if (depth == depth_) return;
  const size_t index = node - (size_t{1} << depth);
  const auto first = order_.begin() + static_cast<std::ptrdiff_t>(begin_of(depth, index));
  const auto middle =
      order_.begin() + static_cast<std::ptrdiff_t>(begin_of(depth + 1, 2 * index + 1));
  const auto last = order_.begin() + static_cast<std::ptrdiff_t>(begin_of(depth, index + 1));
  Bounds bounds;
  for (auto i = first; i != last; ++i) bounds.extend(places[*i]);
  const Vec3 extent = bounds.extent();
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  std::nth_element(first, middle, last, [&](uint32_t a, uint32_t b) {
    const float at_a = places[a][axis], at_b = places[b][axis];
    return at_a != at_b ? at_a < at_b : a < b;  // the same order everywhere
  });
  cut(places, 2 * node, depth + 1);
  cut(places, 2 * node + 1, depth + 1);
}

std::span<const uint32_t> PlaceTree::places(size_t node) const {
  int depth = 0;
  while ((node >> (depth + 1)) != 0) ++depth;
  const size_t index = node - (size_t{1} << depth);
  const size_t begin = begin_of(depth, index);
  return std::span(order_).subspan(begin, begin_of(depth, index + 1) - begin);
}

PlaceTree::CellRange PlaceTree::cells_of(size_t node) const {
  size_t first = node, last = node + 1;
  while (!is_cell(first)) {
    first *= 2;
    last *= 2;
  }
  return {first - cells(), last - cells()};
}

size_t PlaceTree::cell_of_rank(size_t rank) const {
  // begin_of() is a floor, so the quotient is right or one too low.
  size_t cell = (rank << depth_) / order_.size();
  while (cell + 1 < cells() && begin_of(depth_, cell + 1) <= rank) ++cell;
  return cell;
}

void LightSums::operator+=(const LightSums& other) {
  answered += other.answered;
  traced += other.traced;
  all += other.all;
}

BatchSums::Ratio BatchSums::ratio(std::span<const size_t> cells) const {
  std::vector<LightSums> of_batch(batches_);
  for (const size_t cell : cells) {
    for (size_t b = 0; b < batches_; ++b) of_batch[b] += sums_[cell * batches_ + b];
  }
  return from_batches(of_batch);
}

BatchSums::Ratio BatchSums::ratio(PlaceTree::CellRange cells) const {
  std::vector<size_t> list(cells.last - cells.first);
  std::iota(list.begin(), list.end(), cells.first);
  return ratio(list);
}

BatchSums::Ratio BatchSums::from_batches(const std::vector<LightSums>& of_batch) const {
  Ratio out;
  for (const LightSums& batch : of_batch) out.sums += batch;
  if (!(out.sums.traced > 0)) return out;
  out.ratio = out.sums.answered / out.sums.traced;
  double squares = 0;
  for (const LightSums& batch : of_batch)
    squares += std::pow(batch.answered - out.ratio * batch.traced, 2);
  const auto count = static_cast<double>(batches_);
  out.standard_error = std::sqrt(squares * count / (count - 1)) / out.sums.traced;
  return out;
}

double three_errors(size_t tests, size_t batches) {
  const double tail =
      std::erfc(3 / std::sqrt(2.0)) / static_cast<double>(std::max<size_t>(tests, 1));
  double low = 0, high = 40;  // erfc(high / sqrt 2) is still above 0
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (std::erfc(middle / std::sqrt(2.0)) > tail ? low : high) = middle;
  }
  // Student's quantile from the normal one (Cornish and Fisher).
  const double z = low, n = static_cast<double>(batches) - 1, z2 = z * z;
  return z + z * (z2 + 1) / (4 * n) + z * (5 * z2 * z2 + 16 * z2 + 3) / (96 * n * n);
}

}  // namespace lte::infer
