// The late radiance head on the CPU. A thread takes a tile of directions, those of a point one
// after the other, from the lobes to the answer: nothing of a tile leaves its caches.
#include <algorithm>
#include <optional>
#include <vector>

#include "lte/ops/cpu/dense/packed_linear.h"
#include "lte/ops/lobe_radiance_args.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::ops {
namespace {

constexpr int64_t kLobeTile = 96;  ///< directions of a tile; a multiple of the kernels' rows

/// What all tiles read.
struct LobeWork {
  LobeSizes sizes;
  PackedLinear mix, color;
  const float *own, *directions;
  const float *light, *seen;  ///< or null
  float* out;
};

/// One thread's working memory.
class LobeTile {
 public:
  explicit LobeTile(const LobeWork& work)
      : work_(work),
        K_(work.sizes.lobes),
        stride_(blocks_of(K_) * kBlock),
        lobes_(static_cast<size_t>(4 * stride_)),
        input_(kLobeTile, stride_ + work.sizes.features),
        mixed_(kLobeTile, K_),
        answer_(kLobeTile, kBlock) {}

  /// Directions [first, first + rows) of all, at most kLobeTile.
  void run(int64_t first, int64_t rows) {
    const int64_t N = work_.sizes.directions;
    for (int64_t r = 0; r < rows;) {
      const int64_t point = (first + r) / N,
                    count = std::min(rows - r, (point + 1) * N - first - r);
      ask_point(point, first + r, count, r);
      r += count;
    }
    for (int64_t r = 0; r < rows; ++r) read_seen(first + r, r);
    dense(work_.mix, input_, rows, /*add=*/true, mixed_);
    for (int64_t p = 0; p < panels_of(K_); ++p)
      dense_kernels().activate(mixed_.panel(p), rows, blocks_of(std::min(kPanel, K_ - p * kPanel)));
    dense(work_.color, mixed_, rows, /*add=*/false, answer_);
    dense_kernels().soften(answer_.panel(0), rows);
    for (int64_t r = 0; r < rows; ++r) write(first + r, answer_.panel(0) + r * kPanel);
  }

 private:
  /// The lobes of a point in its next `count` directions, and the offsets of their mixtures, in the
  /// rows of the tile from `row`.
  void ask_point(int64_t point, int64_t direction, int64_t count, int64_t row) {
    const float* own = work_.own + point * 5 * K_;
    for (int64_t k = 0; k < K_; ++k) {
      for (int64_t axis = 0; axis < 3; ++axis)
        lobes_[static_cast<size_t>(axis * stride_ + k)] = own[3 * k + axis];
    }
    std::copy_n(own + 3 * K_, K_, lobes_.begin() + 3 * stride_);
    for (int64_t p = 0; p < panels_of(K_); ++p) {
      const int64_t first = p * kPanel, columns = std::min(kPanel, K_ - first);
      dense_kernels().ridges({lobes_.data() + first, stride_, work_.directions + 3 * direction,
                              count, blocks_of(columns), input_.panel(p) + row * kPanel});
      for (int64_t r = row; r < row + count; ++r)
        std::copy_n(own + 4 * K_ + first, columns, mixed_.panel(p) + r * kPanel);
    }
  }

  /// What the mixture reads of a ray, after the lobes.
  void read_seen(int64_t direction, int64_t row) {
    if (work_.seen == nullptr) return;
    const float* from = work_.seen + direction * kSeenColumns + kSeenLog;
    for (int64_t f = 0; f < work_.sizes.features; ++f) {
      const int64_t column = K_ + f;
      input_.panel(column / kPanel)[row * kPanel + column % kPanel] = from[f];
    }
  }

  void write(int64_t direction, const float* factors) {
    const float* light =
        work_.light == nullptr ? nullptr : work_.light + direction / work_.sizes.directions * 3;
    for (int64_t c = 0; c < 3; ++c) {
      float sum = light == nullptr ? factors[c] : factors[c] * light[c];
      if (work_.seen != nullptr)
        sum += factors[3 + c] * work_.seen[direction * kSeenColumns + kSeenRadiance + c];
      work_.out[3 * direction + c] = sum;
    }
  }

  const LobeWork& work_;
  int64_t K_, stride_;        ///< lobes, and as many as fill blocks
  std::vector<float> lobes_;  ///< [4, stride] of one point: x, y and z of the axes, offsets
  Tile input_, mixed_, answer_;
};

at::Tensor lobe_radiance_inference_cpu(const at::Tensor& any_own, const at::Tensor& any_directions,
                                       const std::optional<at::Tensor>& any_light,
                                       const std::optional<at::Tensor>& any_seen,
                                       const at::Tensor& mix_weight, const at::Tensor& mix_bias,
                                       const at::Tensor& color_weight,
                                       const at::Tensor& color_bias) {
  const at::Tensor own = any_own.contiguous(), directions = any_directions.contiguous(),
                   light = contiguous_or_undefined(any_light),
                   seen = contiguous_or_undefined(any_seen);
  const LobeSizes sizes = check_lobe_radiance_args(
      own, directions, light, seen, {{mix_weight, mix_bias}, {color_weight, color_bias}});
  at::Tensor out = at::empty({sizes.points, sizes.directions, 3}, own.options());
  const auto data = [](const at::Tensor& t) {
    return t.defined() ? t.const_data_ptr<float>() : nullptr;
  };
  const LobeWork work{sizes,
                      PackedLinear(mix_weight, mix_bias),
                      PackedLinear(color_weight, color_bias),
                      data(own),
                      data(directions),
                      data(light),
                      data(seen),
                      out.data_ptr<float>()};
  const int64_t rows = sizes.rows();
  at::parallel_for(0, (rows + kLobeTile - 1) / kLobeTile, 1, [&](int64_t begin, int64_t end) {
    LobeTile tile(work);
    for (int64_t t = begin; t < end; ++t)
      tile.run(t * kLobeTile, std::min(kLobeTile, rows - t * kLobeTile));
  });
  return out;
}

}  // namespace
}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, CPU, m) {
  m.impl("lobe_radiance_inference", lte::ops::lobe_radiance_inference_cpu);
}
