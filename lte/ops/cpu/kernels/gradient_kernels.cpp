// Gradients of dense layers, norms, activations and maxima over tiles of rows that stay in the
// caches.
#include "lte/ops/cpu/kernels/gelu_vector.h"
#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/kernels/product.h"
#include "lte/ops/cpu/kernels/vector.h"
#include "lte/ops/cpu/kernels/vector_math.h"

namespace lte::ops::LTE_ISA {
namespace {

/// SingleProduct with rows of x that lie as columns.
struct TransposedProduct : SingleProduct {
  static constexpr int64_t kRowStride = 1, kInputStride = kPanel;
};

void activate_with_slope(float* x, int64_t rows, int64_t blocks, float* slope) {
  for (int64_t r = 0; r < rows; ++r) {
    for (int64_t i = r * kPanel; i < r * kPanel + blocks * kBlock; i += kLanes<float>) {
      Float rise;
      store(x + i, gelu_with_slope(load(x + i), rise));
      store(slope + i, rise);
    }
  }
}

void multiply_each(float* x, const float* by, int64_t rows, int64_t blocks) {
  for (int64_t r = 0; r < rows; ++r) {
    for (int64_t i = r * kPanel; i < r * kPanel + blocks * kBlock; i += kLanes<float>) {
      store(x + i, load(x + i) * load(by + i));
    }
  }
}

void sum_columns(const float* x, int64_t rows, int64_t blocks, float* sum) {
  for (int64_t c = 0; c < blocks * kBlock; c += kLanes<float>) {
    Float total = load(sum + c);
    for (int64_t r = 0; r < rows; ++r) total += load(x + r * kPanel + c);
    store(sum + c, total);
  }
}

void layer_norm_gradient(LayerNormGradient a) {
  const int64_t blocks = (a.channels + kBlock - 1) / kBlock;
  constexpr int64_t kBlocks = kPanel / kBlock;
  float counted[kBlock];  // columns past the last channel have no part in the means
  for (int64_t i = 0; i < kBlock; ++i) {
    counted[i] = (blocks - 1) * kBlock + i < a.channels ? 1.0f : 0.0f;
  }
  const float inverse = 1.0f / static_cast<float>(a.channels);
  for (int64_t r = 0; r < a.rows; ++r) {
    const auto each = [&](const auto& use) {
      for (int64_t b = 0; b < blocks; ++b) {
        const int64_t first = b / kBlocks * a.panel_stride + r * kPanel + b % kBlocks * kBlock;
        for (int64_t lane = 0; lane < kBlock; lane += kLanes<float>) {
          const Float present = b == blocks - 1 ? load(counted + lane) : splat(1.0f);
          use(first + lane, b * kBlock + lane, present);
        }
      }
    };
    Float sum{}, square{}, by_normed{}, by_product{};
    each([&](int64_t i, int64_t, const Float& present) { sum += load(a.x + i) * present; });
    const Float mean = splat(horizontal_sum(sum) * inverse);
    each([&](int64_t i, int64_t, const Float& present) {
      const Float d = (load(a.x + i) - mean) * present;
      square += d * d;
    });
    const Float scale =
        splat(1.0f / __builtin_sqrtf(horizontal_sum(square) * inverse + kNormEpsilon));
    each([&](int64_t i, int64_t c, const Float& present) {
      const Float normed = (load(a.x + i) - mean) * scale * present, grad = load(a.grad + i);
      const Float g = grad * load(a.gain + c);
      by_normed += g;
      by_product += g * normed;
      store(a.by_gain + c, load(a.by_gain + c) + grad * normed);
      store(a.by_bias + c, load(a.by_bias + c) + grad);
    });
    const Float m1 = splat(horizontal_sum(by_normed) * inverse),
                m2 = splat(horizontal_sum(by_product) * inverse);
    each([&](int64_t i, int64_t c, const Float& present) {
      const Float normed = (load(a.x + i) - mean) * scale;
      const Float change = (load(a.grad + i) * load(a.gain + c) - m1 - normed * m2) * scale;
      store(a.by_x + i, load(a.by_x + i) + change * present);
    });
  }
}

void attend_gradient(AttendGradient arguments) {
  const auto [query, rows, blocks, sums, row_stride, block_stride, scale, grad, by_sums] =
      arguments;
  const Float factor = splat(scale);
  for (int64_t r = 0; r < rows; ++r) {
    for (int64_t b = 0; b < blocks; ++b) {
      const int64_t at = r * row_stride + b * block_stride;
      for (int64_t lane = 0; lane < kBlock; lane += kLanes<float>) {
        const int64_t i = r * kPanel + b * kBlock + lane;
        const Float g = load(grad + i) * factor;
        store(by_sums + at + lane, g * load(query + i));
        store(by_sums + at + kBlock + lane, g);
        store(grad + i, g * load(sums + at + lane));
      }
    }
  }
}

void attention_gradient(AttentionGradient a) {
  for (int64_t r = 0; r < a.rows; ++r) {
    const Float log_sum = splat(a.log_sum[r]), mean = splat(a.mean[r]);
#pragma GCC unroll 4
    for (int64_t i = r * kPanel; i < r * kPanel + a.blocks * kBlock; i += kLanes<float>) {
      const Float weight = attention_weight(load(a.scores + i) - log_sum);
      store(a.scores + i, weight);
      store(a.grad + i, weight * (load(a.grad + i) - mean));
    }
  }
}

void maximize_at(const float* x, int32_t place, int64_t count, float* out, int32_t* winner) {
  over_row(
      count,
      [&](int64_t i) {
        const Float value = load(x + i), most = load(out + i);
        const auto larger = value > most;
        store(out + i, larger ? value : most);
        store(winner + i, larger ? splat(place) : load(winner + i));
      },
      [&](int64_t i) {
        if (!(x[i] > out[i])) return;
        out[i] = x[i];
        winner[i] = place;
      });
}

void maximum_gradient(MaximumGradient a) {
  const int64_t C = a.channels;
  const auto add = [&](float* to, const float* from, const Float& factor) {
    for (int64_t c = 0; c < C; c += kLanes<float>) {
      store(to + c, load(to + c) + factor * load(from + c));
    }
  };
  for (int64_t o = 0; o < a.outputs; ++o) {
    const int64_t i = a.winner[o];
    float *hidden = a.hidden + i * C, *back = a.back + i * C;
    if (a.seen[i] == 0) {
      a.seen[i] = 1;
      const float* x = a.dense + a.neighbour[i] * C;
      for (int64_t c = 0; c < C; c += kLanes<float>) {
        Float slope;
        store(hidden + c, gelu_with_slope(load(x + c) + load(a.center + c), slope));
        store(a.slope + i * C + c, slope);
        store(back + c, Float{});
      }
    }
    const Float grad = splat(a.grad[o]);
    add(back, a.weight + o * C, grad);
    add(a.by_weight + o * C, hidden, grad);
  }
  for (int64_t i = 0; i < a.k; ++i) {
    if (a.seen[i] == 0) continue;
    a.seen[i] = 0;
    float* to = a.by_dense + a.neighbour[i] * C;
    for (int64_t c = 0; c < C; c += kLanes<float>) {
      const Float change = load(a.back + i * C + c) * load(a.slope + i * C + c);
      store(to + c, load(to + c) + change);
      store(a.by_center + c, load(a.by_center + c) + change);
    }
  }
}

}  // namespace

extern const GradientKernels kGradientKernels;
const GradientKernels kGradientKernels{multiply_blocks<TransposedProduct>,
                                       activate_with_slope,
                                       multiply_each,
                                       sum_columns,
                                       layer_norm_gradient,
                                       attend_gradient,
                                       attention_gradient,
                                       maximize_at,
                                       maximum_gradient};

}  // namespace lte::ops::LTE_ISA
