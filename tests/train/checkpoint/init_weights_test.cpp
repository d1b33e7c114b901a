#include "train/checkpoint/init_weights.h"

#include <cmath>
#include <cstring>
#include <fstream>

#include "lte/base/check.h"
#include "lte/base/half.h"
#include "lte/base/safetensors.h"
#include "lte/nn/files/model_file.h"
#include "tests/train/run_fixture.h"
#include "tests/train/tool_process.h"
#include "train/checkpoint/first_model.h"
#include "train/checkpoint/widen.h"
#include "train/data/batch.h"

namespace lte::train {
namespace {

namespace fs = std::filesystem;

/// A finished run whose model others start from.
class InitWeights : public test::RunFixture {
 protected:
  static void SetUpTestSuite() {
    RunFixture::SetUpTestSuite();
    runs_ = new test::TempDir;
    train(test::tiny_config(data_->path(), *runs_ / "first"));
  }
  static void TearDownTestSuite() {
    delete runs_;
    RunFixture::TearDownTestSuite();
  }

  static std::string source() { return model_path(*runs_ / "first").string(); }
  TrainConfig from(const std::string& file, const std::string& more = "",
                   const std::string& extra = "") const {
    return config("run", "train: {init_weights: " + file + more + "}\n" + extra);
  }
  static nn::LightTransportModel first(TrainConfig config) {
    RunData data = open_run_data(config);
    return first_model(&config, &data);
  }
  static bool same(const at::Tensor& a, const TensorView& b) {
    return std::memcmp(a.const_data_ptr(), b.data, b.size_bytes()) == 0;
  }

  static test::TempDir* runs_;
};
test::TempDir* InitWeights::runs_ = nullptr;

TEST_F(InitWeights, ANewRunStartsFromThem) {
  const nn::LightTransportModel model = first(from(source()));
  const SafetensorsFile file(source());
  const auto parameters = model->named_parameters();
  EXPECT_EQ(parameters.size(), file.tensors().size());
  for (const auto& item : parameters) {
    EXPECT_TRUE(same(item.value(), file.at(item.key()))) << item.key();
    EXPECT_TRUE(item.value().requires_grad()) << item.key();
  }
}

TEST_F(InitWeights, RoundedOnesAreTakenToo) {
  const std::string rounded = (dir_ / "rounded.safetensors").string();
  nn::save_rounded(source(), rounded);
  const nn::LightTransportModel model = first(from(rounded)), there = nn::load_model(rounded);
  const auto weights = there->named_parameters();
  for (const auto& item : model->named_parameters())
    EXPECT_TRUE(torch::equal(item.value(), weights[item.key()])) << item.key();
}

TEST_F(InitWeights, StepOptimizerScheduleAndAverageAreFresh) {
  train(from(source()), false, 1);
  const SafetensorsFile file(checkpoint_path(dir_ / "run"));
  EXPECT_EQ(read_checkpoint_header(file.path()).progress.step, 1);
  for (const int64_t updates : file.values<int64_t>("updates", {-1})) EXPECT_LE(updates, 1);
  // One step of AdamW from zero moments moves no weight by much more than the rate: 2e-3 / 2
  // warm-up steps.
  const SafetensorsFile before(source());
  double moved = 0;
  for (const auto& [name, tensor] : before.tensors()) {
    const auto x = before.values<float>(name, tensor.shape);
    const auto y = file.values<float>("model." + name, tensor.shape);
    for (size_t i = 0; i < x.size(); ++i) moved = std::max<double>(moved, std::fabs(x[i] - y[i]));
  }
  EXPECT_GT(moved, 0.5e-3);
  EXPECT_LT(moved, 1.1e-3);
}

TEST_F(InitWeights, OfACheckpointTheAveragesAreTaken) {
  const nn::LightTransportModel of_model = first(from(source()));
  const nn::LightTransportModel of_checkpoint =
      first(from(checkpoint_path(*runs_ / "first").string()));
  const auto a = of_model->parameters(), b = of_checkpoint->parameters();
  for (size_t i = 0; i < a.size(); ++i) EXPECT_TRUE(at::equal(a[i], b[i])) << i;
}

TEST_F(InitWeights, WhatIsMissingOrSuperfluousIsListedInOneLine) {
  const auto message = [&](const std::string& model) {
    try {
      first(from(source(), "", "model: {" + model + "}\n"));
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      return std::string(error.what());
    }
    return std::string();
  };
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text << "\nlacks " << part;
  };
  const std::string more = message("query_layers: 3");
  has(more, source());
  has(more, "missing (");
  has(more, "decoder.layer2.");
  EXPECT_EQ(more.find("superfluous"), std::string::npos) << more;
  const std::string fewer = message("query_layers: 1");
  has(fewer, "superfluous (");
  has(fewer, "decoder.layer1.");
  EXPECT_EQ(fewer.find("missing"), std::string::npos) << fewer;
  const std::string wider = message("radiance_lobes: 4, light_input: radiosity");
  has(wider, "of another shape (");
  has(wider, "nne.point.hidden.weight");
  has(wider, "missing (");
  has(wider, "radiance.");
}

TEST_F(InitWeights, ExceptionsKeepTheirFreshValues) {
  const nn::LightTransportModel fresh = first(config("run"));
  const nn::LightTransportModel model =
      first(from(source(), ", init_except: [decoder.head., decoder.layer1]"));
  const SafetensorsFile file(source());
  const auto fresh_parameters = fresh->named_parameters();
  int kept = 0;
  for (const auto& item : model->named_parameters()) {
    const bool except =
        item.key().starts_with("decoder.head.") || item.key().starts_with("decoder.layer1");
    kept += except ? 1 : 0;
    EXPECT_TRUE(except ? at::equal(item.value(), fresh_parameters[item.key()])
                       : same(item.value(), file.at(item.key())))
        << item.key();
  }
  EXPECT_GT(kept, 5);
}

TEST_F(InitWeights, ExceptionsAllowAnotherShape) {
  const std::string model = "model: {query_layers: 3, light_input: radiosity}\n";
  EXPECT_NO_THROW(
      first(from(source(), ", init_except: [decoder.layer2, decoder.point, nne.point]", model)));
  EXPECT_NO_THROW(
      first(from(source(), ", init_except: [decoder.layer1]", "model: {query_layers: 1}\n")));
}

/// With all that the released models are made of, so that every kind of layer is widened.
constexpr const char* kRichModel =
    "encoder_depths: [1, 1, 1], encoder_widths: [1, 1, 2], decoder_depths: [1, 1], "
    "decoder_widths: [1, 1], head_width: 8, preset: lte, light_input: radiosity";

at::Tensor answers_of(nn::LightTransportModel model, const Example& example) {
  model->eval();
  const at::NoGradGuard no_grad;
  return model->decode_normalized(model->encode(example.points), example.queries);
}

TEST_F(InitWeights, AWiderModelBeginsWithTheSameAnswers) {
  const auto rich = [](int64_t channels) {
    return concat("model: {", kRichModel, ", channels: ", channels, "}\n");
  };
  TrainConfig narrow = config("narrow", rich(16));
  train(narrow);
  const std::string file = model_path(dir_ / "narrow").string();
  RunData data = open_run_data(narrow);
  const Example example = validation_examples(narrow, &data.train).front();
  const at::Tensor expected = answers_of(first(from(file, "", rich(16))), example);
  for (const int64_t channels : {32, 48}) {
    nn::LightTransportModel model{nullptr};
    const std::string said =
        test::captured_stderr([&] { model = first(from(file, "", rich(channels))); });
    EXPECT_EQ(said.find("another model"), std::string::npos) << said;
    EXPECT_TRUE(at::allclose(answers_of(model, example), expected, 1e-4, 1e-5)) << channels;
    // Copies learn each for itself.
    const at::Tensor weight = model->named_parameters()["encoder.down1.0.conv_linear.weight"];
    model->train();
    model->decode_normalized(model->encode(example.points), example.queries).sum().backward();
    EXPECT_FALSE(at::allclose(weight.grad().narrow(0, 0, 16), weight.grad().narrow(0, 16, 16)));
  }
}

TEST_F(InitWeights, OnlyWholeTimesAsWideWillDo) {
  for (const char* model : {"channels: 48", "channels: 64, head_width: 16"}) {
    test::expect_error([&] { first(from(source(), "", concat("model: {", model, "}\n"))); },
                       {"do not fit the model", "of another shape"});
  }
  nn::ModelConfig wide, narrow;
  wide.channels = 96;
  narrow.channels = 48;  // one head, which twice the channels would make three of
  narrow.head_width = wide.head_width = 32;
  EXPECT_EQ(widening(wide, narrow), 1);
  narrow.head_width = wide.head_width = 16;
  EXPECT_EQ(widening(wide, narrow), 2);
}

TEST_F(InitWeights, InputThatIsNewCountsNothingAtFirst) {
  const test::TempDir lit;
  test::write_dataset(lit.path(), 2, 0, [](int, data::SceneSample* sample) {
    const size_t rows = static_cast<size_t>(sample->light_groups * sample->scene_points());
    sample->scene_direct.assign(rows, Rgb{1, 1, 1});
    sample->scene_indirect = sample->scene_direct;
    sample->scene_direct_back.assign(rows, Rgb{0.25f, 0.5f, 1});
    sample->scene_indirect_back = sample->scene_direct_back;
    sample->scene_error.assign(rows, to_half(0.25f));
    sample->scene_error_back = sample->scene_error;
  });
  // Light that is solved comes in the columns of light that is traced.
  train(config("solved", "model: {light_input: radiosity}\n"));
  const std::string known = model_path(dir_ / "solved").string();
  TrainConfig run = from(known, "", "model: {light_input: traced}\n");
  run.data.root = lit.path().string();
  const nn::LightTransportModel model = first(run);
  const SafetensorsFile file(known);
  int wider = 0;
  for (const auto& item : model->named_parameters()) {
    const TensorView& before = file.at(item.key());
    const int64_t fresh = item.value().size(-1) - before.shape.back();
    if (fresh == 0) continue;
    ++wider;
    const at::Tensor value = item.value().detach();
    EXPECT_TRUE(same(value.narrow(1, 0, before.shape.back()).contiguous(), before)) << item.key();
    EXPECT_EQ(value.narrow(1, before.shape.back(), fresh).abs().max().item<float>(), 0);
  }
  EXPECT_EQ(wider, 2) << "the first layers of scene points and of queries";
}

TEST_F(InitWeights, EarlierFormatsAreRefusedInOneLine) {
  for (const std::string& path : {source(), checkpoint_path(*runs_ / "first").string()}) {
    const SafetensorsFile file(path);
    SafetensorsWriter writer;
    for (const auto& [name, tensor] : file.tensors()) writer.add(name, tensor);
    for (const auto& [key, value] : file.metadata()) writer.set_metadata(key, value);
    writer.set_metadata("format_version", "1");
    const std::string old = dir_ / "old.safetensors";
    writer.write(old);
    test::expect_error([&] { first(from(old)); },
                       {"old.safetensors", "format version 1", "scripts/convert_model.py"});
  }
}

TEST_F(InitWeights, APrefixOfNothingIsRefused) {
  test::expect_error([&] { first(from(source(), ", init_except: [decoder.haed]")); },
                     {"train.init_except", "decoder.haed"});
  test::expect_error([&] { first(from(source(), ", init_except: ['']")); }, {"train.init_except"});
  test::expect_error([&] { config("run", "train: {init_except: [decoder]}\n"); },
                     {"train.init_except", "train.init_weights"});
}

TEST_F(InitWeights, TheScaleMustBeThatOfTheData) {
  const test::TempDir other;
  test::write_dataset(other.path(), 2, 0);
  data::DatasetInfo info = data::read_dataset_info(other.path());
  info.scale = 9;
  data::write_dataset_info(other.path(), info);
  TrainConfig run = from(source());
  run.data.root = other.path().string();
  test::expect_error([&] { first(run); }, {source(), "8 m", "9 m"});
}

TEST_F(InitWeights, OtherSettingsAreWarnedOf) {
  const std::string said =
      test::captured_stderr([&] { first(from(source(), "", "model: {query_neighbours: 5}\n")); });
  EXPECT_NE(said.find("query_neighbours (5, was 6)"), std::string::npos) << said;
}

TEST_F(InitWeights, BadFilesAreNamed) {
  test::expect_error([&] { first(from("/nonexistent/model.safetensors")); },
                     {"/nonexistent/model.safetensors"});
  const fs::path scene = data::scene_path(data_->path(), "room0");
  test::expect_error([&] { first(from(scene.string())); },
                     {scene.string(), "neither a model nor a checkpoint"});
  const fs::path bad = dir_ / "bad.safetensors";
  const nn::LightTransportModel model = nn::load_model(source());
  {
    const at::NoGradGuard no_grad;
    model->parameters()[3].view(-1)[0].fill_(std::nanf(""));
  }
  nn::save_model(bad, model);
  test::expect_error([&] { first(from(bad.string())); }, {bad.string(), "not finite"});
}

TEST_F(InitWeights, AResumedRunDoesNotReadThemAgain) {
  train(from(source()), false, 2);
  train(config("straight", "train: {init_weights: " + source() + "}\n"));
  // The file may be gone by then.
  train(from("/nonexistent/model.safetensors"), true);
  test::expect_same_tensors(dir_ / "straight/checkpoint.safetensors",
                            dir_ / "run/checkpoint.safetensors");
}

TEST_F(InitWeights, FlagsOfTheProgram) {
  const std::string yaml = (dir_ / "cfg.yaml").string();
  std::ofstream(yaml) << test::tiny_yaml(data_->path(), dir_ / "run");
  const auto tool = [&](std::vector<std::string> args) {
    args.insert(args.begin(), {"--config", yaml, "--quiet"});
    test::ToolProcess child(args, dir_ / "tool");
    return child.wait();
  };
  EXPECT_EQ(tool({"--init-weights", source(), "--init-except", "decoder.head", "--init-except",
                  "nne", "--stop-after", "1"}),
            0);
  EXPECT_NE(read_checkpoint_header(checkpoint_path(dir_ / "run")).config.find("decoder.head"),
            std::string::npos);
  EXPECT_EQ(tool({"--init-weights", source(), "--resume"}), 2);
  EXPECT_EQ(tool({"--init-except", "nne"}), 2);
  fs::remove_all(dir_ / "run");
  EXPECT_EQ(tool({"--init-weights", "/nonexistent"}), 1);
  EXPECT_FALSE(fs::exists(checkpoint_path(dir_ / "run")));
}

}  // namespace
}  // namespace lte::train
