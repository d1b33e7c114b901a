// An embedding that has learnt one scene by heart: against closed forms and the model it began
// with, and as a file.
#include "train/fit/fit.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/embed/embedding_key.h"
#include "lte/scene/export.h"
#include "tests/support/closed_forms.h"
#include "tests/support/message_of.h"
#include "tests/support/room.h"
#include "tests/support/temp_dir.h"
#include "tests/train/tool_process.h"
#include "train/fit/fit_queries.h"

namespace lte::train {
namespace {

constexpr const char* kModel = "assets/models/lte.safetensors";
constexpr const char* kOther = "assets/models/lte-paper.safetensors";

embed::EmbedSettings few_points() {
  embed::EmbedSettings settings;
  settings.scene_points = 600;
  settings.rescale = true;
  return settings;
}

/// What tests have time for, the same on every machine.
FitSettings short_fit() {
  FitSettings settings;
  settings.points = 6000;
  settings.steps = 120;
  return settings;
}

TEST(Fit, AnswersARoomBetterThanTheModelItBeganWith) {
  const test::Room room;
  const runtime::Network network(kModel);
  const runtime::SceneEmbedding start =
      embed::embed(room.bvh, room.lights, network, few_points()).embedding;
  const Fit fit = fit_embedding(room.bvh, room.lights, start, short_fit());
  EXPECT_EQ(fit.steps, 120);
  EXPECT_LE(fit.points, 6000);
  EXPECT_LT(fit.after.relative_mse, 0.5 * fit.before.relative_mse)
      << fit.before.relative_mse << " before";
  // At points that no part of the fit has drawn.
  FitQueries asked = draw_queries(room.bvh, 600, 99);
  trace_queries(room.bvh, room.lights, 1024, 99, &asked, [](int64_t) { return false; });
  const auto error = [&](const runtime::SceneEmbedding& embedding) {
    const std::vector<Rgb> light = embedding.decode({asked.position, asked.normal, asked.albedo});
    double sum = 0;
    for (size_t i = 0; i < light.size(); ++i) {
      const Vec3 off = light[i] - asked.indirect[i];
      sum += dot(off, off);
    }
    return sum;
  };
  EXPECT_LT(error(fit.embedding), 0.6 * error(start));
}

// Indirect light in a sphere of albedo a that a small lamp in its middle lights is the same
// everywhere: direct · (a + a² + ...).
TEST(Fit, ComesToTheClosedFormOfTheIntegratingSphere) {
  scene::Scene scene;
  constexpr float kAlbedo = 0.6f, kRadius = 2, kLamp = 0.1f, kRadiance = 40;
  const int wall = test::add_material(&scene, {kAlbedo, kAlbedo, kAlbedo});
  const int lamp = test::add_material(&scene, {0, 0, 0}, {kRadiance, kRadiance, kRadiance});
  test::add_instance(&scene, test::inward_sphere_mesh(kRadius, 4, wall));
  test::add_instance(&scene, test::box_mesh({-kLamp, -kLamp, -kLamp}, {kLamp, kLamp, kLamp}, lamp,
                                            /*inwards=*/false));
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  const runtime::Network network(kModel);
  const runtime::SceneEmbedding start = embed::embed(bvh, lights, network, few_points()).embedding;
  const Fit fit = fit_embedding(bvh, lights, start, short_fit());
  const double power = M_PI * kRadiance * 24 * kLamp * kLamp,
               direct = power / (4 * M_PI * kRadius * kRadius),
               expected = direct * kAlbedo * test::geometric_sum(kAlbedo, 4);
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;
  for (int i = 0; i < 300; ++i) {
    const double z = 1 - (2 * i + 1.0) / 300, r = std::sqrt(1 - z * z), angle = 2.399963 * i;
    const Vec3 n{static_cast<float>(r * std::cos(angle)), static_cast<float>(z),
                 static_cast<float>(r * std::sin(angle))};
    position.push_back(n * (0.998f * kRadius));
    normal.push_back(-n);
    albedo.push_back({kAlbedo, kAlbedo, kAlbedo});
  }
  const auto error = [&](const runtime::SceneEmbedding& embedding) {
    double sum = 0;
    for (const Rgb& light : embedding.decode({position, normal, albedo}))
      sum += std::abs(light.y - expected) / expected / 300;
    return sum;
  };
  EXPECT_LT(error(fit.embedding), 0.03);
  EXPECT_LT(error(fit.embedding), error(start));
}

TEST(Fit, IsTheSameEveryTime) {
  const test::Room room;
  const runtime::Network network(kModel);
  const runtime::SceneEmbedding start =
      embed::embed(room.bvh, room.lights, network, few_points()).embedding;
  FitSettings settings = short_fit();
  settings.points = 2048;
  settings.steps = 12;
  const auto answers = [&] {
    return fit_embedding(room.bvh, room.lights, start, settings)
        .embedding.decode({room.positions, room.normals, room.positions});
  };
  EXPECT_EQ(answers(), answers());
}

TEST(Fit, RefusesWhatItCannotLearn) {
  const test::Room room;
  const runtime::Network radiance("assets/models/lte-radiance.safetensors");
  const runtime::SceneEmbedding start =
      embed::embed(room.bvh, room.lights, radiance, few_points()).embedding;
  EXPECT_THAT(test::message_of([&] { fit_embedding(room.bvh, room.lights, start, short_fit()); }),
              testing::HasSubstr("predicts radiance"));
}

/// `lte_train fit` on files.
class FitTool : public testing::Test {
 protected:
  int run(std::vector<std::string> args) {
    args.insert(args.begin(), "fit");
    args.insert(args.end(), {"--quiet", "--checkpoint", kModel});
    test::ToolProcess tool(args, dir_ / "tool", {{"OMP_NUM_THREADS", "1"}});
    const int status = tool.wait();
    error_ = tool.err();
    out_ = tool.out();
    return status;
  }
  void expect_refused(const std::vector<std::string>& args, const std::string& words) {
    EXPECT_EQ(run(args), 1) << words;
    EXPECT_THAT(error_, testing::HasSubstr(words));
    EXPECT_EQ(std::count(error_.begin(), error_.end(), '\n'), 1) << error_;
    EXPECT_FALSE(std::filesystem::exists(dir_ / "out.safetensors"));
  }
  std::string scene_file(const scene::Scene& scene, const char* name) {
    std::string path = (dir_ / name).string();
    scene::write_glb(path, scene);
    return path;
  }
  std::string out() const { return (dir_ / "out.safetensors").string(); }

  test::TempDir dir_;
  std::string error_, out_;
};

TEST_F(FitTool, WritesAnEmbeddingThatFitsItsSceneAndGoesOn) {
  const std::string scene = scene_file(test::furnished_room(), "room.glb");
  ASSERT_EQ(run({scene, "--out", out(), "--steps", "4", "--points", "2048", "--json",
                 (dir_ / "fit.json").string()}),
            0)
      << error_;
  EXPECT_THAT(out_, testing::HasSubstr("--embedding"));
  std::string again = (dir_ / "again.safetensors").string();
  ASSERT_EQ(run({scene, "--out", again, "--steps", "4", "--points", "2048", "--embedding", out()}),
            0)
      << error_;
  EXPECT_EQ(run({scene, "--out", (dir_ / "x").string(), "--embedding", again, "--seed", "3"}), 1);
  EXPECT_THAT(error_, testing::HasSubstr("made with another seed"));
  EXPECT_FALSE(std::filesystem::exists(dir_ / "x"));
}

TEST_F(FitTool, RefusesBadInputInOneLine) {
  expect_refused({(dir_ / "none.glb").string(), "--out", out()}, "none.glb");
  scene::Scene dark = test::furnished_room();
  for (scene::Material& material : dark.materials) material.emission = {};
  for (scene::Instance& instance : dark.instances) instance.light_group = scene::kNone;
  dark.light_groups.clear();
  dark.lights.clear();
  expect_refused({scene_file(dark, "dark.glb"), "--out", out()}, "nothing emits light");
  const std::string room = scene_file(test::furnished_room(), "room.glb");
  expect_refused({room, "--out", (dir_ / "no" / "out").string()}, "no");
  expect_refused({room, "--out", out(), "--embedding", room}, "room.glb");
}

TEST_F(FitTool, RefusesAnEmbeddingOfAnotherModel) {
  const std::string path = scene_file(test::furnished_room(), "room.glb");
  const test::Room room;
  const runtime::Network other(kOther);
  const embed::EmbedSettings settings = few_points();
  save_embedding(dir_ / "other.safetensors",
                 embed::embed(room.bvh, room.lights, other, settings).embedding,
                 embed::embedding_key(room.bvh, other, settings));
  expect_refused({path, "--out", out(), "--embedding", (dir_ / "other.safetensors").string()},
                 "made with another model");
}

}  // namespace
}  // namespace lte::train
