// The radiance decoder and its rays in exported modules, against the native model.
#include <cstdlib>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <torch/csrc/jit/serialization/import.h>

#include "lte/nn/points/synthetic_room.h"
#include "lte/torchscript/export.h"
#include "tests/support/message_of.h"
#include "tests/support/temp_dir.h"
#include "tests/torchscript/support.h"

namespace lte::torchscript {
namespace {

constexpr int64_t kEach = 3;

nn::ModelConfig radiance_config() {
  nn::ModelConfig config = test::small_config(nn::Preset::Lte);
  config.light_input = nn::LightInput::Radiosity;
  config.radiance_lobes = 6;
  return config;
}

/// A room of which a part is metal, points to ask at, directions, and what a module takes of them.
struct Room {
  nn::PointSet points, surface;
  nn::QuerySet queries;
  at::Tensor directions;

  explicit Room(int64_t scene_points = 900, int64_t asked = 400)
      : points(nn::synthetic_room(scene_points, 1)), surface(nn::synthetic_room(asked, 2)) {
    // Left of a plane that cuts the room, so that there is metal beside metal.
    const at::Tensor metal = points.position.select(1, 0).lt(2).to(at::kFloat);
    points.gloss = at::stack({metal, points.albedo.select(1, 0)}, 1).contiguous();
    queries = {surface.position, surface.normal, surface.albedo};
    at::manual_seed(3);
    const at::Tensor way = at::randn({asked, kEach, 3}), normal = surface.normal.unsqueeze(1);
    const at::Tensor unit = way.div(way.norm(2, {2}, true));
    directions = unit - 2 * (unit * normal).sum(2, true).clamp_max(0) * normal;
  }
  at::Tensor rows(const nn::ModelConfig& config) const {
    std::vector<at::Tensor> columns = {points.position, points.normal, points.albedo,
                                       points.emission, points.area.unsqueeze(1)};
    for (const at::Tensor& light :
         {points.direct, points.indirect, points.direct_back, points.indirect_back})
      columns.push_back(light);
    if (config.reads_estimates()) columns.push_back(points.indirect_error);
    columns.push_back(points.gloss);
    return at::cat(columns, 1);
  }
  at::Tensor asked() const {
    return at::cat({queries.position, queries.normal, queries.albedo}, 1);
  }
  at::Tensor native(const std::filesystem::path& file) const {
    const at::NoGradGuard no_grad;
    nn::LightTransportModel model = nn::load_model(file);
    model->eval();
    return model->decode_radiance(model->encode(nn::in_canonical_order(points)), queries,
                                  directions);
  }
};

class ExportOfRadiance : public testing::Test {
 protected:
  torch::jit::Module exported(const std::string& model_file, bool portable) {
    export_torchscript({model_file, folder_ / "model.pt", portable, {}});
    torch::jit::Module module = torch::jit::load((folder_ / "model.pt").string());
    module.eval();
    return module;
  }
  static at::Tensor radiance(torch::jit::Module& module, const c10::IValue& embedding,
                             const at::Tensor& queries, const at::Tensor& directions) {
    const at::NoGradGuard no_grad;
    return module.get_method("radiance")({embedding, queries, directions}).toTensor();
  }
  static c10::IValue encode(torch::jit::Module& module, const at::Tensor& points) {
    const at::NoGradGuard no_grad;
    return module.get_method("encode")({points});
  }
  /// What a module of the model says of the room.
  at::Tensor answer(const std::filesystem::path& model_file, bool portable, const Room& room,
                    const nn::ModelConfig& config) {
    torch::jit::Module module = exported(model_file.string(), portable);
    return radiance(module, encode(module, room.rows(config)), room.asked(), room.directions);
  }
  test::TempDir folder_;
};

/// Nearly all answers are the same; a few rays pass the edge of a disc so narrowly that rounding
/// decides whether they meet it.
void expect_same_but_at_edges(const at::Tensor& got, const at::Tensor& expected,
                              const std::string& what) {
  ASSERT_EQ(got.sizes(), expected.sizes());
  ASSERT_TRUE(got.isfinite().all().item<bool>()) << what;
  const double mean = expected.mean().item<double>();
  ASSERT_GT(mean, 0);
  const at::Tensor off = (got - expected).abs().amax(2).div(mean);  // [Q, N]
  const at::Tensor apart = off.gt(1e-3);
  EXPECT_LE(apart.sum().item<int64_t>(), off.numel() / 500) << what;
  EXPECT_LT(off.masked_fill(apart, 0).mean().item<double>(), 2e-5) << what;
}

TEST_F(ExportOfRadiance, AgreesWithTheNativeModel) {
  const Room room;
  nn::ModelConfig solved = radiance_config(), traced = solved;
  traced.light_input = nn::LightInput::Traced;
  for (const nn::ModelConfig& config : {solved, traced}) {
    const auto file = test::save_untrained(folder_.path(), config);
    const at::Tensor expected = room.native(file);
    for (const bool portable : {false, true})
      expect_same_but_at_edges(answer(file, portable, room, config), expected, config.to_yaml());
  }
}

TEST_F(ExportOfRadiance, LteRadianceAgreesWithTheNativeModel) {
  const std::string file = "assets/models/lte-radiance.safetensors";
  const Room room(600, 200);
  torch::jit::Module module = exported(file, /*portable=*/true);
  const c10::IValue embedding = encode(module, room.rows(nn::load_model(file)->config()));
  const at::Tensor got = radiance(module, embedding, room.asked(), room.directions);
  expect_same_but_at_edges(got, room.native(file), "lte-radiance");
  // All light of the scene, dimmed and tinted.
  const auto dictionary = embedding.toGenericDict();
  const at::Tensor scale = dictionary.at("radiance").toTensor();
  dictionary.insert_or_assign("radiance", scale * at::tensor({2.0, 0.5, 0.0}));
  EXPECT_TRUE(at::allclose(radiance(module, embedding, room.asked(), room.directions),
                           got * at::tensor({2.0f, 0.5f, 0.0f}), 1e-5, 1e-6));
}

TEST_F(ExportOfRadiance, APortableModuleAnswersInAProgramThatLinksNothingOfLte) {
  const Room room(700, 150);
  const nn::ModelConfig config = radiance_config();
  const auto file = test::save_untrained(folder_.path(), config);
  export_torchscript({file.string(), folder_ / "model.pt", true, {}});
  test::write_rows(folder_ / "points", room.rows(config));
  test::write_rows(folder_ / "queries", room.asked());
  test::write_rows(folder_ / "directions", room.directions);
  std::string command = "OMP_NUM_THREADS=1 " LTE_BINARY_DIR "/bin/portable_loader";
  for (const char* name :
       {"model.pt", "27", "points", "queries", "irradiance", "directions", "radiance"}) {
    command += " '" + (*name == '2' ? std::string(name) : (folder_ / name).string()) + "'";
  }
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  const at::Tensor expected = room.native(file);
  expect_same_but_at_edges(test::read_rows(folder_ / "radiance", expected), expected, "alone");
}

TEST_F(ExportOfRadiance, BlocksOfQueriesAndDirectionsAnswerAsOne) {
  const Room room(300, 5000);  // more than one block of queries
  const nn::ModelConfig config = radiance_config();
  torch::jit::Module module =
      exported(test::save_untrained(folder_.path(), config).string(), false);
  const c10::IValue embedding = encode(module, room.rows(config));
  const at::Tensor all = radiance(module, embedding, room.asked(), room.directions);
  const at::Tensor last =
      radiance(module, embedding, room.asked().slice(0, 4990), room.directions.slice(0, 4990));
  EXPECT_TRUE(at::allclose(all.slice(0, 4990), last, 1e-5, 1e-7));
  EXPECT_EQ(radiance(module, embedding, room.asked().slice(0, 0, 0), room.directions.slice(0, 0, 0))
                .sizes(),
            (std::vector<int64_t>{0, kEach, 3}));
}

TEST_F(ExportOfRadiance, RefusesWhatItCannotAnswer) {
  const Room room(300, 10);
  const nn::ModelConfig config = radiance_config();
  torch::jit::Module module =
      exported(test::save_untrained(folder_.path(), config).string(), false);
  const at::Tensor rows = room.rows(config);
  const c10::IValue embedding = encode(module, rows);
  const auto error = [&](const at::Tensor& directions) {
    return test::message_of([&] { radiance(module, embedding, room.asked(), directions); });
  };
  EXPECT_THAT(error(room.directions * 1.1), testing::HasSubstr("not a unit vector"));
  EXPECT_THAT(error(room.directions.masked_fill(at::arange(3).eq(1), NAN)),
              testing::HasSubstr("not a unit vector"));
  EXPECT_THAT(error(-room.surface.normal.unsqueeze(1)), testing::HasSubstr("into the surface"));
  EXPECT_THAT(error(room.directions.slice(0, 0, 5)), testing::HasSubstr("must be [Q, N, 3]"));
  EXPECT_THAT(error(room.surface.normal), testing::HasSubstr("must be [Q, N, 3]"));
  const auto refused = [&](const at::Tensor& points) {
    return test::message_of([&] { encode(module, points); });
  };
  EXPECT_THAT(refused(rows.slice(1, 0, 25)), testing::HasSubstr("metallic, roughness"));
  at::Tensor bad = rows.clone();
  bad[7][26] = 1.5;
  EXPECT_THAT(refused(bad), testing::HasSubstr("metallic or roughness is outside [0, 1]"));
  torch::jit::Module without = exported(
      test::save_untrained(folder_.path(), test::small_config(nn::Preset::Lte)).string(), false);
  EXPECT_FALSE(without.find_method("radiance").has_value());
}

}  // namespace
}  // namespace lte::torchscript
