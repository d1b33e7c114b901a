// Items grouped by a key from 0 to n - 1: a counting sort.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/parallel.h"

namespace lte::scene {

/// Items of one key are next to each other, in the order in which they came.
template <typename Item>
class Buckets {
 public:
  /// `each(use)` calls `use(key, item)` for every item; it is called twice and must say the same.
  template <typename Each>
  Buckets(size_t keys, const Each& each) : ends_(keys + 1) {
    each([&](uint32_t key, const Item&) { ++ends_[key + 1]; });
    for (size_t k = 1; k <= keys; ++k) ends_[k] += ends_[k - 1];
    items_.resize(ends_[keys]);
    // Filling moves each start to its end, which is the next one's start.
    each([&](uint32_t key, const Item& item) { items_[ends_[key]++] = item; });
  }

  size_t size() const { return ends_.size() - 1; }
  std::span<Item> operator[](size_t key) {
    const size_t begin = key == 0 ? 0 : ends_[key - 1];
    return std::span(items_).subspan(begin, ends_[key] - begin);
  }

  /// Calls `body(bucket)` for every bucket, on all threads.
  template <typename Body>
  void for_each(const Body& body) {
    constexpr int64_t kGrain = 16384;
    parallel_for(static_cast<int64_t>(size()), kGrain, [&](int64_t begin, int64_t end) {
      for (int64_t k = begin; k < end; ++k) body((*this)[static_cast<size_t>(k)]);
    });
  }

 private:
  std::vector<size_t> ends_;
  std::vector<Item> items_;
};

}  // namespace lte::scene
