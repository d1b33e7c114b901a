// Whether the cases on CUDA exist and run where they are required.
#include <gtest/gtest.h>

#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

TEST(Cuda, IsThereWhereItIsRequired) {
  if (!test::requires_cuda()) return;
  EXPECT_EQ(test::devices().size(), 2u) << "LTE_REQUIRE_CUDA=1, and the operators lack CUDA";
  EXPECT_TRUE(at::hasCUDA()) << "LTE_REQUIRE_CUDA=1, and no device";
}

}  // namespace
}  // namespace lte::ops
