// Newton-Schulz steps on the CPU. A thread takes a matrix through all of them: at the widths that
// one trains there the Gram matrix and what is made of it stay in the caches, where a batch of
// small products passes by memory and reaches a quarter of the arithmetic's rate.
#include "lte/ops/cpu/dense/orthogonal_cpu.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lte/ops/cpu/dense/tile_layers.h"
#include "lte/tensor/functions.h"

namespace lte::ops {
namespace {

constexpr int64_t kRowTile = 96;  ///< rows of the matrix at a time
constexpr int64_t kPanelBlocks = kPanel / kBlock;

/// One thread's working memory for matrices of M columns.
class OrthogonalFactor {
 public:
  explicit OrthogonalFactor(int64_t M)
      : M_(M),
        rows_(kRowTile, M),
        answer_(kRowTile, M),
        gram_(M, M),
        square_(M, M),
        change_(M, M),
        factor_(M, M) {}

  /// @param from, to  [N, M]
  void run(const float* from, int64_t N, float* to) {
    make_gram(from, N);
    float square = 0;  // of the Frobenius norm
    for (int64_t i = 0; i < M_; ++i) square += diagonal(gram_, i);
    square = std::max(square, NewtonSchulz::kMinSquare);
    const float inverse = 1 / square, inverse_length = 1 / std::sqrt(square);
    over_rows([&](int64_t row, int64_t columns) {
      float* x = gram_.panel(0) + row;
      for (int64_t c = 0; c < columns; ++c) x[c] *= inverse;
    });
    for (int step = 0; step < NewtonSchulz::kSteps; ++step) {
      make_change();
      if (step == 0) {
        over_rows([&](int64_t row, int64_t columns) {
          const float* change = change_.panel(0) + row;
          float* x = factor_.panel(0) + row;
          for (int64_t c = 0; c < columns; ++c) x[c] = change[c] * inverse_length;
        });
      } else {
        multiply(factor_, M_, change_, square_);
        std::swap(factor_, square_);
      }
      if (step + 1 == NewtonSchulz::kSteps) break;
      multiply(change_, M_, gram_, square_);
      multiply(square_, M_, change_, gram_);
    }
    for (int64_t first = 0; first < N; first += kRowTile) {
      const int64_t rows = std::min(kRowTile, N - first);
      load_rows(from, M_, first, rows, rows_);
      multiply(rows_, rows, factor_, answer_);
      store_rows(answer_, M_, first, rows, to);
    }
  }

 private:
  static float& diagonal(Tile& tile, int64_t i) {
    return tile.panel(i / kPanel)[i * kPanel + i % kPanel];
  }

  /// Calls use(first, columns) for the part of each row of an M × M tile that lies in a panel.
  template <typename Use>
  void over_rows(const Use& use) const {
    for (int64_t p = 0; p < panels_of(M_); ++p) {
      for (int64_t r = 0; r < M_; ++r)
        use((p * M_ + r) * kPanel, std::min(kPanel, M_ - p * kPanel));
    }
  }

  int64_t blocks_of_panel(int64_t p) const {
    return std::min(blocks_of(M_) - p * kPanelBlocks, kPanelBlocks);
  }

  /// The product of the matrix's transpose and itself.
  void make_gram(const float* from, int64_t N) {
    for (int64_t first = 0; first < N; first += kRowTile) {
      const int64_t rows = std::min(kRowTile, N - first);
      load_rows(from, M_, first, rows, rows_);
      for (int64_t left = 0; left < M_; left += kPanel) {
        for (int64_t p = 0; p < panels_of(M_); ++p) {
          gradient_kernels().multiply_transposed({rows_.panel(left / kPanel),
                                                  std::min(kPanel, M_ - left), rows, rows_.panel(p),
                                                  kPanel, kBlock, nullptr, blocks_of_panel(p),
                                                  first > 0, gram_.panel(p) + left * kPanel});
        }
      }
    }
  }

  /// change = a + b gram + c gram².
  void make_change() {
    multiply(gram_, M_, gram_, change_);
    over_rows([&](int64_t row, int64_t columns) {
      const float* gram = gram_.panel(0) + row;
      float* x = change_.panel(0) + row;
      for (int64_t c = 0; c < columns; ++c)
        x[c] = NewtonSchulz::kB * gram[c] + NewtonSchulz::kC * x[c];
    });
    for (int64_t i = 0; i < M_; ++i) diagonal(change_, i) += NewtonSchulz::kA;
  }

  /// out = x · right, of `rows` rows and M columns.
  void multiply(const Tile& x, int64_t rows, const Tile& right, Tile& out) const {
    for (int64_t p = 0; p < panels_of(M_); ++p) {
      for (int64_t k = 0; k < M_; k += kPanel) {
        dense_kernels().multiply({x.panel(k / kPanel), rows, std::min(kPanel, M_ - k),
                                  right.panel(p) + k * kPanel, kPanel, kBlock, nullptr,
                                  blocks_of_panel(p), k > 0, out.panel(p)});
      }
    }
  }

  int64_t M_;
  Tile rows_, answer_;
  Tile gram_, square_, change_, factor_;
};

}  // namespace

at::Tensor orthogonal_cpu(const at::Tensor& matrices) {
  const int64_t N = matrices.size(1), M = matrices.size(2);
  at::Tensor out = at::empty_like(matrices);
  const auto* from = matrices.const_data_ptr<float>();
  auto* to = out.data_ptr<float>();
  at::parallel_for(0, matrices.size(0), 1, [&](int64_t begin, int64_t end) {
    OrthogonalFactor factor(M);
    for (int64_t i = begin; i < end; ++i) factor.run(from + i * N * M, N, to + i * N * M);
  });
  return out;
}

}  // namespace lte::ops
