#include "lte/nn/files/model_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/safetensors.h"
#include "lte/nn/files/model_metadata.h"
#include "tests/nn/support.h"
#include "tests/support/temp_dir.h"

namespace lte::nn {
namespace {

class ModelFile : public ::testing::Test {
 protected:
  ModelFile() {
    torch::manual_seed(1);
    model_ = LightTransportModel(test::tiny_config());
    test::randomize(*model_, 2);
  }

  std::filesystem::path file(const std::string& name) const { return directory_ / name; }

  /// Saves the model, lets `edit` change what is in the file, and writes it back.
  template <typename Edit>
  std::filesystem::path edited(const Edit& edit) {
    save_model(file("whole.safetensors"), model_);
    const SafetensorsFile whole(file("whole.safetensors"));
    std::map<std::string, TensorView> tensors = whole.tensors();
    std::map<std::string, std::string> metadata = whole.metadata();
    edit(tensors, metadata);
    SafetensorsWriter writer;
    for (const auto& [name, view] : tensors) writer.add(name, view);
    for (const auto& [key, value] : metadata) writer.set_metadata(key, value);
    writer.write(file("edited.safetensors"));
    return file("edited.safetensors");
  }

  const test::TempDir directory_;
  LightTransportModel model_{nullptr};
};

const std::string kName = "decoder.gamma.hidden.weight";

TEST_F(ModelFile, RoundTripGivesTheSameIrradianceBitForBit) {
  save_model(file("a.safetensors"), model_, {{"normalization", "none"}});
  LightTransportModel loaded = load_model(file("a.safetensors"));
  EXPECT_FALSE(loaded->is_training());
  EXPECT_EQ(loaded->config().to_yaml(), model_->config().to_yaml());
  EXPECT_EQ(SafetensorsFile(file("a.safetensors")).metadata("normalization"), "none");
  model_->eval();
  const at::NoGradGuard no_grad;
  const PointSet points = test::box_scene(90, 3);
  const QuerySet queries = test::box_queries(20, 4);
  EXPECT_TRUE(torch::equal(loaded->decode(loaded->encode(points), queries),
                           model_->decode(model_->encode(points), queries)));

  LightTransportModel other(test::tiny_config());
  load_weights(file("a.safetensors"), other);
  for (const auto& item : other->named_parameters()) {
    EXPECT_TRUE(torch::equal(item.value(), model_->named_parameters()[item.key()])) << item.key();
  }
}

TEST_F(ModelFile, RoundedWeightsTakeHalfTheBytesAndAreReadAsTheNearestFloats) {
  save_model(file("a.safetensors"), model_, {{"step", "7"}});
  save_rounded(file("a.safetensors"), file("b.safetensors"));
  const SafetensorsFile whole(file("a.safetensors")), half(file("b.safetensors"));
  half.verify();
  for (const auto& [key, value] : whole.metadata()) {
    if (key == kChecksumKey) continue;
    EXPECT_EQ(half.metadata(key), value) << key;
  }
  const LightTransportModel loaded = load_model(file("b.safetensors"));
  LightTransportModel other(test::tiny_config());
  load_weights(file("b.safetensors"), other);
  for (const auto& item : model_->named_parameters()) {
    EXPECT_EQ(half.at(item.key()).size_bytes() * 2, whole.at(item.key()).size_bytes());
    const at::Tensor read = loaded->named_parameters()[item.key()];
    EXPECT_EQ(read.scalar_type(), at::kFloat);
    // Eight bits of mantissa, the first one implied: off by half of the last at most.
    EXPECT_TRUE((read - item.value()).abs().le(item.value().abs() * (1.0 / 256)).all().item<bool>())
        << item.key();
    EXPECT_FALSE(torch::equal(read, item.value()) && item.value().numel() > 8) << item.key();
    EXPECT_TRUE(torch::equal(other->named_parameters()[item.key()], read)) << item.key();
  }
  save_rounded(file("b.safetensors"), file("c.safetensors"));  // what is rounded stays
  EXPECT_EQ(read_file(file("c.safetensors")), read_file(file("b.safetensors")));
}

TEST_F(ModelFile, RefusesWhatIsNotThisModel) {
  auto load = [](const std::filesystem::path& path) { return [path] { load_model(path); }; };
  test::expect_error(load(file("absent.safetensors")), {"absent.safetensors"});
  test::expect_error(load(edited([](auto&, auto& m) { m["format"] = "lte-scene"; })),
                     {"edited.safetensors", "not a model"});
  test::expect_error(load(edited([](auto&, auto& m) { m["format_version"] = "3"; })),
                     {"edited.safetensors", "format version 3", "newer", "update lte"});
  test::expect_error(load(edited([](auto& t, auto&) { t.erase(kName); })),
                     {"edited.safetensors", kName});
  test::expect_error(load(edited([](auto& t, auto&) { t["decoder.extra"] = t[kName]; })),
                     {"edited.safetensors", "superfluous", "decoder.extra"});
  test::expect_error(
      load(edited([](auto& t, auto&) { std::swap(t[kName].shape[0], t[kName].shape[1]); })),
      {"edited.safetensors", kName});
  test::expect_error(load(edited([](auto&, auto& m) { m["model_config"] += "depth: 3\n"; })),
                     {"edited.safetensors", "depth"});
  std::vector<float> bad;
  test::expect_error(load(edited([&](auto& t, auto&) {
                       bad.assign(static_cast<size_t>(t[kName].numel()), 1.0f);
                       bad[5] = std::numeric_limits<float>::quiet_NaN();
                       t[kName].data = reinterpret_cast<const std::byte*>(bad.data());
                     })),
                     {"edited.safetensors", kName, "not finite"});
}

TEST_F(ModelFile, RefusesEarlierFormatsInOneLineWithTheRemedy) {
  // A configuration of that version: keys that are gone must not be the complaint.
  const auto path = edited([](auto&, auto& m) {
    m["format_version"] = "1";
    m["model_config"] = "channels: 16\nstem: conv3\ntarget: indirect\n";
  });
  for (const auto& read : std::vector<std::function<void()>>{
           [&] { load_model(path); }, [&] { load_weights(path, model_); },
           [&] { save_rounded(path, file("rounded.safetensors")); }}) {
    try {
      read();
      ADD_FAILURE() << "it was read";
    } catch (const Error& error) {
      const std::string line = error.what();
      EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 0) << line;
      for (const char* part :
           {"edited.safetensors", "format version 1", "program's 2", "scripts/convert_model.py"})
        EXPECT_NE(line.find(part), std::string::npos) << line;
    }
  }
  EXPECT_FALSE(std::filesystem::exists(file("rounded.safetensors")));
}

/// A thousand bits of header and weights. What reads at all has the same weights.
TEST_F(ModelFile, FlippedBitsAreRefusedOrHarmless) {
  save_model(file("whole.safetensors"), model_);
  const std::string bytes = read_file(file("whole.safetensors"));
  const auto parameters = model_->named_parameters();
  const size_t bits = 8 * bytes.size(), stride = bits / 1000 | 1;
  size_t refused = 0, tried = 0;
  for (size_t bit = 3; bit < bits; bit += stride, ++tried) {
    std::string copy = bytes;
    copy[bit / 8] = static_cast<char>(copy[bit / 8] ^ (1 << bit % 8));
    test::write_text(file("damaged.safetensors"), copy);
    try {
      const LightTransportModel loaded = load_model(file("damaged.safetensors"));
      for (const auto& item : loaded->named_parameters())
        EXPECT_TRUE(torch::equal(item.value(), parameters[item.key()])) << "bit " << bit;
    } catch (const Error& error) {
      ++refused;
      EXPECT_NE(std::string(error.what()).find("damaged.safetensors"), std::string::npos);
    }
  }
  EXPECT_GE(tried, 900u);
  EXPECT_GE(refused + 5, tried);
}

TEST_F(ModelFile, FilesWithoutAChecksumAreRead) {
  save_model(file("a.safetensors"), model_);
  std::string bytes = read_file(file("a.safetensors"));
  // As files of earlier builds: the key is not there. Padding stands in for it.
  const size_t key = bytes.find(std::string("\"") + kChecksumKey);
  ASSERT_NE(key, std::string::npos);
  const size_t end = bytes.find(',', key);
  bytes.replace(key, end + 1 - key, end + 1 - key, ' ');
  std::ofstream(file("b.safetensors"), std::ios::binary) << bytes;
  testing::internal::CaptureStderr();
  const LightTransportModel loaded = load_model(file("b.safetensors"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_TRUE(torch::equal(loaded->named_parameters()[kName], model_->named_parameters()[kName]));
}

TEST_F(ModelFile, AWeightBeyondTheBoundIsNamed) {
  const auto said = [&](float weight) {
    std::vector<float> weights(static_cast<size_t>(model_->named_parameters()[kName].numel()),
                               0.5f);
    weights[7] = -weight;
    const auto path = edited([&](auto& t, auto&) {
      t[kName].data = reinterpret_cast<const std::byte*>(weights.data());
    });
    testing::internal::CaptureStderr();
    load_model(path);
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(said(1e6f), "");
  const std::string line = said(1e30f);
  EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << line;
  for (const char* part : {"warning: ", "edited.safetensors", kName.c_str(), "1e+30"})
    EXPECT_NE(line.find(part), std::string::npos) << line;
}

TEST_F(ModelFile, WeightsOfAnotherConfigurationAreRefusedByName) {
  save_model(file("a.safetensors"), model_);
  ModelConfig config = test::tiny_config();
  config.channels = 32;
  LightTransportModel wide(config);
  test::expect_error([&] { load_weights(file("a.safetensors"), wide); }, {"D = 16", "D = 32"});
  config = test::tiny_config();
  config.head_width = 4;
  LightTransportModel heads(config);
  test::expect_error([&] { load_weights(file("a.safetensors"), heads); }, {"head_width"});
  config = test::tiny_config();
  config.dropout = 0.3;
  LightTransportModel tunable(config);
  EXPECT_NO_THROW(load_weights(file("a.safetensors"), tunable));
}

TEST_F(ModelFile, MetadataAreWrittenAndReadBack) {
  ModelMetadata metadata;
  save_model(file("a.safetensors"), model_);
  const ModelMetadata none = read_model_metadata(file("a.safetensors"));
  EXPECT_EQ(none.entries(), metadata.entries()) << "a file that says nothing means the defaults";
  EXPECT_EQ(none.light_paths, 32);
  EXPECT_EQ(none.light_depth, 5);
  metadata.scene_points = 300;
  metadata.scene_points_pruned = true;
  EXPECT_FALSE(none.suns);
  metadata.suns = true;
  metadata.light_paths = 8;
  metadata.light_depth = 2;
  save_model(file("b.safetensors"), model_, metadata.entries());
  EXPECT_EQ(read_model_metadata(file("b.safetensors")).entries(), metadata.entries());
  for (const auto& [key, value] :
       std::vector<std::pair<std::string, std::string>>{{"scene_points", "many"},
                                                        {"scene_points", "-1"},
                                                        {"scene_points_pruned", "1"},
                                                        {"suns", "2"},
                                                        {"light_paths", "0"},
                                                        {"light_depth", "0"},
                                                        {"light_depth", "5 or so"}}) {
    save_model(file("c.safetensors"), model_, {{key, value}});
    test::expect_error([&] { read_model_metadata(file("c.safetensors")); },
                       {"c.safetensors", key, value});
  }
}

}  // namespace
}  // namespace lte::nn
