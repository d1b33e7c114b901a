// A group of one process on a GPU: NCCL's collectives, which then leave everything as it is.
#include <chrono>

#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "lte/nn/device.h"
#include "tests/ops/per_device.h"
#include "tests/train/free_port.h"
#include "train/distributed/process_group.h"

namespace lte::train {
namespace {

TEST(NcclGroup, OneProcessSumsBroadcastsAndReducesItsOwn) {
  if (const std::string obstacle = nn::cuda_obstacle(); !obstacle.empty()) {
    ASSERT_FALSE(ops::test::requires_cuda()) << "LTE_REQUIRE_CUDA=1, and " << obstacle;
    GTEST_SKIP() << obstacle;
  }
  Rank rank;
  rank.port = test::free_port();
  ProcessGroup group(rank, at::Device(at::kCUDA, 0), std::chrono::seconds(60));
  group.begin_step(1);
  EXPECT_EQ(group.sum({1.5, -2, 1e300}), (std::vector<double>{1.5, -2, 1e300}));
  const at::Tensor values = at::arange(1000, at::device(at::kCUDA).dtype(at::kFloat));
  const at::Tensor before = values.clone();
  group.broadcast({values});
  EXPECT_TRUE(at::equal(values, before));
  at::Tensor weight = before.clone().requires_grad_();
  GradientReducer reducer(group, {weight});
  reducer.reduce_next_backward();
  weight.square().sum().backward();
  EXPECT_TRUE(at::allclose(weight.grad(), 2 * before));
  group.wait_for_all();
}

}  // namespace
}  // namespace lte::train
