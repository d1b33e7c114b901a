// Dense layers, norms and activations over tiles of rows that stay in the caches.
#include "lte/ops/cpu/kernels/gelu_vector.h"
#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/kernels/product.h"
#include "lte/ops/cpu/kernels/vector.h"
#include "lte/ops/cpu/kernels/vector_math.h"

namespace lte::ops::LTE_ISA {
namespace {

void activate(float* x, int64_t rows, int64_t blocks) {
  for (int64_t r = 0; r < rows; ++r) {
    for (int64_t i = r * kPanel; i < r * kPanel + blocks * kBlock; i += kLanes<float>) {
      store(x + i, gelu(load(x + i)));
    }
  }
}

void activate_sum(const float* a, const float* b, int64_t count, float* out) {
  over_row(
      count, [&](int64_t i) { store(out + i, gelu(load(a + i) + load(b + i))); },
      [&](int64_t i) { out[i] = gelu(splat(a[i] + b[i]))[0]; });
}

void maximize(const float* x, int64_t count, float* out) {
  over_row(
      count,
      [&](int64_t i) {
        const Float value = load(x + i), most = load(out + i);
        store(out + i, value > most ? value : most);
      },
      [&](int64_t i) { out[i] = x[i] > out[i] ? x[i] : out[i]; });
}

void accumulate(const float* x, int64_t count, float* out) {
  over_row(
      count, [&](int64_t i) { store(out + i, load(out + i) + load(x + i)); },
      [&](int64_t i) { out[i] += x[i]; });
}

void layer_norm(const float* x, int64_t rows, int64_t panel_stride, int64_t channels,
                const float* gain, const float* bias, float* out) {
  const int64_t blocks = (channels + kBlock - 1) / kBlock;
  constexpr int64_t kBlocks = kPanel / kBlock;
  // Columns past the last channel hold zeros; they must not count in the variance.
  float counted[kBlock];
  for (int64_t i = 0; i < kBlock; ++i) {
    counted[i] = (blocks - 1) * kBlock + i < channels ? 1.0f : 0.0f;
  }
  const float inverse = 1.0f / static_cast<float>(channels);
  for (int64_t r = 0; r < rows; ++r) {
    const auto at = [&](int64_t b) {
      return b / kBlocks * panel_stride + r * kPanel + b % kBlocks * kBlock;
    };
    Float sum[kVectors] = {};
    for (int64_t b = 0; b < blocks; ++b) {
      for (int v = 0; v < kVectors; ++v) sum[v] += load(x + at(b) + v * kLanes<float>);
    }
    float total = 0;
    for (int v = 0; v < kVectors; ++v) total += horizontal_sum(sum[v]);
    const Float mean = splat(total * inverse);
    Float square[kVectors] = {};
    for (int64_t b = 0; b < blocks; ++b) {
      for (int v = 0; v < kVectors; ++v) {
        Float d = load(x + at(b) + v * kLanes<float>) - mean;
        if (b == blocks - 1) d *= load(counted + v * kLanes<float>);
        square[v] += d * d;
      }
    }
    total = 0;
    for (int v = 0; v < kVectors; ++v) total += horizontal_sum(square[v]);
    const Float scale = splat(1.0f / __builtin_sqrtf(total * inverse + kNormEpsilon));
    for (int64_t b = 0; b < blocks; ++b) {
      for (int v = 0; v < kVectors; ++v) {
        const int64_t c = b * kBlock + v * kLanes<float>, i = at(b) + v * kLanes<float>;
        store(out + i, (load(x + i) - mean) * scale * load(gain + c) + load(bias + c));
      }
    }
  }
}

void exponentiate(float* x, int64_t rows, int64_t panel_stride, int64_t count, float* inverse_sum) {
  for (int64_t r = 0; r < rows; ++r) {
    float* row = x + r * kPanel;
    const auto end_of = [&](int64_t c) { return count - c < kPanel ? count - c : kPanel; };
    Float most = splat(-__builtin_inff());
    float largest = -__builtin_inff();
    for (int64_t c = 0; c < count; c += kPanel) {
      const float* p = row + c / kPanel * panel_stride;
      int64_t i = 0;
      for (; i + kLanes<float> <= end_of(c); i += kLanes<float>) {
        const Float value = load(p + i);
        most = value > most ? value : most;
      }
      for (; i < end_of(c); ++i) largest = p[i] > largest ? p[i] : largest;
    }
    for (int lane = 0; lane < kLanes<float>; ++lane) {
      largest = most[lane] > largest ? most[lane] : largest;
    }
    const Float base = splat(largest);
    Float sum{};
    float rest = 0;
    for (int64_t c = 0; c < count; c += kPanel) {
      float* p = row + c / kPanel * panel_stride;
      int64_t i = 0;
      for (; i < end_of(c); i += kLanes<float>) {
        const Float value = exponential(load(p + i) - base);
        store(p + i, value);
        if (i + kLanes<float> <= end_of(c)) {
          sum += value;
        } else {
          for (int lane = 0; i + lane < end_of(c); ++lane) rest += value[lane];
        }
      }
    }
    inverse_sum[r] = 1.0f / (horizontal_sum(sum) + rest);
  }
}

void activate_row(const float* x, int64_t count, float* out) {
  over_row(
      count, [&](int64_t i) { store(out + i, gelu(load(x + i))); },
      [&](int64_t i) { out[i] = gelu(splat(x[i]))[0]; });
}

void activate_gradient(const float* x, const float* grad, int64_t count, float* out) {
  over_row(
      count, [&](int64_t i) { store(out + i, load(grad + i) * gelu_slope(load(x + i))); },
      [&](int64_t i) { out[i] = grad[i] * gelu_slope(splat(x[i]))[0]; });
}

void attend(AttendArguments arguments) {
  const auto [query, rows, blocks, sums, row_stride, block_stride, scale, out] = arguments;
  const Float factor = splat(scale);
  for (int64_t r = 0; r < rows; ++r) {
    for (int64_t b = 0; b < blocks; ++b) {
      const float* s = sums + r * row_stride + b * block_stride;
      for (int64_t lane = 0; lane < kBlock; lane += kLanes<float>) {
        const int64_t i = r * kPanel + b * kBlock + lane;
        store(out + i, (load(query + i) * load(s + lane) + load(s + kBlock + lane)) * factor);
      }
    }
  }
}

/// With the number of inputs known, so that the inner loop unrolls.
template <int INPUTS>
void hidden_rows(const PairGeometry& geometry, const float* weight, int64_t H, float* out) {
  const int64_t pairs = geometry.pairs;
  for (int64_t h = 0; h < H; ++h, weight += INPUTS + 1) {
    for (int64_t i = 0; i < pairs; i += kLanes<float>) {
      Float sum = splat(weight[INPUTS]);
#pragma GCC unroll 8
      for (int f = 0; f < INPUTS; ++f) {
        sum = sum + splat(weight[f]) * load(geometry.values + f * pairs + i);
      }
      store(out + h * pairs + i, gelu(sum));
    }
  }
}

void hidden_positions(PairGeometry geometry, const float* weight, int64_t H, float* out) {
  if (geometry.inputs == kOffsetInputs) {
    hidden_rows<kOffsetInputs>(geometry, weight, H, out);
  } else {
    hidden_rows<kNormalInputs>(geometry, weight, H, out);
  }
}

void ridges(LobeRidges r) {
  const int64_t columns = r.blocks * kBlock;
  for (int64_t i = 0; i < r.count; ++i) {
    const Float x = splat(r.directions[3 * i]), y = splat(r.directions[3 * i + 1]),
                z = splat(r.directions[3 * i + 2]);
    for (int64_t k = 0; k < columns; k += kLanes<float>) {
      const float* lobe = r.lobes + k;
      const Float along =
          load(lobe) * x + load(lobe + r.stride) * y + load(lobe + 2 * r.stride) * z;
      store(r.out + i * kPanel + k, gelu(along + load(lobe + 3 * r.stride)));
    }
  }
}

void soften(float* x, int64_t rows) {
  for (int64_t r = 0; r < rows; ++r) {
    for (int64_t i = r * kPanel; i < r * kPanel + kBlock; i += kLanes<float>)
      store(x + i, softplus(load(x + i)));
  }
}

}  // namespace

extern const DenseKernels kDenseKernels;
const DenseKernels kDenseKernels{multiply_blocks<SingleProduct>,
                                 activate,
                                 activate_row,
                                 activate_gradient,
                                 activate_sum,
                                 maximize,
                                 accumulate,
                                 layer_norm,
                                 exponentiate,
                                 attend,
                                 hidden_positions,
                                 ridges,
                                 soften};

}  // namespace lte::ops::LTE_ISA
