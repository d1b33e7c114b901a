#include "lte/render/box_mean.h"

#include <algorithm>
#include <cstddef>

#include "lte/base/parallel.h"

namespace lte::render {
namespace {

constexpr int kRowsAtOnce = 8;
constexpr int kColumnsAtOnce = 64;

/// A sum that moves on.
struct Running {
  double value = 0, count = 0;
  void add(const Running& other, double sign) {
    value += sign * other.value;
    count += sign * other.count;
  }
};

}  // namespace

BoxMean::BoxMean(int width, int height, std::span<const uint8_t> mask)
    : width_(width), height_(height), mask_(mask) {}

std::vector<float> BoxMean::operator()(std::span<const float> values, int radius,
                                       std::vector<float>* counts) const {
  const auto at = [this](int x, int y) {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  };
  std::vector<Running> rows(values.size());
  parallel_for(height_, kRowsAtOnce, [&](int64_t begin, int64_t end) {
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      Running sum;
      const auto move = [&](int x, double sign) {
        if (x < 0 || x >= width_ || !mask_[at(x, y)]) return;
        sum.add({double{values[at(x, y)]}, 1}, sign);
      };
      for (int x = 0; x < radius; ++x) move(x, 1);
      for (int x = 0; x < width_; ++x) {
        move(x + radius, 1);
        move(x - radius - 1, -1);
        rows[at(x, y)] = sum;
      }
    }
  });
  std::vector<float> out(values.size());
  if (counts != nullptr) counts->assign(values.size(), 0);
  parallel_for(width_, kColumnsAtOnce, [&](int64_t begin, int64_t end) {
    std::vector<Running> sums(static_cast<size_t>(end - begin));
    const auto move = [&](int y, double sign) {
      if (y < 0 || y >= height_) return;
      for (auto x = begin; x < end; ++x)
        sums[static_cast<size_t>(x - begin)].add(rows[at(static_cast<int>(x), y)], sign);
    };
    for (int y = 0; y < radius; ++y) move(y, 1);
    for (int y = 0; y < height_; ++y) {
      move(y + radius, 1);
      move(y - radius - 1, -1);
      for (auto x = begin; x < end; ++x) {
        const Running& sum = sums[static_cast<size_t>(x - begin)];
        const size_t i = at(static_cast<int>(x), y);
        if (counts != nullptr) (*counts)[i] = static_cast<float>(sum.count);
        if (sum.count > 0.5) out[i] = static_cast<float>(sum.value / sum.count);
      }
    }
  });
  return out;
}

}  // namespace lte::render
