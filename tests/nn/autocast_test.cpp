// The network's gradients in mixed precision against float32, against float64 and against finite
// differences, and training steps on embeddings and scenes chosen to hurt.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <torch/csrc/autograd/autograd.h>
#include <torch/optim/adamw.h>

#include "lte/nn/loss.h"
#include "tests/nn/adversaries.h"
#include "tests/nn/support.h"

namespace lte::nn {
namespace {

struct Step {
  at::Tensor loss, gradient;  ///< of all parameters, one after another
};

Step step(LightTransportModel& model, const PointSet& points, const QuerySet& queries,
          const at::Tensor& target) {
  const at::Tensor loss = relative_loss(model->decode_normalized(model->encode(points), queries),
                                        target, LossConfig{0.3, false});
  std::vector<at::Tensor> flat;
  for (const at::Tensor& g : torch::autograd::grad({loss}, model->parameters()))
    flat.push_back(g.flatten());
  return {loss.detach(), at::cat(flat)};
}

LightTransportModel model_with_seed(uint64_t seed) {
  torch::manual_seed(seed);
  LightTransportModel model(test::tiny_config());
  model->eval();  // fixed curve orders
  return model;
}

LightTransportModel as_double(const LightTransportModel& model) {
  const at::NoGradGuard no_grad;
  LightTransportModel exact(model->config());
  const auto weights = model->named_parameters();
  for (auto& item : exact->named_parameters()) item.value().copy_(weights[item.key()]);
  exact->to(at::kDouble);
  exact->eval();
  return exact;
}

at::Tensor some_target(int64_t Q) {
  torch::manual_seed(5);
  return torch::rand({Q, 3}).square();
}

TEST(Autocast, GradientsAreNearThoseOfFloat32AndFloat64) {
  LightTransportModel model = model_with_seed(32);
  LightTransportModel exact = as_double(model);
  const QuerySet queries = test::box_queries(150, 6);
  const at::Tensor target = some_target(150);
  for (const test::SceneAdversary& adversary : test::scene_adversaries(300)) {
    set_autocast(*model, Precision::Fp32);
    const Step single = step(model, adversary.points, queries, target);
    set_autocast(*model, Precision::Bf16);
    const Step half = step(model, adversary.points, queries, target);
    const Step reference = step(exact, test::as_double(adversary.points), test::as_double(queries),
                                target.to(at::kDouble));
    EXPECT_EQ(half.gradient.scalar_type(), at::kFloat);
    EXPECT_LT(test::relative_difference(half.gradient, single.gradient), 0.1) << adversary.name;
    EXPECT_GT(test::relative_difference(half.gradient, single.gradient), 1e-4) << adversary.name;
    EXPECT_LT(test::relative_difference(half.gradient.to(at::kDouble), reference.gradient), 0.1)
        << adversary.name;
    EXPECT_LT(test::relative_difference(half.loss, single.loss), 0.02) << adversary.name;
  }
}

TEST(Autocast, TheSlopeAlongTheGradientIsThatOfFiniteDifferencesInFloat64) {
  LightTransportModel model = model_with_seed(33);
  LightTransportModel exact = as_double(model);
  const PointSet points = test::box_scene(300, 33);
  const QuerySet queries = test::box_queries(150, 6);
  const at::Tensor target = some_target(150);
  set_autocast(*model, Precision::Bf16);
  const at::Tensor gradient = step(model, points, queries, target).gradient.to(at::kDouble);
  const at::Tensor direction = gradient / gradient.norm();
  const auto loss_at = [&](double distance) {
    const at::NoGradGuard no_grad;
    LightTransportModel moved = as_double(exact);
    int64_t begin = 0;
    for (at::Tensor& p : moved->parameters()) {
      p.add_(direction.narrow(0, begin, p.numel()).view(p.sizes()), distance);
      begin += p.numel();
    }
    const Embedding embedding = moved->encode(test::as_double(points));
    return relative_loss(moved->decode_normalized(embedding, test::as_double(queries)),
                         target.to(at::kDouble), LossConfig{0.3, false})
        .item<double>();
  };
  const double h = 1e-5, slope = (loss_at(h) - loss_at(-h)) / (2 * h);
  EXPECT_NEAR(gradient.norm().item<double>(), slope, 0.02 * slope);
}

TEST(Autocast, IsOfGradientsAloneAndCanBeTakenBack) {
  LightTransportModel model = model_with_seed(34);
  const PointSet points = test::box_scene(200, 5);
  const QuerySet queries = test::box_queries(60, 6);
  const at::Tensor target = some_target(60);
  const auto inferred = [&] {
    const at::NoGradGuard no_grad;
    return model->decode(model->encode(points), queries);
  };
  const at::Tensor answer = inferred();
  const Step single = step(model, points, queries, target);
  set_autocast(*model, Precision::Bf16);
  EXPECT_TRUE(torch::equal(inferred(), answer));
  EXPECT_FALSE(torch::equal(step(model, points, queries, target).gradient, single.gradient));
  set_autocast(*model, Precision::Fp32);
  EXPECT_TRUE(torch::equal(step(model, points, queries, target).gradient, single.gradient));
}

TEST(Autocast, StepsOnAdversarialScenesStayFinite) {
  const QuerySet queries = test::box_queries(60, 6);
  for (const float brightness : {1.0f, 1e6f}) {
    const at::Tensor target = some_target(60) * brightness;
    for (const test::SceneAdversary& adversary : test::scene_adversaries(200)) {
      LightTransportModel model = model_with_seed(35);
      model->train();
      set_autocast(*model, Precision::Bf16);
      torch::optim::AdamW optimizer(model->parameters(), torch::optim::AdamWOptions(2e-3));
      for (int i = 0; i < 5; ++i) {
        optimizer.zero_grad();
        const at::Tensor loss =
            relative_loss(model->decode_normalized(model->encode(adversary.points), queries),
                          target, LossConfig{0.01, false});
        loss.backward();
        ASSERT_TRUE(loss.isfinite().item<bool>()) << adversary.name << ", step " << i;
        for (const auto& item : model->named_parameters()) {
          if (!item.value().grad().defined()) continue;
          ASSERT_TRUE(item.value().grad().isfinite().all().item<bool>())
              << adversary.name << ", step " << i << ": " << item.key();
        }
        optimizer.step();
      }
    }
  }
}

TEST(Autocast, GradientsOfAdversarialEmbeddingsStayFiniteAndNearFloat32) {
  for (const test::DecoderAdversary& adversary : test::decoder_adversaries()) {
    test::DecoderCase c = test::make_decoder_case(adversary, 128);
    c.latent.requires_grad_();
    const auto run = [&](Precision precision) {
      set_autocast(*c.decoder, precision);
      const auto [keys, values] = c.decoder->keys_and_values(c.latent);
      const at::Tensor out = c.decoder->forward(
          c.attributes, c.decoder->neighbourhood({c.position, {}}, {c.anchor, {}}, c.spacing), keys,
          values);
      std::vector<at::Tensor> wanted = c.decoder->parameters(), flat = {out.detach().flatten()};
      wanted.push_back(c.latent);
      for (const at::Tensor& g : torch::autograd::grad({at::log1p(out).sum()}, wanted))
        flat.push_back(g.flatten());
      return std::pair{flat.front(), at::cat(at::TensorList(flat).slice(1))};
    };
    const auto [answer, gradient] = run(Precision::Fp32);
    const auto [half_answer, half_gradient] = run(Precision::Bf16);
    EXPECT_TRUE(half_answer.isfinite().all().item<bool>()) << adversary.name;
    EXPECT_TRUE(half_gradient.isfinite().all().item<bool>()) << adversary.name;
    EXPECT_LT(test::relative_difference(half_answer, answer), adversary.bf16_bound)
        << adversary.name;
    EXPECT_LT(test::relative_difference(half_gradient, gradient), 0.03) << adversary.name;
  }
}

}  // namespace
}  // namespace lte::nn
