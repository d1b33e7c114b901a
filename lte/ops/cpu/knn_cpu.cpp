// k nearest neighbours on the CPU: queries in packets that share one list of candidates.
//
// Queries are sorted by the k-d tree's leaf, then along a curve inside it. The first query of a
// packet, its leader, has k neighbours within r. A query at distance d from the leader then has k
// within r + d of itself, so within r + 2 d of the leader: one walk of the tree with the packet's
// largest d collects candidates for all of it. Ranking candidates by counting has no branches to
// mispredict. No result depends on how queries are grouped.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <vector>

#include <ATen/Parallel.h>
#include <ATen/ops/empty.h>
#include <torch/library.h>

#include "lte/ops/cpu/kd_tree.h"
#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/radix_sort.h"
#include "lte/ops/curve_codes_kernel.h"
#include "lte/ops/knn_args.h"

namespace lte::ops {
namespace {

constexpr int kLeafSize = 16;
constexpr int64_t kMaxPacket = 64;
constexpr float kPacketReach = 0.6f;  ///< of r: how far from the leader a packet extends
constexpr int64_t kMaxRanked = 256;   ///< counting is quadratic: longer lists are sorted
constexpr int64_t kChunk = 512;       ///< queries a thread takes at once

/// The candidates of a packet.
struct Candidates {
  std::vector<float> x, y, z;
  std::vector<int32_t> id;
  int64_t count = 0;

  explicit Candidates(int64_t capacity) : x(capacity), y(capacity), z(capacity), id(capacity) {}
};

/// One thread's working memory and the search itself.
class PacketSearch {
 public:
  PacketSearch(const KdTree& tree, int64_t k)
      : tree_(tree),
        kernels_(point_kernels()),
        k_(k),
        candidates_(tree.index.size() + 32),
        distance_(tree.index.size() + 32),
        selected_distance_(distance_.size()),
        position_(distance_.size()),
        selected_id_(distance_.size()),
        rank_(distance_.size()),
        ordered_(distance_.size()),
        previous_(k) {}

  /// Searches for queries order[0 .. count), which lie in leaves leaf[order[i]].
  void run(const float* queries, const int32_t* order, const int32_t* leaf, int64_t count,
           int64_t* out_index, float* out_distance) {
    for (int64_t begin = 0; begin < count;) {
      const float* leader = queries + 3 * static_cast<int64_t>(order[begin]);
      const float r2 = leader_bound2(leader, leaf[order[begin]]);
      const int64_t end = gather_packet(queries, order, begin, count, r2);
      bool first = true;
      for (int64_t i = begin; i < end; ++i) {
        const int64_t row = order[i];
        const float* query = queries + 3 * row;
        if (!first && same(query, queries + 3 * static_cast<int64_t>(order[i - 1]))) {
          const int64_t twin = order[i - 1];
          std::copy_n(out_index + twin * k_, k_, out_index + row * k_);
          std::copy_n(out_distance + twin * k_, k_, out_distance + row * k_);
        } else {
          search(query, first ? &r2 : nullptr, out_index + row * k_, out_distance + row * k_);
        }
        first = false;
      }
      begin = end;
    }
  }

 private:
  static bool same(const float* a, const float* b) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
  }

  /// The k-th smallest of distance_[0, count).
  float kth_smallest(int64_t count) {
    std::copy_n(distance_.begin(), count, selected_distance_.begin());
    const auto kth = selected_distance_.begin() + (k_ - 1);
    std::nth_element(selected_distance_.begin(), kth, selected_distance_.begin() + count);
    return *kth;
  }

  /// Squared distance within which the leader has k points: its k-th neighbour's, or little more.
  float leader_bound2(const float* leader, int32_t node) {
    if (last_kth_ >= 0) {  // the results of the query before, if they are near
      const float bound = previous_bound(leader);
      if (bound <= 2 * last_kth_) return bound;
    }
    while (tree_.nodes[node].end - tree_.nodes[node].begin < k_) node = tree_.nodes[node].parent;
    const int64_t begin = tree_.nodes[node].begin, count = tree_.nodes[node].end - begin;
    kernels_.distances(tree_.x.data() + begin, tree_.y.data() + begin, tree_.z.data() + begin,
                       count, leader, distance_.data());
    collect(leader, kth_smallest(count));
    compute_distances(leader);
    return kth_smallest(candidates_.count);
  }

  /// Extends the packet while queries stay near the leader, and collects its candidates.
  int64_t gather_packet(const float* queries, const int32_t* order, int64_t begin, int64_t count,
                        float r2) {
    const float* leader = queries + 3 * static_cast<int64_t>(order[begin]);
    const float limit = r2 * (kPacketReach * kPacketReach);
    const int64_t last = std::min(count, begin + kMaxPacket);
    float farthest = 0;
    int64_t end = begin + 1;
    for (; end < last; ++end) {
      const float* q = queries + 3 * static_cast<int64_t>(order[end]);
      const float dx = q[0] - leader[0], dy = q[1] - leader[1], dz = q[2] - leader[2];
      const float d2 = (dx * dx + dy * dy) + dz * dz;
      if (!(d2 <= limit)) break;
      farthest = std::max(farthest, d2);
    }
    // Covers the rounding of distances, a few parts in 10^7, and squares lost to underflow.
    const double reach =
        std::sqrt(static_cast<double>(r2)) + 2 * std::sqrt(static_cast<double>(farthest));
    collect(leader, static_cast<float>(reach * reach * (1 + 1e-5) + 1e-36));
    return end;
  }

  /// Points within `reach2` of `center` into candidates_.
  void collect(const float* center, float reach2) {
    Candidates& c = candidates_;
    c.count = 0;
    stack_.assign(1, 0);
    while (!stack_.empty()) {
      const KdTree::Node& node = tree_.nodes[stack_.back()];
      stack_.pop_back();
      if (!(box_distance2(node, center) <= reach2)) continue;
      if (node.left >= 0) {
        stack_.push_back(node.left);
        stack_.push_back(node.left + 1);
        continue;
      }
      const int64_t begin = node.begin;
      kernels_.distances(tree_.x.data() + begin, tree_.y.data() + begin, tree_.z.data() + begin,
                         node.end - begin, center, distance_.data());
      const int64_t found =
          kernels_.select(distance_.data(), node.end - begin, reach2, position_.data());
      for (int64_t i = 0; i < found; ++i) {
        const int64_t from = begin + position_[i], to = c.count++;
        c.x[to] = tree_.x[from];
        c.y[to] = tree_.y[from];
        c.z[to] = tree_.z[from];
        c.id[to] = tree_.index[from];
      }
    }
  }

  void compute_distances(const float* query) {
    kernels_.distances(candidates_.x.data(), candidates_.y.data(), candidates_.z.data(),
                       candidates_.count, query, distance_.data());
  }

  /// The k nearest candidates in order. Without a bound, the k results of the packet's previous
  /// query give one.
  void search(const float* query, const float* known_bound, int64_t* out_index,
              float* out_distance) {
    compute_distances(query);
    float bound = known_bound != nullptr ? *known_bound : 0;
    if (known_bound == nullptr) {
      for (int64_t i = 0; i < k_; ++i) bound = std::max(bound, distance_[previous_[i]]);
    }
    const int64_t found =
        kernels_.select(distance_.data(), candidates_.count, bound, position_.data());
    for (int64_t i = 0; i < found; ++i) {
      selected_distance_[i] = distance_[position_[i]];
      selected_id_[i] = candidates_.id[position_[i]];
    }
    order_selected(found);
    for (int64_t i = 0; i < k_; ++i) {
      previous_[i] = position_[ordered_[i]];
      out_index[i] = selected_id_[ordered_[i]];
      out_distance[i] = selected_distance_[ordered_[i]];
    }
    last_kth_ = out_distance[k_ - 1];
  }

  /// The largest squared distance from a query to the k results of the one before.
  float previous_bound(const float* query) const {
    float bound = 0;
    for (int64_t i = 0; i < k_; ++i) {
      const int32_t at = previous_[i];
      const float dx = candidates_.x[at] - query[0], dy = candidates_.y[at] - query[1],
                  dz = candidates_.z[at] - query[2];
      bound = std::max(bound, (dx * dx + dy * dy) + dz * dz);
    }
    return bound;
  }

  /// ordered_[0, k): selected entries by distance, then by id.
  void order_selected(int64_t count) {
    if (count <= kMaxRanked) {
      kernels_.ranks(selected_distance_.data(), selected_id_.data(), count, rank_.data());
      for (int64_t i = 0; i < count; ++i) ordered_[rank_[i]] = static_cast<int32_t>(i);
      return;
    }
    std::iota(ordered_.begin(), ordered_.begin() + count, 0);
    std::partial_sort(ordered_.begin(), ordered_.begin() + k_, ordered_.begin() + count,
                      [&](int32_t a, int32_t b) {
                        return selected_distance_[a] != selected_distance_[b]
                                   ? selected_distance_[a] < selected_distance_[b]
                                   : selected_id_[a] < selected_id_[b];
                      });
  }

  const KdTree& tree_;
  const PointKernels& kernels_;
  int64_t k_;
  float last_kth_ = -1;  ///< squared distance of the last result found, -1 before the first
  Candidates candidates_;
  std::vector<float> distance_, selected_distance_;
  std::vector<int32_t> position_, selected_id_, rank_, ordered_, previous_, stack_;
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
  const int64_t Q = queries.size(0), N = points.size(0), K = std::min(k, N);
  at::Tensor index = at::empty({Q, K}, queries.options().dtype(at::kLong));
  at::Tensor distance = at::empty({Q, K}, queries.options());
  if (Q == 0) return {index, distance};
  // Of points that coincide, only the K lowest rows can be among the K nearest of anything.
  const KdTree tree(points.const_data_ptr<float>(), N, kLeafSize, K);
  const auto* q = queries.const_data_ptr<float>();
  std::vector<int32_t> leaf(Q), leaf_number(tree.nodes.size());
  for (size_t i = 0; i < tree.leaves.size(); ++i) {
    leaf_number[tree.leaves[i]] = static_cast<int32_t>(i);
  }
  const int place_bits = tree.leaves.size() < (1u << 23) ? 9 : 0;
  std::vector<uint32_t> key(Q);
  at::parallel_for(0, Q, kGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      leaf[i] = tree.find_leaf(q + 3 * i);
      key[i] = static_cast<uint32_t>(leaf_number[leaf[i]]) << place_bits;
      if (place_bits != 0) key[i] |= place_in_leaf(tree.nodes[leaf[i]], q + 3 * i);
    }
  });
  const std::vector<int32_t> order = sort_rows(key);
  auto* out_index = index.data_ptr<int64_t>();
  auto* out_distance = distance.data_ptr<float>();
  at::parallel_for(0, Q, kChunk, [&](int64_t begin, int64_t end) {
    PacketSearch search(tree, K);
    search.run(q, order.data() + begin, leaf.data(), end - begin, out_index, out_distance);
  });
  return {index, distance};
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) { m.impl("knn", lte::ops::knn_cpu); }
