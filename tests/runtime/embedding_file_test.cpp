// Embeddings on disk: the same answers, and every other file refused.
#include "lte/runtime/embedding_file.h"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/file.h"
#include "lte/base/safetensors.h"
#include "lte/nn/files/model_file.h"
#include "lte/runtime/torch_parts.h"
#include "lte/tensor/functions.h"
#include "tests/nn/support.h"
#include "tests/support/temp_dir.h"

namespace lte::runtime {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class EmbeddingFile : public testing::Test {
 protected:
  Network network(const nn::ModelConfig& config, uint64_t seed,
                  const NetworkOptions& options = {}) {
    nn::LightTransportModel model(config);
    test::randomize(*model, seed);
    nn::save_model(folder_ / "model.safetensors", model);
    return Network(folder_ / "model.safetensors", options);
  }
  static nn::PointSet points(const nn::ModelConfig& config) {
    nn::PointSet set = test::box_scene(300, 1);
    if (!config.reads_light()) return set;
    set.direct = set.emission * 0.1 + set.albedo;
    set.indirect = set.albedo * 0.5 + 0.1;
    set.direct_back = set.direct * 0.25;
    set.indirect_back = set.indirect * 0.5;
    return set;
  }
  std::string load_error(const Network& network, const EmbeddingKey& key) {
    return test::error_of([&] { load_embedding(file(), network, key); });
  }
  std::filesystem::path file() const { return folder_ / "scene.safetensors"; }

  test::TempDir folder_;
};

TEST_F(EmbeddingFile, GivesTheSameAnswersBitForBit) {
  nn::ModelConfig plain = test::tiny_config(), traced = plain,
                  geometric = test::tiny_geometric_config(), radiance = geometric;
  traced.light_input = nn::LightInput::Traced;
  radiance.light_input = nn::LightInput::Radiosity;
  radiance.radiance_lobes = 4;
  const nn::QuerySet queries = test::box_queries(500, 2);
  for (const nn::ModelConfig& config : {plain, traced, geometric, radiance}) {
    for (const nn::Precision precision : {nn::Precision::Fp32, nn::Precision::Bf16}) {
      const Network net = network(config, 5, {.precision = precision});
      const SceneEmbedding made = TorchParts::encode(net, points(config));
      save_embedding(file(), made, {{"scene", "box"}});
      const SceneEmbedding read = load_embedding(file(), net, {{"scene", "box"}});
      EXPECT_TRUE(
          test::same(TorchParts::decode(made, queries, {}), TorchParts::decode(read, queries, {})));
      if (config.predicts_radiance()) {
        const at::Tensor up = queries.normal.unsqueeze(1);
        EXPECT_TRUE(test::same(
            TorchParts::model(net)->decode_radiance(TorchParts::embedding(made), queries, up, {}),
            TorchParts::model(net)->decode_radiance(TorchParts::embedding(read), queries, up, {})));
      }
      EXPECT_EQ(read.info().scene_points, 300);
      EXPECT_EQ(read.info().latents, made.info().latents);
      EXPECT_EQ(read.info().scale, made.info().scale);
      EXPECT_EQ(read.info().origin, made.info().origin);
      EXPECT_EQ(read.info().emission, made.info().emission);
      EXPECT_EQ(read.info().bytes, made.info().bytes);
    }
  }
}

TEST_F(EmbeddingFile, AGainIsNoPartOfIt) {
  const Network net = network(test::tiny_config(), 5);
  SceneEmbedding made = TorchParts::encode(net, points(net.config()));
  const nn::QuerySet queries = test::box_queries(20, 2);
  const at::Tensor before = TorchParts::decode(made, queries, {});
  made.set_emission_gain({2, 3, 4});
  save_embedding(file(), made, {});
  const SceneEmbedding read = load_embedding(file(), net, {});
  EXPECT_TRUE(test::same(TorchParts::decode(read, queries, {}), before));
}

TEST_F(EmbeddingFile, WhatDiffersIsNamed) {
  const Network net = network(test::tiny_config(), 5);
  const SceneEmbedding made = TorchParts::encode(net, points(net.config()));
  save_embedding(file(), made, {{"scene", "box"}, {"seed", "3"}});
  EXPECT_THAT(load_error(net, {{"scene", "ball"}, {"seed", "3"}}),
              AllOf(HasSubstr("scene.safetensors"), HasSubstr("another scene: box"),
                    HasSubstr("here it is ball")));
  EXPECT_THAT(load_error(net, {{"scene", "box"}, {"seed", "4"}}),
              AllOf(HasSubstr("another seed: 3"), HasSubstr("here it is 4")));
  EXPECT_THAT(load_error(net, {{"scene", "box"}}), HasSubstr("a seed of 3"));
  EXPECT_THAT(load_error(net, {{"scene", "box"}, {"seed", "3"}, {"prune", "on"}}),
              HasSubstr("does not say its prune"));
  EXPECT_THAT(load_error(network(test::tiny_config(), 6), {{"scene", "box"}, {"seed", "3"}}),
              HasSubstr("another model"));
  EXPECT_THAT(load_error(network(test::tiny_config(), 5, {.precision = nn::Precision::Bf16}),
                         {{"scene", "box"}, {"seed", "3"}}),
              AllOf(HasSubstr("another precision: fp32"), HasSubstr("here it is bf16")));
  EXPECT_THAT(test::error_of([&] { load_embedding(folder_ / "model.safetensors", net, {}); }),
              HasSubstr("not an embedding"));
  EXPECT_THAT(test::error_of([&] { load_embedding(folder_ / "none", net, {}); }),
              HasSubstr("none"));
}

TEST_F(EmbeddingFile, NoDamagedFileIsRead) {
  const Network net = network(test::tiny_config(), 5);
  save_embedding(file(), TorchParts::encode(net, points(net.config())), {});
  const std::string whole = read_file(file());
  for (size_t size = 0; size < whole.size(); size += 1 + whole.size() / 40) {
    test::write_text(file(), whole.substr(0, size));
    EXPECT_THAT(load_error(net, {}), HasSubstr("scene.safetensors")) << size;
  }
  for (size_t at = 0; at < whole.size(); at += 1 + whole.size() / 200) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    test::write_text(file(), flipped);
    EXPECT_THAT(load_error(net, {}), HasSubstr("scene.safetensors")) << at;
  }
}

/// Files of other versions and other hands, whole by their checksum.
TEST_F(EmbeddingFile, NoOtherVersionAndNoNonsenseIsRead) {
  const Network net = network(test::tiny_config(), 5);
  save_embedding(file(), TorchParts::encode(net, points(net.config())), {});
  const auto rewrite = [&](const auto& change) {
    save_embedding(file(), TorchParts::encode(net, points(net.config())), {});
    const std::string bytes = read_file(file());
    test::write_text(folder_ / "from", bytes);
    const SafetensorsFile from(folder_ / "from");
    SafetensorsWriter to;
    for (const auto& [key, value] : from.metadata())
      if (key != kChecksumKey) to.set_metadata(key, value);
    change(from, &to);
    to.write(file());
    return load_error(net, {});
  };
  const auto copy_but = [](const SafetensorsFile& from, const std::string& name,
                           SafetensorsWriter* to) {
    for (const auto& [tensor, view] : from.tensors())
      if (tensor != name) to->add(tensor, view);
  };
  EXPECT_THAT(rewrite([&](const auto& from, auto* to) {
                copy_but(from, "", to);
                to->set_metadata("format_version", "3");
              }),
              AllOf(HasSubstr("version 3 is newer"), HasSubstr("update lte")));
  EXPECT_THAT(rewrite([&](const auto& from, auto* to) { copy_but(from, "features", to); }),
              HasSubstr("features"));
  const std::vector<float> few(3, 1.0f), odd = {0, NAN, 0};
  EXPECT_THAT(rewrite([&](const auto& from, auto* to) {
                copy_but(from, "features", to);
                to->add("features", {1, 3}, few.data());
              }),
              AllOf(HasSubstr("features"), HasSubstr("expected")));
  EXPECT_THAT(rewrite([&](const auto& from, auto* to) {
                copy_but(from, "origin", to);
                to->add("origin", {3}, odd.data());
              }),
              AllOf(HasSubstr("origin"), HasSubstr("finite")));
  const std::vector<double> none(1, 0.0);
  EXPECT_THAT(rewrite([&](const auto& from, auto* to) {
                copy_but(from, "scale", to);
                to->add("scale", {1}, none.data());
              }),
              AllOf(HasSubstr("scale"), HasSubstr("more than 0")));
}

}  // namespace
}  // namespace lte::runtime
