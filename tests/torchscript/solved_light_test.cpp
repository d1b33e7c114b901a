// Modules of models whose light is solved: from surfaces alone they give what the tools give.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <torch/csrc/jit/serialization/import.h>

#include "lte/embed/embed.h"
#include "lte/embed/scene_points.h"
#include "lte/nn/points/synthetic_room.h"
#include "lte/ops/solve_light.h"
#include "lte/scene/load.h"
#include "lte/torchscript/export.h"
#include "tests/support/message_of.h"
#include "tests/support/temp_dir.h"

namespace lte::torchscript {
namespace {

constexpr int64_t kScenePoints = 1500;

at::Tensor tensor(std::span<const Vec3> triples) {
  return at::from_blob(const_cast<Vec3*>(triples.data()), {static_cast<int64_t>(triples.size()), 3},
                       at::kFloat)
      .clone();
}

/// [M, 13] of scene points: nothing of their light.
at::Tensor surface_rows(const scene::SurfaceSamples& s) {
  const auto M = static_cast<int64_t>(s.area.size());
  const at::Tensor area = at::from_blob(const_cast<float*>(s.area.data()), {M, 1}, at::kFloat);
  return at::cat({tensor(s.position), tensor(s.normal), tensor(s.albedo), tensor(s.emission), area},
                 1);
}

class SolvedExport : public testing::TestWithParam<bool> {
 protected:
  torch::jit::Module exported(const std::filesystem::path& model) {
    export_torchscript({model, folder_ / "model.pt", GetParam(), {}});
    torch::jit::Module module = torch::jit::load((folder_ / "model.pt").string());
    module.eval();
    return module;
  }
  static at::Tensor answer(torch::jit::Module& module, const at::Tensor& points,
                           const at::Tensor& queries) {
    const at::NoGradGuard no_grad;
    return module.forward({points, queries}).toTensor();
  }
  test::TempDir folder_;
};

TEST_P(SolvedExport, AnswersInASceneAsTheToolsDo) {
  const char* const model = "assets/models/lte.safetensors";
  const scene::Scene scene = scene::load_scene("assets/scenes/cornell_box.glb");
  const pathtrace::Bvh bvh(scene);
  const runtime::Network network(model, {.precision = runtime::Precision::Fp32});
  embed::EmbedSettings settings;
  settings.scene_points = kScenePoints;
  const embed::Embedded embedded = embed::embed(bvh, pathtrace::Lights(scene), network, settings);
  const scene::SurfaceSamples points = embed::sample_scene_points(
      bvh, kScenePoints, settings.prunes(network), settings.seed, nullptr);
  scene::SurfaceSamples asked = scene::sample_surface(scene, 400, {.seed = 9});
  const std::vector<Rgb> light =
      embedded.embedding.decode({asked.position, asked.normal, asked.albedo});
  torch::jit::Module module = exported(model);
  const at::Tensor expected = tensor(light);
  const at::Tensor rows = surface_rows(points);
  const at::Tensor queries =
      at::cat({tensor(asked.position), tensor(asked.normal), tensor(asked.albedo)}, 1);
  const at::Tensor got = answer(module, rows, queries);
  const double mean = expected.mean().item<double>();
  ASSERT_GT(mean, 0);
  EXPECT_LT((got - expected).abs().mean().item<double>(), 1e-4 * mean);
  EXPECT_LT((got - expected).abs().max().item<double>(), 1e-2 * mean);
  // However the points are ordered, and with their light as well.
  const at::Tensor order = at::arange(rows.size(0)).flip(0);
  EXPECT_TRUE(at::equal(answer(module, rows.index_select(0, order), queries), got));
  const at::Tensor sorted = module.get_method("in_order")({rows}).toTensor(),
                   light_there = module.get_method("solve_light")({sorted}).toTensor();
  EXPECT_TRUE(at::equal(answer(module, at::cat({sorted, light_there}, 1), queries), got));
}

TEST_P(SolvedExport, SolvesWhatTheOperatorSolves) {
  torch::jit::Module module = exported("assets/models/lte.safetensors");
  for (const int64_t count : {1, 2, 40, 2500}) {
    const nn::PointSet p = nn::synthetic_room(count, 7);
    const at::Tensor expected =
        ops::solve_light(p.position, p.normal, p.albedo, p.emission, p.area);
    const at::Tensor rows =
        at::cat({p.position, p.normal, p.albedo, p.emission, p.area.unsqueeze(1)}, 1);
    const at::Tensor got = module.get_method("solve_light")({rows}).toTensor();
    ASSERT_EQ(got.sizes(), expected.sizes());
    const double mean = expected.abs().mean().item<double>();
    EXPECT_LE((got - expected).abs().mean().item<double>(), 1e-3 * mean) << count << " points";
  }
}

TEST_P(SolvedExport, LightOfNoKindIsDarkness) {
  torch::jit::Module module = exported("assets/models/lte.safetensors");
  nn::PointSet p = nn::synthetic_room(600, 8);
  p.emission.zero_();
  const at::Tensor rows =
      at::cat({p.position, p.normal, p.albedo, p.emission, p.area.unsqueeze(1)}, 1);
  EXPECT_EQ(module.get_method("solve_light")({rows}).toTensor().abs().max().item<float>(), 0);
  EXPECT_EQ(answer(module, rows, rows.slice(1, 0, 9)).abs().max().item<float>(), 0);
}

TEST_P(SolvedExport, SaysWhichColumnsItTakes) {
  torch::jit::Module module = exported("assets/models/lte.safetensors");
  const std::string error = test::message_of([&] {
    answer(module, at::rand({50, 14}), at::rand({5, 9}));
  });
  EXPECT_THAT(error, testing::HasSubstr("[M, 25]"));
  EXPECT_THAT(error, testing::HasSubstr("[M, 13] without the light"));
}

INSTANTIATE_TEST_SUITE_P(Kinds, SolvedExport, testing::Bool(),
                         [](const auto& kind) { return kind.param ? "Portable" : "Native"; });

}  // namespace
}  // namespace lte::torchscript
