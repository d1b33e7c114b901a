// The network on a GPU against the network on the CPU: answers, loss and every gradient.
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "lte/nn/device.h"
#include "lte/nn/loss.h"
#include "lte/nn/model.h"
#include "tests/nn/support.h"
#include "tests/ops/per_device.h"

namespace lte::nn {
namespace {

constexpr int64_t kPoints = 300, kQueries = 90, kEach = 4;

struct Network {
  std::string name;
  ModelConfig config;
};

std::vector<Network> networks() {
  std::vector<Network> all = {{"Plain", test::tiny_config()},
                              {"Geometric", test::tiny_geometric_config()},
                              {"Traced", test::tiny_geometric_config()},
                              {"Radiance", test::tiny_geometric_config()},
                              {"Paper", {}}};
  ModelConfig& traced = all[2].config;
  traced.light_input = LightInput::Traced;
  ModelConfig& radiance = all[3].config;
  radiance.light_input = LightInput::Traced;
  radiance.radiance_lobes = 6;
  all[4].config.channels = 32;
  all[4].config.dropout = 0;
  return all;
}

class NetworkOnCuda : public testing::TestWithParam<Network> {
 protected:
  void SetUp() override {
    const std::string obstacle = cuda_obstacle();
    if (obstacle.empty()) return;
    ASSERT_FALSE(ops::test::requires_cuda()) << "LTE_REQUIRE_CUDA=1, and " << obstacle;
    GTEST_SKIP() << obstacle;
  }

  static LightTransportModel model_on(at::Device device) {
    LightTransportModel model(GetParam().config);
    test::randomize(*model, 21);
    model->to(device);
    model->eval();
    return model;
  }
  static PointSet points() {
    PointSet points = test::box_scene(kPoints, 1);
    at::manual_seed(9);
    points.gloss = at::rand({kPoints, 2});
    return points;
  }
  static at::Tensor directions() {
    at::manual_seed(7);
    const at::Tensor way =
        test::box_queries(kQueries, 2).normal.unsqueeze(1) + 0.5 * at::rand({kQueries, kEach, 3});
    return way.div(way.norm(2, {2}, true));
  }
  static at::Tensor answers(at::Device device) {
    const at::NoGradGuard no_grad;
    LightTransportModel model = model_on(device);
    const Embedding embedding = model->encode(points().to(device));
    const QuerySet queries = test::box_queries(kQueries, 2).to(device);
    at::Tensor all = model->decode(embedding, queries).cpu();
    if (GetParam().config.radiance_lobes > 0) {
      const at::Tensor radiance =
          model->decode_radiance(embedding, queries, directions().to(device)).cpu();
      EXPECT_GT(radiance.mean().item<float>(), 0);
      all = at::cat({all, radiance.reshape({-1, 3})});
    }
    return all;
  }

  struct Gradients {
    double loss = 0;
    std::map<std::string, at::Tensor> of;
  };
  static Gradients gradients(at::Device device) {
    LightTransportModel model = model_on(device);
    model->train();
    const SceneBatch batch = model->encode_batch({points().to(device)}, {3});
    const std::vector<QuerySet> queries = {test::box_queries(kQueries, 2).to(device)};
    const at::Tensor answer = model->decode_normalized(batch, queries).at(0);
    at::manual_seed(5);
    const at::Tensor target = at::rand({kQueries, 3}).to(device);
    const at::Tensor loss =
        relative_loss(answer, target, {.epsilon = 1, .space = LossSpace::Linear});
    loss.backward();
    Gradients out = {loss.item<double>(), {}};
    for (const auto& p : model->named_parameters()) {
      if (p.value().grad().defined()) out.of[p.key()] = p.value().grad().cpu();
    }
    return out;
  }
};

TEST_P(NetworkOnCuda, AnswersAreTheCpus) {
  const at::Tensor right = answers(at::kCPU), got = answers(at::kCUDA);
  EXPECT_TRUE(got.isfinite().all().item<bool>());
  EXPECT_LT(test::relative_difference(got, right), 1e-4);
}

TEST_P(NetworkOnCuda, LossAndGradientsAreTheCpus) {
  const Gradients right = gradients(at::kCPU), got = gradients(at::kCUDA);
  EXPECT_NEAR(got.loss, right.loss, 1e-4 * right.loss);
  ASSERT_EQ(got.of.size(), right.of.size());
  ASSERT_FALSE(right.of.empty());
  for (const auto& [name, gradient] : right.of) {
    EXPECT_LT(test::relative_difference(got.of.at(name), gradient), 1e-3) << name;
  }
}

std::string name_of(const testing::TestParamInfo<Network>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Networks, NetworkOnCuda, testing::ValuesIn(networks()), name_of);

}  // namespace
}  // namespace lte::nn
