#include "train/optim/optimizer.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include <torch/types.h>
#include <torch/utils.h>

#include "lte/nn/cost.h"
#include "lte/nn/files/tensor_io.h"
#include "tests/train/support.h"
#include "train/optim/schedule.h"

namespace lte::train {
namespace {

OptimConfig config() {
  OptimConfig train;
  train.steps = 10;
  train.warmup_steps = 0;
  train.learning_rate = 0.01;
  train.min_learning_rate = 0.001;
  train.weight_decay = 0.5;
  train.clip_norm = 0;
  return train;
}

nn::LightTransportModel tiny_model() {
  torch::manual_seed(3);
  return nn::LightTransportModel(test::tiny_config("data", "run").model);
}

/// The same gradient for every entry of every parameter.
void set_gradients(const nn::LightTransportModel& model, double value) {
  for (at::Tensor& parameter : model->parameters()) {
    parameter.mutable_grad() = torch::full_like(parameter, value).detach();
  }
}

std::vector<at::Tensor> copies(const nn::LightTransportModel& model) {
  std::vector<at::Tensor> out;
  for (const at::Tensor& parameter : model->parameters()) out.push_back(parameter.detach().clone());
  return out;
}

int64_t entries(const nn::LightTransportModel& model) { return nn::count_parameters(model).total; }

TEST(Optimizer, ParametersThatWereGivenMoveAtAShareOfTheRate) {
  OptimConfig train = config();
  train.weight_decay = 0;
  train.init_weights = "some.safetensors";
  train.init_except = {"decoder.head."};
  for (const double share : {0.0, 0.25, 1.0}) {
    train.init_rate = share;
    const nn::LightTransportModel model = tiny_model();
    Optimizer optimizer(train, model);
    const std::vector<at::Tensor> before = copies(model);
    set_gradients(model, 0.3);
    optimizer.update(0, 1);
    size_t i = 0;
    for (const auto& item : model->named_parameters()) {
      const bool fresh = item.key().starts_with("decoder.head.");
      const double expected = train.learning_rate * (fresh ? 1 : share);  // Adam's first step
      const double moved = (before[i++] - item.value()).mean().item<double>();
      EXPECT_NEAR(moved, expected, 1e-4 * train.learning_rate) << item.key() << " at " << share;
    }
  }
}

TEST(Optimizer, UpdatesAreAdamWsAndOnlyMatricesDecay) {
  const nn::LightTransportModel model = tiny_model();
  Optimizer optimizer(config(), model);
  const std::vector<at::Tensor> before = copies(model);
  // Kingma and Ba by hand, for the constant gradients g = 0.3 and then −0.1.
  const OptimConfig train = config();
  double m = 0, v = 0, moved = 0, shrink = 1, shrunk_moves = 0;
  for (int64_t step = 0; step < 2; ++step) {
    const double g = step == 0 ? 0.3 : -0.1, rate = learning_rate(train, step);
    set_gradients(model, g);
    optimizer.update(step, 1);
    m = 0.9 * m + 0.1 * g;
    v = 0.999 * v + 0.001 * g * g;
    const double t = static_cast<double>(step + 1);
    const double move =
        rate * (m / (1 - std::pow(0.9, t))) / (std::sqrt(v / (1 - std::pow(0.999, t))) + 1e-8);
    moved += move;
    const double decay = 1 - rate * train.weight_decay;
    shrunk_moves = shrunk_moves * decay + move;
    shrink *= decay;
  }
  const std::vector<at::Tensor> after = copies(model);
  for (size_t i = 0; i < before.size(); ++i) {
    const bool matrix = before[i].dim() >= 2;
    const at::Tensor expected = matrix ? before[i] * shrink - shrunk_moves : before[i] - moved;
    EXPECT_LT((after[i] - expected).abs().max().item<double>(), 2e-6) << i;
  }
}

TEST(Optimizer, MuonMovesMatricesAlongTheirSingularVectorsAndTheRestAsAdamW) {
  OptimConfig train = config();
  train.optimizer = OptimizerKind::Muon;
  const nn::LightTransportModel model = tiny_model(), witness = tiny_model();
  Optimizer optimizer(train, model), adamw(config(), witness);
  const std::vector<at::Tensor> before = copies(model);
  torch::manual_seed(8);
  std::vector<at::Tensor> gradients;
  for (size_t i = 0; i < before.size(); ++i) {
    gradients.push_back(torch::randn_like(before[i]));
    model->parameters()[i].mutable_grad() = gradients[i].clone();
    witness->parameters()[i].mutable_grad() = gradients[i].clone();
  }
  optimizer.update(0, 1);
  adamw.update(0, 1);
  const double rate = learning_rate(train, 0);
  int64_t by_muon = 0;
  size_t i = 0;
  for (const auto& item : model->named_parameters()) {
    const at::Tensor moved = before[i] * (1 - rate * train.weight_decay) - item.value();
    const at::Tensor& gradient = gradients[i];
    const bool as_adamw = torch::equal(item.value(), witness->parameters()[i]);
    if (!as_adamw) {
      ++by_muon;
      EXPECT_GE(item.value().dim(), 2) << item.key();
      // A random gradient has no small singular values: a fifth of the rate in every entry.
      EXPECT_NEAR(moved.square().mean().sqrt().item<double>(), 0.2 * rate, 0.06 * rate)
          << item.key();
      EXPECT_GT((moved * gradient).sum().item<double>(), 0) << item.key();
    }
    ++i;
  }
  EXPECT_GT(by_muon, 10);
  for (const char* name : {"decoder.head.output.weight", "decoder.gamma.hidden.weight"}) {
    const auto parameters = model->named_parameters(), others = witness->named_parameters();
    EXPECT_TRUE(torch::equal(parameters[name], others[name])) << name << ": in or out of a scene";
  }
}

TEST(Optimizer, GradientNormIsThatOfAllEntries) {
  const nn::LightTransportModel model = tiny_model();
  Optimizer optimizer(config(), model);
  EXPECT_EQ(optimizer.gradient_norm(), 0) << "no gradients yet";
  set_gradients(model, 0.5);
  EXPECT_NEAR(optimizer.gradient_norm(), 0.5 * std::sqrt(static_cast<double>(entries(model))),
              1e-3);
  model->parameters()[5].mutable_grad().view({-1})[0] = NAN;
  EXPECT_TRUE(std::isnan(optimizer.gradient_norm()));
  optimizer.zero_gradients();
  EXPECT_EQ(optimizer.gradient_norm(), 0);
}

TEST(Optimizer, ModuleNormsAreThoseOfTheirParametersAndMakeUpTheWhole) {
  const nn::LightTransportModel model = tiny_model();
  const Optimizer optimizer(config(), model);
  for (const auto& [module, norm] : optimizer.module_norms())
    EXPECT_EQ(norm, 0) << module << ": no gradients yet";
  torch::manual_seed(4);
  for (auto& item : model->named_parameters()) {
    if (item.key() == "decoder.head.output.bias") continue;  // as of a part that was not used
    item.value().mutable_grad() = torch::randn_like(item.value()).detach();
  }
  // By the modules' own objects, not by names of parameters.
  std::map<std::string, double> expected;
  const auto add = [&](const std::string& part, const torch::nn::Module& module) {
    for (const at::Tensor& parameter : module.parameters()) {
      if (parameter.grad().defined())
        expected[part] += parameter.grad().to(at::kDouble).square().sum().item<double>();
    }
  };
  const auto children = model->named_children();
  add("nne", *children["nne"]);
  add("decoder", *children["decoder"]);
  const std::map<std::string, std::string> stages = {
      {"stem", "stem"},   {"stem_norm", "stem"}, {"down0", "down0"}, {"pool1", "down1"},
      {"down1", "down1"}, {"unpool0", "up0"},    {"up0", "up0"},     {"norm", "norm"}};
  for (const auto& child : children["encoder"]->named_children())
    add("encoder_" + stages.at(child.key()), *child.value());
  double sum = 0;
  std::vector<std::string> names;
  for (const auto& [module, norm] : optimizer.module_norms()) {
    ASSERT_TRUE(expected.contains(module)) << module;
    EXPECT_NEAR(norm, std::sqrt(expected[module]), 1e-5 * norm) << module;
    sum += norm * norm;
    names.push_back(module);
  }
  EXPECT_EQ(names.size(), expected.size());
  EXPECT_EQ(names.front(), "nne");
  EXPECT_EQ(names.back(), "decoder");
  EXPECT_NEAR(sum, std::pow(optimizer.gradient_norm(), 2), 1e-9 * sum);
}

TEST(Optimizer, ClippingScalesTheGradientToTheNorm) {
  const nn::LightTransportModel model = tiny_model();
  OptimConfig train = config();
  train.clip_norm = 2;
  Optimizer optimizer(train, model);
  set_gradients(model, 0.5);
  optimizer.update(0, optimizer.gradient_norm());
  EXPECT_NEAR(optimizer.gradient_norm(), 2, 1e-4);
  set_gradients(model, 1e-6);
  const double small = optimizer.gradient_norm();
  optimizer.update(1, small);
  EXPECT_EQ(optimizer.gradient_norm(), small) << "below the limit nothing is touched";
}

TEST(Optimizer, AverageFollowsItsRecurrenceAndSwapsBack) {
  const nn::LightTransportModel model = tiny_model();
  OptimConfig train = config();
  train.ema_decay = 0.9;
  Optimizer optimizer(train, model);
  at::Tensor expected = model->parameters()[0].detach().clone();
  for (int64_t step = 0; step < 3; ++step) {
    set_gradients(model, 1);
    optimizer.update(step, 1);
    // So early it is below the 0.9 of the configuration.
    const double decay = static_cast<double>(1 + step) / static_cast<double>(10 + step);
    expected = decay * expected + (1 - decay) * model->parameters()[0].detach();
  }
  const at::Tensor weights = model->parameters()[0].detach().clone();
  {
    const AverageScope scope(&optimizer);
    EXPECT_LT((model->parameters()[0] - expected).abs().max().item<double>(), 1e-6);
  }
  EXPECT_TRUE(at::equal(model->parameters()[0], weights));
}

void save_state(const Optimizer& optimizer, const std::filesystem::path& file) {
  SafetensorsWriter writer;
  std::map<std::string, at::Tensor> storage;
  nn::add_tensors(optimizer.state(), &storage, &writer);
  writer.write(file);
}

void expect_state_survives_a_file(OptimizerKind kind) {
  const test::TempDir dir;
  OptimConfig train = config();
  train.optimizer = kind;
  train.ema_decay = 0.9;
  const nn::LightTransportModel a = tiny_model(), b = tiny_model();
  Optimizer first(train, a), second(train, b);
  set_gradients(a, 0.3);
  first.update(0, 1);
  save_state(first, dir / "state.safetensors");
  {
    const torch::NoGradGuard no_grad;
    for (size_t i = 0; i < a->parameters().size(); ++i)
      b->parameters()[i].copy_(a->parameters()[i]);
  }
  second.load_state(SafetensorsFile(dir / "state.safetensors"));
  for (const nn::LightTransportModel& model : {a, b}) set_gradients(model, -0.1);
  first.update(1, 1);
  second.update(1, 1);
  for (size_t i = 0; i < a->parameters().size(); ++i) {
    EXPECT_TRUE(at::equal(a->parameters()[i], b->parameters()[i])) << i;
  }
  const auto state_a = first.state(), state_b = second.state();
  ASSERT_EQ(state_a.size(), state_b.size());
  for (const auto& [name, tensor] : state_a)
    EXPECT_TRUE(at::equal(tensor, state_b.at(name))) << name;
}

TEST(Optimizer, AStateOfMuonIsRefusedByAdamW) {
  const test::TempDir dir;
  OptimConfig train = config();
  const nn::LightTransportModel model = tiny_model();
  Optimizer adamw(train, model);
  train.optimizer = OptimizerKind::Muon;
  Optimizer muon(train, model);
  set_gradients(model, 0.3);
  muon.update(0, 1);
  save_state(muon, dir / "state.safetensors");
  try {
    adamw.load_state(SafetensorsFile(dir / "state.safetensors"));
    FAIL() << "went on without second moments";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("state.safetensors"), std::string::npos) << message;
    EXPECT_NE(message.find("train.optimizer"), std::string::npos) << message;
  }
}

TEST(Optimizer, StateSurvivesAFile) {
  for (const OptimizerKind kind : {OptimizerKind::AdamW, OptimizerKind::Muon})
    expect_state_survives_a_file(kind);
}

}  // namespace
}  // namespace lte::train
