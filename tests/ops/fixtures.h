// Point sets, thread counts and finite differences for the tests of operators.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <ATen/ATen.h>
#include <ATen/Parallel.h>
#include <c10/core/GradMode.h>
#include <gtest/gtest.h>

namespace lte::ops::test {

inline at::Generator generator(uint64_t seed) {
  return at::make_generator<at::CPUGeneratorImpl>(seed);
}

inline at::Tensor uniform(at::IntArrayRef shape, uint64_t seed, at::ScalarType dtype = at::kFloat) {
  return at::rand(shape, generator(seed), at::TensorOptions().dtype(dtype));
}

inline at::Tensor normal(at::IntArrayRef shape, uint64_t seed, at::ScalarType dtype = at::kDouble) {
  return at::randn(shape, generator(seed), at::TensorOptions().dtype(dtype));
}

inline at::Tensor floats(at::IntArrayRef shape, uint64_t seed) {
  return normal(shape, seed, at::kFloat);
}

/// To the nearest bfloat16, ties to even, by LibTorch; as float64.
inline at::Tensor rounded(const at::Tensor& x) {
  return x.to(at::kFloat).to(at::kBFloat16).to(at::kDouble);
}

inline at::Tensor integers(int64_t high, at::IntArrayRef shape, uint64_t seed,
                           at::ScalarType dtype = at::kLong) {
  return at::randint(high, shape, generator(seed), at::TensorOptions().dtype(dtype));
}

/// Euclidean norm of the difference over that of the reference.
inline double norm_error(const at::Tensor& got, const at::Tensor& expected) {
  return ((got.to(at::kDouble) - expected).norm() / expected.norm()).item<double>();
}

/// Point sets that break searches: name and [N, 3] float32.
inline std::vector<std::pair<std::string, at::Tensor>> awkward_points(int64_t N) {
  const at::Tensor base = uniform({N, 3}, 7);
  at::Tensor coplanar = base.clone();
  coplanar.select(1, 1).fill_(0.25f);
  at::Tensor collinear = coplanar.clone();
  collinear.select(1, 2).fill_(-3.0f);
  at::Tensor clustered = (base * 1e-4f + uniform({N, 1}, 8).mul(8).floor()).contiguous();
  at::Tensor outlier = base.clone();
  if (N > 0) outlier[N / 2].fill_(1e6f);
  return {{"uniform", base},
          {"coplanar", coplanar},
          {"collinear", collinear},
          {"clustered", clustered},
          {"lattice", base.mul(4).floor()},  // many duplicates, many equal distances
          {"coincident", at::full({N, 3}, 1.5f)},
          {"far", base + 1e6f},
          {"outlier", outlier},
          {"tiny", base * 1e-25f},          // squares underflow
          {"huge", base * 1e30f - 5e29f}};  // squares overflow
}

/// Runs `body` on `threads` threads.
template <typename Body>
auto with_threads(int threads, const Body& body) {
  const int before = at::get_num_threads();
  at::set_num_threads(threads);
  auto result = body();
  at::set_num_threads(before);
  return result;
}

/// Whether `function` throws an error whose message contains `words`.
inline ::testing::AssertionResult throws_saying(const std::function<void()>& function,
                                                const std::string& words) {
  try {
    function();
  } catch (const c10::Error& error) {
    const std::string message = error.what_without_backtrace();
    if (message.find(words) != std::string::npos) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "the error says: " << message;
  }
  return ::testing::AssertionFailure() << "nothing was thrown";
}

/// Central differences of a scalar function by every entry of `x`, in float64.
inline at::Tensor numerical_gradient(const std::function<at::Tensor(const at::Tensor&)>& function,
                                     const at::Tensor& x, double step = 1e-5) {
  const c10::AutoGradMode no_grad(false);
  at::Tensor probe = x.detach().clone().contiguous(), gradient = at::empty_like(probe);
  auto* at_probe = probe.data_ptr<double>();
  auto* out = gradient.data_ptr<double>();
  for (int64_t i = 0; i < probe.numel(); ++i) {
    const double value = at_probe[i];
    at_probe[i] = value + step;
    const double above = function(probe).item<double>();
    at_probe[i] = value - step;
    const double below = function(probe).item<double>();
    at_probe[i] = value;
    out[i] = (above - below) / (2 * step);
  }
  return gradient;
}

/// Largest difference over the largest reference value.
inline double relative_error(const at::Tensor& value, const at::Tensor& reference) {
  if (reference.numel() == 0) return value.numel() == 0 ? 0 : 1;
  const at::Tensor exact = reference.to(at::kDouble);
  return ((value.to(at::kDouble) - exact).abs().max() / exact.abs().max().clamp_min(1e-30))
      .item<double>();
}

}  // namespace lte::ops::test
