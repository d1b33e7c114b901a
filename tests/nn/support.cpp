#include "tests/nn/support.h"

#include <gtest/gtest.h>
#include <torch/csrc/autograd/autograd.h>

namespace lte::test {
namespace {

/// Thousands of operations on a few dozen rows: starting threads for each would take longer than
/// the work.
class OneThread : public ::testing::Environment {
  void SetUp() override { at::set_num_threads(1); }
};
const ::testing::Environment* const kOneThread =
    ::testing::AddGlobalTestEnvironment(new OneThread);  // owned by GoogleTest

}  // namespace

namespace {

void random_surface(int64_t rows, uint64_t seed, at::Tensor* position, at::Tensor* normal,
                    at::Tensor* albedo) {
  torch::manual_seed(seed);
  const at::Tensor size = torch::tensor({64, 48, 80});  // sixteenths of a metre
  *position = (torch::rand({rows, 3}) * size).round();
  *normal = torch::zeros({rows, 3});
  const at::Tensor axis = torch::randint(3, {rows}), far = torch::randint(2, {rows});
  for (int64_t i = 0; i < rows; ++i) {
    const int64_t a = axis[i].item<int64_t>();
    const bool high = far[i].item<int64_t>() == 1;
    position->index_put_({i, a}, high ? size[a].item<double>() : 0.0);
    normal->index_put_({i, a}, high ? -1.0 : 1.0);
  }
  position->div_(16);
  *albedo = torch::rand({rows, 3});
}

}  // namespace

nn::PointSet box_scene(int64_t M, uint64_t seed) {
  nn::PointSet points;
  random_surface(M, seed, &points.position, &points.normal, &points.albedo);
  const at::Tensor lit = torch::arange(M).remainder(10).eq(0).unsqueeze(1);
  points.emission = torch::where(lit, 5 + 10 * torch::rand({M, 3}), torch::zeros({M, 3}));
  points.area = 0.01 + torch::rand({M}) * 0.01;
  points.direct = torch::where(lit, torch::zeros({M, 3}), 8 * torch::rand({M, 3}));
  points.indirect = torch::where(lit, torch::zeros({M, 3}), 3 * torch::rand({M, 3}));
  // Every third point is on a sheet; the others are on closed bodies.
  const at::Tensor share = torch::arange(M).remainder(3).eq(0).unsqueeze(1).to(at::kFloat) * 0.375;
  points.direct_back = points.direct * share;
  points.indirect_back = points.indirect * share;
  points.indirect_error = torch::arange(2 * M).remainder(7).to(at::kFloat).view({M, 2}).div(8);
  return points;
}

nn::QuerySet box_queries(int64_t Q, uint64_t seed) {
  nn::QuerySet queries;
  random_surface(Q, seed, &queries.position, &queries.normal, &queries.albedo);
  return queries;
}

nn::PointSet as_double(nn::PointSet points) {
  for (at::Tensor* t : points.tensors()) {
    if (t->defined()) *t = t->to(at::kDouble);
  }
  return points;
}

nn::QuerySet as_double(nn::QuerySet queries) {
  for (at::Tensor* t : {&queries.position, &queries.normal, &queries.albedo}) {
    *t = t->to(at::kDouble);
  }
  return queries;
}

double relative_difference(const at::Tensor& a, const at::Tensor& b) {
  const at::Tensor reference = b.to(at::kDouble);
  return ((a.to(at::kDouble) - reference).norm() / (reference.norm() + 1e-30)).item<double>();
}

void expect_gradients_match(const std::function<at::Tensor()>& f,
                            const std::vector<at::Tensor>& inputs, double tolerance) {
  constexpr double kStep = 1e-6;
  const auto gradients = torch::autograd::grad({f()}, inputs);
  const at::NoGradGuard no_grad;
  for (size_t i = 0; i < inputs.size(); ++i) {
    at::Tensor x = inputs[i];
    const at::Tensor direction = torch::randn_like(x);
    x.add_(direction, kStep);
    const double above = f().item<double>();
    x.sub_(direction, 2 * kStep);
    const double below = f().item<double>();
    x.add_(direction, kStep);
    const double numeric = (above - below) / (2 * kStep);
    const double analytic = (gradients[i] * direction).sum().item<double>();
    const double scale = 1 + std::abs(numeric);
    EXPECT_NEAR(analytic, numeric, tolerance * scale) << "input " << i << " of shape " << x.sizes();
    EXPECT_NE(analytic, 0) << "input " << i << " of shape " << x.sizes() << " has no influence";
  }
}

void expect_error(const std::function<void()>& body, const std::vector<std::string>& parts) {
  try {
    body();
  } catch (const std::exception& error) {
    const std::string message = error.what();
    for (const std::string& part : parts) {
      EXPECT_NE(message.find(part), std::string::npos) << "no \"" << part << "\" in: " << message;
    }
    return;
  }
  ADD_FAILURE() << "nothing was thrown; expected \"" << (parts.empty() ? "" : parts[0]) << '"';
}

}  // namespace lte::test
