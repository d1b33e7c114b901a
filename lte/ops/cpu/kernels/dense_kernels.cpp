// Dense layers, norms and activations over tiles of rows that stay in the caches.
#include "lte/ops/cpu/kernels/gelu_vector.h"
#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/ops/cpu/kernels/product.h"
#include "lte/ops/cpu/kernels/transpose.h"
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

/// Some columns of a row, a multiple of kBlock, that lie one after the other.
struct Run {
  int64_t offset, first, count;  ///< where they lie, and which columns they are
};

/// Calls use(run) for the panels of a row of `columns`, whole blocks.
template <typename Use>
inline void over_panels(int64_t columns, int64_t panel_stride, const Use& use) {
  for (int64_t c = 0; c < columns; c += kPanel) {
    use(Run{c / kPanel * panel_stride, c, columns - c < kPanel ? columns - c : kPanel});
  }
}

/// Σ of value(i) over the vectors that begin at [from, to), in two chains.
template <typename Value>
inline Float sum_vectors(int64_t from, int64_t to, const Value& value) {
  Float even{}, odd{};
  int64_t i = from;
#pragma GCC unroll 4
  for (; i + 2 * kLanes<float> <= to; i += 2 * kLanes<float>) {
    even += value(i);
    odd += value(i + kLanes<float>);
  }
  if (i < to) even += value(i);
  return even + odd;
}

void layer_norm(const float* x, int64_t rows, int64_t panel_stride, int64_t channels,
                const float* gain, const float* bias, float* out) {
  const int64_t columns = (channels + kBlock - 1) / kBlock * kBlock,
                whole = channels / kBlock * kBlock;
  // Columns past the last channel hold zeros; they must not count in the variance.
  float counted[kBlock];
  for (int64_t i = 0; i < kBlock; ++i) counted[i] = whole + i < channels ? 1.0f : 0.0f;
  const float inverse = 1.0f / static_cast<float>(channels);
  for (int64_t r = 0; r < rows; ++r) {
    const float* row = x + r * kPanel;
    Float sum{};
    over_panels(columns, panel_stride, [&](const Run& run) {
      sum += sum_vectors(0, run.count, [&](int64_t i) { return load(row + run.offset + i); });
    });
    const Float mean = splat(horizontal_sum(sum) * inverse);
    Float squares{};
    over_panels(columns, panel_stride, [&](const Run& run) {
      const auto square = [&](int64_t i) {
        const Float d = load(row + run.offset + i) - mean;
        return d * d;
      };
      const int64_t full = run.first + run.count > whole ? run.count - kBlock : run.count;
      squares += sum_vectors(0, full, square);
      squares += sum_vectors(full, run.count,
                             [&](int64_t i) { return square(i) * load(counted + (i - full)); });
    });
    const float variance = horizontal_sum(squares) * inverse;
    const Float scale = splat(1.0f / __builtin_sqrtf(variance + kNormEpsilon));
    over_panels(columns, panel_stride, [&](const Run& run) {
      const float* from = row + run.offset;
      float* to = out + r * kPanel + run.offset;
#pragma GCC unroll 4
      for (int64_t i = 0; i < run.count; i += kLanes<float>) {
        const int64_t c = run.first + i;
        store(to + i, (load(from + i) - mean) * (scale * load(gain + c)) + load(bias + c));
      }
    });
  }
}

void exponentiate(float* x, int64_t rows, int64_t panel_stride, int64_t count, float* inverse_sum,
                  float* largest_of_row) {
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
    largest_of_row[r] = largest;
    const Float base = splat(largest), least = splat(-120.0f);
    Float sum{};
    float rest = 0;
    for (int64_t c = 0; c < count; c += kPanel) {
      float* p = row + c / kPanel * panel_stride;
      int64_t i = 0;
      for (; i < end_of(c); i += kLanes<float>) {
        const Float exponent = load(p + i) - base;
        const Float power = power_of_two(exponent), value = exponent > least ? power : Float{};
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

float largest_square(const float* x, int64_t rows, int64_t stride, int64_t columns) {
  float largest = 0, finite = 0;
  for (int64_t r = 0; r < rows; ++r) {
    const float* row = x + r * stride;
    const int64_t whole = columns / kLanes<float> * kLanes<float>;
    float square = horizontal_sum(
        sum_vectors(0, whole, [&](int64_t i) { return load(row + i) * load(row + i); }));
    for (int64_t i = whole; i < columns; ++i) square += row[i] * row[i];
    largest = square > largest ? square : largest;
    finite += square * 0;
  }
  return largest + finite;
}

void raise(float* x, int64_t rows, int64_t count, float* sum) {
  for (int64_t r = 0; r < rows; ++r) {
    float* row = x + r * kPanel;
    Float total = load(sum + r * kBlock);
    int64_t i = 0;
#pragma GCC unroll 4
    for (; i + kLanes<float> <= count; i += kLanes<float>) {
      const Float value = power_of_two(load(row + i));
      store(row + i, value);
      total += value;
    }
    if (i < count) {
      float value[kLanes<float>] = {};
      for (int64_t lane = 0; i + lane < count; ++lane) {
        value[lane] = row[i + lane] = power_of_two(splat(row[i + lane]))[0];
      }
      total += load(value);
    }
    store(sum + r * kBlock, total);
  }
}

void transpose(TransposedRows<float> rows, float factor) {
  const Float scale = splat(factor);
  transpose_rows(rows, [&](const Float& values) { return values * scale; });
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
                                 largest_square,
                                 raise,
                                 attend,
                                 transpose,
                                 hidden_positions,
                                 ridges,
                                 soften};

}  // namespace lte::ops::LTE_ISA
