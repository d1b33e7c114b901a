// Tests of an operator that run once on each device:
//   class Knn : public test::PerDevice {};
//   LTE_FOR_EACH_DEVICE(Knn);
//   TEST_P(Knn, ...) { knn(put(queries), put(points), 8); }
//
// Cases on CUDA exist where the operators were built with it. There, without a GPU, they skip;
// LTE_REQUIRE_CUDA=1 makes that a failure, and so is a build without CUDA (required_cuda_test.cpp).
#pragma once

#include <cstdlib>
#include <string>
#include <vector>

#include <ATen/ATen.h>
#include <gtest/gtest.h>

namespace lte::ops::test {

inline bool requires_cuda() {
  const char* required = std::getenv("LTE_REQUIRE_CUDA");
  return required != nullptr && std::string(required) == "1";
}

class PerDevice : public ::testing::TestWithParam<at::DeviceType> {
 protected:
  void SetUp() override {
    if (on_cpu() || at::hasCUDA()) return;
    ASSERT_FALSE(requires_cuda()) << "LTE_REQUIRE_CUDA=1, and no device";
    GTEST_SKIP() << "no CUDA device";
  }

  bool on_cpu() const { return GetParam() == at::kCPU; }

  at::Tensor put(const at::Tensor& t) const { return t.defined() ? t.to(GetParam()) : t; }

  std::vector<at::Tensor> put(std::vector<at::Tensor> tensors) const {
    for (at::Tensor& t : tensors) t = put(t);
    return tensors;
  }

  /// The largest relative error of float32 sums: as given on the CPU, where the order of the terms
  /// is fixed; 1e-4 on CUDA, whose libraries choose it by size and model.
  double tolerance(double on_the_cpu) const { return on_cpu() ? on_the_cpu : 1e-4; }
};

inline std::vector<at::DeviceType> devices() {
#if defined(LTE_WITH_CUDA)
  return {at::kCPU, at::kCUDA};
#else
  return {at::kCPU};
#endif
}

inline std::string device_name(const ::testing::TestParamInfo<at::DeviceType>& info) {
  return info.param == at::kCPU ? "Cpu" : "Cuda";
}

}  // namespace lte::ops::test

#define LTE_FOR_EACH_DEVICE(Suite)                                                      \
  INSTANTIATE_TEST_SUITE_P(On, Suite, ::testing::ValuesIn(::lte::ops::test::devices()), \
                           ::lte::ops::test::device_name)
