// k nearest neighbours on the CPU: for each query the points within a bound, ranked.
//
// Queries are sorted by the k-d tree's leaf, then along a curve inside it. The k neighbours of the
// query before bound where those of the next one are: none of them is farther from it than the
// farthest of these. Boxes over the leaves are tested sixteen at a time, and ranking by counting
// has no branches to mispredict.
//
// Where queries are dense, those after one share its walk. It has k neighbours within r; a query at
// distance d from it then has k within r + d of itself, so within r + 2 d of the first. No result
// depends on the order of queries or on who shares what.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "lte/base/unfilled_vector.h"
#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/search/box_levels.h"
#include "lte/ops/cpu/search/kd_tree.h"
#include "lte/ops/cpu/search/radix_sort.h"
#include "lte/ops/curve_codes_kernel.h"
#include "lte/ops/knn.h"
#include "lte/ops/knn_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

constexpr int kLeafSize = 16;
/// The neighbours before bound a query if the square of its bound is at most so much larger than
/// theirs was; else points of its own leaf give a tighter one.
constexpr float kLoose = 2.5f;
constexpr int64_t kMinShared = 5, kMaxShared = 64;  ///< queries that share a walk
constexpr float kSharedReach = 0.6f;                ///< of r: how far they may be from the first
constexpr int64_t kMaxRanked = 256;  ///< counting is quadratic: longer lists are sorted
constexpr int64_t kChunk = 512;      ///< queries a thread takes at once

/// Some points by themselves.
struct Candidates {
  UnfilledVector<float> x, y, z;
  UnfilledVector<int32_t> id;
  int64_t count = 0;

  explicit Candidates(size_t capacity) : x(capacity), y(capacity), z(capacity), id(capacity) {}
};

/// One thread's working memory and the search itself.
class Search {
 public:
  Search(const KdTree& tree, const BoxLevels& boxes, int64_t k)
      : tree_(tree),
        boxes_(boxes.view()),
        kernels_(point_kernels()),
        k_(k),
        distance_(tree.index.size() + KdTree::kPadding),
        position_(distance_.size()),
        id_(distance_.size()),
        ordered_(distance_.size()),
        rank_(kMaxRanked + KdTree::kPadding),
        shared_(distance_.size()) {
    for (std::vector<float>& axis : previous_) axis.resize(k + KdTree::kPadding);
  }

  /// Searches for queries order[0 .. count), which lie in leaves leaf[order[i]].
  void run(const float* queries, const int32_t* order, const int32_t* leaf, int64_t count,
           int64_t* out_index, float* out_distance) {
    const auto query_of = [&](int64_t i) { return queries + 3 * static_cast<int64_t>(order[i]); };
    for (int64_t i = 0; i < count;) {
      float bound = bound_of(query_of(i), leaf[order[i]]);
      float farthest = 0;  // squared, from the first to those that share its walk
      int64_t end = i + 1;
      for (const int64_t last = std::min(count, i + kMaxShared); end < last; ++end) {
        const float d2 = distance2(query_of(end), query_of(i));
        if (!(d2 <= bound * (kSharedReach * kSharedReach))) break;
        farthest = std::max(farthest, d2);
      }
      const bool shares = end - i >= kMinShared;
      if (shares) {
        collect(query_of(i), bound, farthest);
      } else {
        end = i + 1;
      }
      for (const int64_t first = i; i < end; ++i) {
        const int64_t row = order[i];
        const float* query = query_of(i);
        if (i > 0 && std::equal(query, query + 3, query_of(i - 1))) {
          const int64_t twin = order[i - 1];
          std::copy_n(out_index + twin * k_, k_, out_index + row * k_);
          std::copy_n(out_distance + twin * k_, k_, out_distance + row * k_);
          continue;
        }
        if (i > first) bound = farthest_of_previous(query);
        if (shares) {
          find_shared(query, bound);
        } else {
          find(query, bound);
        }
        put_out(out_index + row * k_, out_distance + row * k_);
      }
    }
  }

 private:
  static float distance2(const float* a, const float* b) {
    const float dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
    return (dx * dx + dy * dy) + dz * dz;
  }

  float farthest_of_previous(const float* query) const {
    return kernels_.farthest(previous_[0].data(), previous_[1].data(), previous_[2].data(), k_,
                             query);
  }

  /// A squared distance within which the query has k points. @param node  its leaf
  float bound_of(const float* query, int32_t node) {
    if (last_kth_ >= 0) {
      const float bound = farthest_of_previous(query);
      if (bound <= kLoose * last_kth_) return bound;
    }
    while (tree_.nodes[node].end - tree_.nodes[node].begin < k_) node = tree_.nodes[node].parent;
    const int64_t begin = tree_.nodes[node].begin, count = tree_.nodes[node].end - begin;
    kernels_.distances(tree_.x.data() + begin, tree_.y.data() + begin, tree_.z.data() + begin,
                       count, query, distance_.data());
    const auto kth = distance_.begin() + (k_ - 1);
    std::nth_element(distance_.begin(), kth, distance_.begin() + count);
    return *kth;
  }

  /// Fills shared_ for a query with k points within `bound` and those up to `farthest` from it.
  void collect(const float* query, float bound, float farthest) {
    // Covers the rounding of distances, a few parts in 10^7, and squares lost to underflow.
    const double reach =
        std::sqrt(static_cast<double>(bound)) + 2 * std::sqrt(static_cast<double>(farthest));
    const int64_t found =
        kernels_.within(boxes_, query, static_cast<float>(reach * reach * (1 + 1e-5) + 1e-36),
                        distance_.data(), position_.data());
    for (int64_t i = 0; i < found; ++i) {
      const int32_t at = position_[i];
      shared_.x[i] = tree_.x[at];
      shared_.y[i] = tree_.y[at];
      shared_.z[i] = tree_.z[at];
      shared_.id[i] = tree_.index[at];
    }
    shared_.count = found;
  }

  void find(const float* query, float bound) {
    found_ = kernels_.within(boxes_, query, bound, distance_.data(), position_.data());
    keep(tree_.x.data(), tree_.y.data(), tree_.z.data(), tree_.index.data());
  }

  /// The same among shared_.
  void find_shared(const float* query, float bound) {
    found_ = kernels_.near(shared_.x.data(), shared_.y.data(), shared_.z.data(), shared_.count,
                           query, bound, distance_.data(), position_.data());
    keep(shared_.x.data(), shared_.y.data(), shared_.z.data(), shared_.id.data());
  }

  /// Ranks what was found at position_ in these arrays, and keeps where the k nearest are.
  void keep(const float* x, const float* y, const float* z, const int32_t* id) {
    for (int64_t i = 0; i < found_; ++i) id_[i] = id[position_[i]];
    put_in_order(found_);
    for (int64_t i = 0; i < k_; ++i) {
      const int32_t at = position_[ordered_[i]];
      previous_[0][i] = x[at];
      previous_[1][i] = y[at];
      previous_[2][i] = z[at];
    }
  }

  void put_out(int64_t* index, float* distance) {
    for (int64_t i = 0; i < k_; ++i) {
      index[i] = id_[ordered_[i]];
      distance[i] = distance_[ordered_[i]];
    }
    last_kth_ = distance[k_ - 1];
  }

  /// ordered_[0, k): what was found by distance, then by id.
  void put_in_order(int64_t count) {
    if (count <= kMaxRanked) {
      kernels_.ranks(distance_.data(), id_.data(), count, rank_.data());
      for (int64_t i = 0; i < count; ++i) ordered_[rank_[i]] = static_cast<int32_t>(i);
      return;
    }
    std::iota(ordered_.begin(), ordered_.begin() + count, 0);
    std::partial_sort(ordered_.begin(), ordered_.begin() + k_, ordered_.begin() + count,
                      [&](int32_t a, int32_t b) {
                        return distance_[a] != distance_[b] ? distance_[a] < distance_[b]
                                                            : id_[a] < id_[b];
                      });
  }

  const KdTree& tree_;
  const PointBoxes& boxes_;
  const PointKernels& kernels_;
  int64_t k_, found_ = 0;
  float last_kth_ = -1;  ///< squared distance of the last result found, -1 before the first
  std::array<std::vector<float>, 3> previous_;  ///< coordinates of the results before
  UnfilledVector<float> distance_;              ///< of what was found, as the next two
  UnfilledVector<int32_t> position_, id_, ordered_, rank_;
  Candidates shared_;
};

/// Where a query lies inside its leaf, along the Z curve of an 8 x 8 x 8 grid.
uint32_t place_in_leaf(const KdTree::Node& node, const float* query) {
  int32_t cell[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float extent = node.high[axis] - node.low[axis];
    const float at = (query[axis] - node.low[axis]) / extent * 8;  // NaN in a flat leaf
    cell[axis] = at >= 0 ? static_cast<int32_t>(std::min(at, 7.0f)) : 0;
  }
  return static_cast<uint32_t>(z_code(cell[0], cell[1], cell[2]));
}

std::tuple<at::Tensor, at::Tensor> knn_cpu(const at::Tensor& queries, const at::Tensor& points,
                                           int64_t k) {
  check_knn_args(queries, points, k);
  if (queries.size(0) > 0) return KnnIndex(points, k).search(queries);
  const int64_t K = std::min(k, points.size(0));
  return {at::empty({0, K}, queries.options().dtype(at::kLong)),
          at::empty({0, K}, queries.options())};
}

}  // namespace

struct KnnIndex::Parts {
  // Of points that coincide, only the K lowest rows can be among the K nearest of anything.
  Parts(const at::Tensor& points, int64_t k)
      : K(std::min(k, points.size(0))),
        tree(points.const_data_ptr<float>(), points.size(0), kLeafSize, K),
        boxes(tree),
        leaf_number(tree.nodes.size()) {
    for (size_t i = 0; i < tree.leaves.size(); ++i) {
      leaf_number[tree.leaves[i]] = static_cast<int32_t>(i);
    }
  }

  int64_t K;
  KdTree tree;
  BoxLevels boxes;
  std::vector<int32_t> leaf_number;  ///< of a node that is a leaf
};

KnnIndex::KnnIndex(const at::Tensor& points, int64_t k) {
  check_knn_points(points, k);
  TORCH_CHECK(points.is_cpu() && points.size(0) >= 1, "knn: an index needs points on the CPU, got ",
              points.size(0), " on ", points.device());
  parts_ = std::make_unique<const Parts>(points, k);
}

KnnIndex::~KnnIndex() = default;

std::tuple<at::Tensor, at::Tensor> KnnIndex::search(const at::Tensor& queries) const {
  check_knn_queries(queries);
  TORCH_CHECK(queries.is_cpu(), "knn: an index takes queries on the CPU, got ", queries.device());
  const int64_t K = parts_->K;
  const KdTree& tree = parts_->tree;
  const int64_t Q = queries.size(0);
  at::Tensor index = at::empty({Q, K}, queries.options().dtype(at::kLong));
  at::Tensor distance = at::empty({Q, K}, queries.options());
  const auto* q = queries.const_data_ptr<float>();
  std::vector<int32_t> leaf(Q);
  const int place_bits = tree.leaves.size() < (1u << 23) ? 9 : 0;
  std::vector<uint32_t> key(Q);
  at::parallel_for(0, Q, kGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      leaf[i] = tree.find_leaf(q + 3 * i);
      key[i] = static_cast<uint32_t>(parts_->leaf_number[leaf[i]]) << place_bits;
      if (place_bits != 0) key[i] |= place_in_leaf(tree.nodes[leaf[i]], q + 3 * i);
    }
  });
  const std::vector<int32_t> order = sort_rows(key);
  auto* out_index = index.data_ptr<int64_t>();
  auto* out_distance = distance.data_ptr<float>();
  at::parallel_for(0, Q, kChunk, [&](int64_t begin, int64_t end) {
    Search search(tree, parts_->boxes, K);
    search.run(q, order.data() + begin, leaf.data(), end - begin, out_index, out_distance);
  });
  return {index, distance};
}

}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) { m.impl("knn", lte::ops::knn_cpu); }
