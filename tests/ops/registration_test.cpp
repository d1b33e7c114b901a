// The operators as TorchScript and Python see them: by name, with boxed arguments.
#include <ATen/ATen.h>
#include <ATen/core/dispatch/Dispatcher.h>
#include <gtest/gtest.h>

#include "lte/ops/curve_codes.h"
#include "lte/ops/knn.h"
#include "lte/ops/neighbour_sums.h"
#include "tests/ops/fixtures.h"
#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

std::vector<c10::IValue> call(const char* name, std::vector<c10::IValue> arguments) {
  c10::Dispatcher::singleton().findSchemaOrThrow(name, "").callBoxed(&arguments);
  return arguments;
}

class Registration : public test::PerDevice {};
LTE_FOR_EACH_DEVICE(Registration);

TEST_P(Registration, EveryOperatorAnswersToItsName) {
  const at::Tensor points = put(test::uniform({40, 3}, 61));
  const at::Tensor cells = put(test::integers(6, {40, 3}, 62, at::kInt));
  EXPECT_TRUE(at::equal(call("lte::curve_codes", {cells, 2, 16})[0].toTensor(),
                        curve_codes(cells, Curve::Hilbert)));
  const auto neighbours = call("lte::knn", {points, points, 4});
  EXPECT_TRUE(at::equal(neighbours[0].toTensor(), std::get<0>(knn(points, points, 4))));
  EXPECT_TRUE(at::equal(neighbours[1].toTensor(), std::get<1>(knn(points, points, 4))));
  EXPECT_EQ(call("lte::farthest_point_sampling", {points, 8})[0].toTensor().size(0), 8);

  const auto map = call("lte::convolution_pairs", {cells, 3});
  const at::Tensor weight = put(at::ones({27, 3, 5}));
  EXPECT_EQ(call("lte::submanifold_conv", {points, weight, c10::IValue(), map[0], map[1]})[0]
                .toTensor()
                .sizes(),
            (at::IntArrayRef{40, 5}));

  const at::Tensor keys = put(at::ones({2, 40, 5})), position = put(at::ones({40, 4, 5}));
  const auto sums = call("lte::neighbour_sums", {keys, keys, position, neighbours[0]});
  EXPECT_TRUE(at::equal(sums[0].toTensor().cpu(), at::full({2, 40, 5}, 8.0f)));
  const at::Tensor table = call("lte::neighbour_table", {keys, keys})[0].toTensor();
  const auto fused = call("lte::neighbour_sums_inference", {table, position, put(at::zeros({5, 5})),
                                                            put(at::ones({5})), neighbours[0]});
  EXPECT_TRUE(at::equal(fused[0].toTensor(), sums[0].toTensor()));
}

TEST_P(Registration, OperatorsDifferentiateWhenCalledByName) {
  at::Tensor keys = test::normal({2, 6, 5}, 63).requires_grad_();
  const auto sums = call("lte::neighbour_sums",
                         {put(keys), put(test::normal({2, 6, 5}, 64)),
                          put(test::normal({7, 3, 5}, 65)), put(test::integers(6, {7, 3}, 66))});
  sums[1].toTensor().sum().backward();
  EXPECT_GT(keys.grad().abs().sum().item<double>(), 0);
}

}  // namespace
}  // namespace lte::ops
