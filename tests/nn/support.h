// Small networks, scenes and a finite-difference check for the tests of lte::nn.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lte/nn/model.h"
#include "lte/tensor/module.h"
#include "tests/nn/tiny_model.h"

namespace lte::test {

/// M points on the walls of a 4 x 3 x 5 m box, a tenth of them emitting. Positions are multiples of
/// 1/16 m.
nn::PointSet box_scene(int64_t M, uint64_t seed);
nn::QuerySet box_queries(int64_t Q, uint64_t seed);
nn::PointSet as_double(nn::PointSet points);
nn::QuerySet as_double(nn::QuerySet queries);

/// Redraws every parameter, so that none is at a special value such as a LayerNorm's 1 and 0.
void randomize(torch::nn::Module& module, uint64_t seed);

/// |a − b| / |b| in the Euclidean norm.
double relative_difference(const at::Tensor& a, const at::Tensor& b);

/// The same numbers, bit for bit.
bool same(const at::Tensor& a, const at::Tensor& b);

/// Compares the derivative of `f` along one random direction in each of `inputs` (double, requiring
/// gradients) with a central difference.
void expect_gradients_match(const std::function<at::Tensor()>& f,
                            const std::vector<at::Tensor>& inputs, double tolerance = 1e-6);

/// Expects `body` to throw, with a message that contains every one of `parts`.
void expect_error(const std::function<void()>& body, const std::vector<std::string>& parts);

}  // namespace lte::test
