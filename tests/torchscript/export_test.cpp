// The exported modules against the native model; the portable one in a program that links nothing
// of lte.
#include "lte/torchscript/export.h"

#include <csignal>
#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <torch/csrc/jit/serialization/import.h>

#include "lte/base/check.h"
#include "lte/nn/files/model_file.h"
#include "lte/nn/points/synthetic_room.h"
#include "lte/torchscript/network.h"
#include "tests/support/temp_dir.h"
#include "tests/torchscript/support.h"

namespace lte::torchscript {
namespace {

using test::save_untrained;
using test::small_config;
using test::write_rows;

const std::vector<ExportSize> kSmall = {{1'024, 500}};

/// A module of lte's operators and a portable one answer as the native model.
void expect_both_kinds_agree(const nn::ModelConfig& config) {
  const test::TempDir folder;
  const std::filesystem::path model_file = save_untrained(folder.path(), config);
  for (const bool portable : {false, true}) {
    for (const ExportCheck& check :
         export_torchscript({model_file.string(), folder.path() / "model.pt", portable, kSmall})) {
      EXPECT_LT(check.relative_error, 1e-5)
          << (portable ? "portable" : "native") << ", M = " << check.scene_points;
    }
  }
}

class Export : public testing::TestWithParam<nn::Preset> {};

TEST_P(Export, AgreesWithTheNativeModelAtThreeSizes) {
  const test::TempDir folder;
  const std::filesystem::path model_file = save_untrained(folder.path(), small_config(GetParam()));
  for (const bool portable : {false, true}) {
    const auto checks = export_torchscript({model_file.string(),
                                            folder.path() / "model.pt",
                                            portable,
                                            {{257, 100}, kSmall.front(), {4'000, 1'000}}});
    ASSERT_EQ(checks.size(), 3u);
    for (const ExportCheck& check : checks) {
      EXPECT_LT(check.relative_error, 1e-5)
          << (portable ? "portable" : "native") << ", M = " << check.scene_points;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Presets, Export, testing::Values(nn::Preset::Paper, nn::Preset::Lte));

TEST(ExportOfLight, ColumnsFollowTheModel) {
  for (const auto input : {nn::LightInput::Traced, nn::LightInput::Radiosity}) {
    nn::ModelConfig config = small_config(nn::Preset::Lte);
    config.light_input = input;
    expect_both_kinds_agree(config);
    const test::TempDir folder;
    const std::filesystem::path model_file = save_untrained(folder.path(), config);
    export_torchscript({model_file.string(), folder.path() / "model.pt", true, {}});
    torch::jit::Module module = torch::jit::load((folder.path() / "model.pt").string());
    const auto forward = [&](int64_t columns) {
      module.forward({at::rand({50, columns}), at::rand({5, 9})});
    };
    forward(input == nn::LightInput::Traced ? 27 : 25);
    EXPECT_ANY_THROW(forward(14));
    if (input == nn::LightInput::Traced) {
      EXPECT_ANY_THROW(forward(13));
    }
  }
}

TEST(PortableExport, LoadsInAProgramThatLinksNothingOfLte) {
  const test::TempDir folder;
  const std::filesystem::path model_file =
      save_untrained(folder.path(), small_config(nn::Preset::Paper));
  export_torchscript({model_file.string(), folder.path() / "model.pt", true, {}});
  const at::NoGradGuard no_grad;
  const nn::PointSet points = nn::synthetic_room(700, 1), surface = nn::synthetic_room(300, 2);
  write_rows(folder.path() / "points", at::cat({points.position, points.normal, points.albedo,
                                                points.emission, points.area.unsqueeze(1)},
                                               1));
  write_rows(folder.path() / "queries",
             at::cat({surface.position, surface.normal, surface.albedo}, 1));
  const auto quoted = [&](const char* name) {
    return " '" + (folder.path() / name).string() + "'";
  };
  const std::string command =
      std::string("OMP_NUM_THREADS=1 " LTE_BINARY_DIR "/bin/portable_loader") + quoted("model.pt") +
      " 13" + quoted("points") + quoted("queries") + quoted("result");
  ASSERT_EQ(std::system(command.c_str()), 0);

  nn::LightTransportModel model = nn::load_model(model_file);
  const at::Tensor expected = model->decode(model->encode(nn::in_canonical_order(points)),
                                            {surface.position, surface.normal, surface.albedo});
  const at::Tensor got = test::read_rows(folder.path() / "result", expected);
  EXPECT_LT((got - expected).abs().max().item<double>(),
            1e-5 * expected.abs().max().item<double>());
}

/// On a grid nearly all distances have equals; which of them are picked and read must not differ.
TEST(PortableExport, TakesTheSameOfEqualDistances) {
  const test::TempDir folder;
  const std::filesystem::path model_file =
      save_untrained(folder.path(), small_config(nn::Preset::Paper));
  const at::NoGradGuard no_grad;
  nn::PointSet points = nn::synthetic_room(1'024, 3);
  points.emission.slice(0, 0, 32).fill_(5);
  const at::Tensor number = at::arange(1'024);
  points.position =
      at::stack(
          {number.remainder(16), number.div(16, "floor").remainder(8), number.div(128, "floor")}, 1)
          .to(at::kFloat)
          .div(8);
  const at::Tensor rows = at::cat(
      {points.position, points.normal, points.albedo, points.emission, points.area.unsqueeze(1)},
      1);
  const at::Tensor queries = rows.slice(1, 0, 9).slice(0, 0, 500);
  nn::LightTransportModel model = nn::load_model(model_file);
  const at::Tensor expected =
      model->decode(model->encode(nn::in_canonical_order(points)),
                    {queries.slice(1, 0, 3), queries.slice(1, 3, 6), queries.slice(1, 6, 9)});
  export_torchscript({model_file.string(), folder.path() / "model.pt", true, {}});
  torch::jit::Module module = torch::jit::load((folder.path() / "model.pt").string());
  const at::Tensor got = module.forward({rows, queries}).toTensor();
  ASSERT_GT(expected.abs().max().item<double>(), 0);
  EXPECT_LT((got - expected).abs().max().item<double>(),
            1e-5 * expected.abs().max().item<double>());
}

TEST(PortableExport, CarriesConfigurationAndNormalization) {
  const test::TempDir folder;
  const nn::ModelConfig config = small_config(nn::Preset::Lte);
  export_torchscript(
      {save_untrained(folder.path(), config).string(), folder.path() / "model.pt", true, {}});
  torch::jit::ExtraFilesMap extra{
      {"config.yaml", ""}, {"normalization.json", ""}, {"version.txt", ""}};
  torch::jit::load((folder.path() / "model.pt").string(), std::nullopt, extra);
  EXPECT_EQ(extra["config.yaml"], config.to_yaml());
  const nlohmann::json said = nlohmann::json::parse(extra["normalization.json"]);
  EXPECT_EQ(said.at("scale_m"), 16);
  EXPECT_EQ(said.at("points"),
            nlohmann::json({"position", "normal", "albedo", "emission", "area"}));
  EXPECT_EQ(said.at("queries"), nlohmann::json({"position", "normal", "albedo"}));
}

TEST(ExportErrors, LeaveNothingBehind) {
  const test::TempDir folder;
  const std::filesystem::path garbage = folder.path() / "garbage.safetensors";
  std::ofstream(garbage) << "not a model";
  EXPECT_THROW(export_torchscript({garbage.string(), folder.path() / "model.pt", true, {}}), Error);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "model.pt"));
  const std::filesystem::path model_file =
      save_untrained(folder.path(), small_config(nn::Preset::Lte));
  EXPECT_THROW(
      export_torchscript({model_file.string(), folder.path() / "none" / "model.pt", true, {}}),
      Error);
}

/// Stands for a full disk: while it lives no file of this process grows beyond `bytes`.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

/// With room for nothing, for some of the archive, and for all but its end, which LibTorch writes
/// in a destructor.
TEST(ExportErrors, AFullDiskIsOneLineAndLeavesNothing) {
  const test::TempDir folder;
  const std::filesystem::path model_file =
      save_untrained(folder.path(), small_config(nn::Preset::Lte));
  const std::filesystem::path out = folder.path() / "model.pt";
  export_torchscript({model_file.string(), out, true, {}});
  const auto whole = static_cast<rlim_t>(std::filesystem::file_size(out));
  std::filesystem::remove(out);
  for (const rlim_t room : {rlim_t{0}, whole / 2, whole - 1}) {
    const std::string error = test::error_of([&] {
      const FileSizeLimit limit(room);
      export_torchscript({model_file.string(), out, true, {}});
    });
    EXPECT_NE(error.find("model.pt: cannot write: File too large"), std::string::npos) << error;
    EXPECT_EQ(folder.count(), 1u) << "more than the model is left, room " << room;
  }
}

TEST(ExportRounded, WritesAModelFile) {
  const test::TempDir folder;
  const std::filesystem::path model_file =
      save_untrained(folder.path(), small_config(nn::Preset::Lte));
  const std::filesystem::path out = folder.path() / "half.safetensors";
  export_rounded(model_file, out);
  EXPECT_EQ(nn::load_model(out)->config().to_yaml(),
            nn::load_model(model_file)->config().to_yaml());
  EXPECT_EQ(folder.count(), 2u);
}

TEST(TorchscriptNames, HaveNoDots) {
  EXPECT_EQ(attribute_of("encoder.down0.1.mlp.hidden.weight"), "encoder_down0_1_mlp_hidden_weight");
}

}  // namespace
}  // namespace lte::torchscript
