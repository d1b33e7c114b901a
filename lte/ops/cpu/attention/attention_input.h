// What a head of patch attention reads, as its products want it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "lte/ops/cpu/dense/packed_linear.h"
#include "lte/tensor/tensor.h"

namespace lte::ops {

/// to = factor · from, by whole blocks as far as there are any: rows are too short for a call.
inline void scale_row(const float* from, int64_t columns, float factor, float* to) {
  int64_t c = 0;
  for (; c + kBlock <= columns; c += kBlock) {
    for (int64_t lane = 0; lane < kBlock; ++lane) to[c + lane] = from[c + lane] * factor;
  }
  for (; c < columns; ++c) to[c] = from[c] * factor;
}

/// Queries, keys and values of points, and the patches in which these attend to one another.
class AttentionInput {
 public:
  /// Arguments as patch_attention_inference() has them, checked.
  AttentionInput(const at::Tensor& qkv, const std::optional<at::Tensor>& gather,
                 const std::optional<at::Tensor>& inverse, int64_t heads, int64_t patch)
      : qkv_(qkv.contiguous()),
        values_(qkv_.const_data_ptr<float>()),
        points_(qkv_.size(0)),
        channels_(qkv_.size(1) / 3),
        heads_(heads),
        width_(channels_ / heads) {
    if (gather.has_value()) {
      gather_ = gather->contiguous();
      inverse_ = inverse->contiguous();
      slot_of_point_ = inverse_.const_data_ptr<int64_t>();
      point_of_slot_ = gather_.const_data_ptr<int64_t>();
    }
    length_ = gather.has_value() ? patch : points_;
  }

  int64_t points() const { return points_; }
  int64_t channels() const { return channels_; }
  int64_t heads() const { return heads_; }
  int64_t width() const { return width_; }    ///< of a head
  int64_t length() const { return length_; }  ///< slots of a patch
  int64_t slots() const { return gather_.defined() ? gather_.numel() : points(); }
  int64_t patches() const { return slots() / length_; }
  bool in_one_patch() const { return !gather_.defined(); }

  int64_t point(int64_t slot) const {
    return point_of_slot_ != nullptr ? point_of_slot_[slot] : slot;
  }
  /// The slot whose result a point takes.
  int64_t slot_of(int64_t point) const {
    return slot_of_point_ != nullptr ? slot_of_point_[point] : point;
  }
  /// Whether the point in this slot takes its result from it.
  bool answers(int64_t slot) const { return slot_of(point(slot)) == slot; }

  /// A head's channels of the point in a slot, where `part` is kQuery, kKey or kValue.
  const float* row(int64_t slot, int64_t part, int64_t head) const {
    return values_ + (point(slot) * 3 + part) * channels() + head * width();
  }

  /// What a query is multiplied by, so that scores are in units of log 2.
  float query_scale() const {
    return std::numbers::log2e_v<float> / std::sqrt(static_cast<float>(width()));
  }

  static constexpr int64_t kQuery = 0, kKey = 1, kValue = 2;

  /// Queries [q, q + rows) of the patch that begins at slot `first`, times query_scale(), into one
  /// panel of a tile.
  void scaled_queries(int64_t first, int64_t q, int64_t rows, int64_t head, float* out) const {
    for (int64_t i = 0; i < rows; ++i)
      scale_row(row(first + q + i, kQuery, head), width(), query_scale(), out + i * kPanel);
  }

 private:
  at::Tensor qkv_, gather_, inverse_;
  const float* values_;
  const int64_t *point_of_slot_ = nullptr, *slot_of_point_ = nullptr;
  // Kept, as rows are found by them one by one.
  int64_t points_, channels_, heads_, width_, length_ = 0;
};

}  // namespace lte::ops
