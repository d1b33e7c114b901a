// Regions of places, and sums of answered and traced light in them by independent batches.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/math.h"

namespace lte::infer {

/// A balanced k-d tree over places: each node is cut at the median of its longest axis, so a node
/// of depth d has 1/2^d of the places. Node 1 is the root, 2k and 2k + 1 are the halves of node k.
class PlaceTree {
 public:
  static constexpr int kMaxDepth = 6;
  static constexpr size_t kMinPlaces = 8;  ///< of a cell, the tree's smallest nodes

  explicit PlaceTree(std::span<const Vec3> places);

  int depth() const { return depth_; }
  size_t cells() const { return size_t{1} << depth_; }
  bool is_cell(size_t node) const { return node >= cells(); }
  /// Numbers of the places of a node.
  std::span<const uint32_t> places(size_t node) const;
  /// The cells of a node: their numbers, from 0, are [first, last).
  struct CellRange {
    size_t first, last;
  };
  CellRange cells_of(size_t node) const;
  /// All places, those of a cell beside each other, cell by cell.
  std::span<const uint32_t> order() const { return order_; }
  size_t cell_of_rank(size_t rank) const;

 private:
  size_t begin_of(int depth, size_t index) const { return (order_.size() * index) >> depth; }
  void cut(std::span<const Vec3> places, size_t node, int depth);

  std::vector<uint32_t> order_;
  int depth_ = 0;
};

/// Answered and traced light, summed over places. All are means over the color channels.
struct LightSums {
  double answered = 0, traced = 0;
  double all = 0;  ///< traced direct and indirect light: what an error is held against

  void operator+=(const LightSums& other);
};

/// Sums by cell and batch.
class BatchSums {
 public:
  BatchSums(size_t cells, size_t batches) : batches_(batches), sums_(cells * batches) {}

  LightSums& at(size_t cell, size_t batch) { return sums_[cell * batches_ + batch]; }

  /// Of some cells together.
  struct Ratio {
    double ratio = 1, standard_error = 0;
    LightSums sums;
  };
  /// Delta method: the spread of answered − ratio · traced over the batches.
  Ratio ratio(std::span<const size_t> cells) const;
  Ratio ratio(PlaceTree::CellRange cells) const;

 private:
  Ratio from_batches(const std::vector<LightSums>& of_batch) const;
  size_t batches_;
  std::vector<LightSums> sums_;
};

/// So many standard errors are exceeded by chance, to either side, as rarely as three of a normal
/// distribution (0.27 %) in any of `tests` tests (Bonferroni), if each error is known from
/// `batches` batches (Student).
double three_errors(size_t tests, size_t batches);

}  // namespace lte::infer
