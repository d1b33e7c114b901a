#include "lte/data/scene_sample.h"

#include <cmath>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/file.h"
#include "lte/base/safetensors.h"
#include "tests/data/sample_fixture.h"
#include "tests/support/temp_dir.h"

namespace lte::data::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST_F(SceneSampleFile, ComesBackBitForBit) {
  SceneSample sample = make_sample();
  Rng rng(3);
  sample.views.push_back(make_view(&rng, 2, 5, 2));
  sample.query_rays = {64, 4096, 128, 64, 256, 320};
  sample.target_error = 0.02;
  sample.pruned_scene_points = 7;
  sample.pruned_query_points = 1;
  write_scene_sample(path(), sample);
  expect_equal(read_scene_sample(path()), sample);
}

TEST_F(SceneSampleFile, MetalAndIncidentRadianceComeBackBitForBit) {
  SceneSample sample = make_sample();
  Rng rng(4);
  sample.scene_metallic.assign(8, 0.5f);
  sample.scene_roughness.assign(8, 0.1f);
  sample.incident = make_incident(&rng, 3, 4, 2);
  write_scene_sample(path(), sample);
  const SceneSample back = read_scene_sample(path());
  expect_equal(back, sample);
  EXPECT_EQ(back.scene_metallic, sample.scene_metallic);
  EXPECT_EQ(back.scene_roughness, sample.scene_roughness);
  const IncidentField &a = back.incident, &b = sample.incident;
  EXPECT_EQ(a.bins, b.bins);
  EXPECT_EQ(a.samples, b.samples);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.tangent, b.tangent);
  EXPECT_EQ(a.albedo, b.albedo);
  EXPECT_EQ(a.metallic, b.metallic);
  EXPECT_EQ(a.roughness, b.roughness);
  EXPECT_EQ(a.scale, b.scale);
  EXPECT_EQ(a.direct, b.direct);
  EXPECT_EQ(a.indirect, b.indirect);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.pdf, b.pdf);
  const SafetensorsFile file(path());
  EXPECT_EQ(file.at("incident_indirect").dtype, DType::F16);
  EXPECT_EQ(file.at("incident_direct").shape, (std::vector<int64_t>{2, 3, 4, 4, 3}));
  EXPECT_EQ(file.at("incident_direction").shape, (std::vector<int64_t>{4, 4, 3}));
  EXPECT_EQ(file.at("incident_scale").shape, (std::vector<int64_t>{3}));
}

TEST_F(SceneSampleFile, SidesOfLightComeTogetherOrNotAtAll) {
  SceneSample sample = make_sample();
  Rng rng(8);
  for (auto* light : {&sample.scene_direct, &sample.scene_indirect, &sample.scene_direct_back})
    *light = random_vectors(&rng, 2 * 8, 0, 5);
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), sample); }),
              HasSubstr("scene_indirect_back"));
  sample.scene_indirect_back = sample.scene_direct_back;
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), sample); }), HasSubstr("scene_error"));
  sample.scene_error.assign(2 * 8, to_half(0.25f));
  sample.scene_error_back.assign(2 * 8, to_half(1.0f));
  write_scene_sample(path(), sample);
  const SceneSample back = read_scene_sample(path());
  EXPECT_EQ(back.scene_direct_back, sample.scene_direct_back);
  EXPECT_EQ(back.scene_indirect_back, sample.scene_indirect_back);
  EXPECT_EQ(back.scene_error, sample.scene_error);
  EXPECT_EQ(back.scene_error_back, sample.scene_error_back);
  sample.scene_error[3] = to_half(1.5f);
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), sample); }),
              AllOf(HasSubstr("scene_error"), HasSubstr("value 3"), HasSubstr("[0, 1]")));
}

TEST_F(SceneSampleFile, LightOnScenePointsIsOptional) {
  SceneSample sample = make_sample();
  write_scene_sample(path(), sample);
  EXPECT_TRUE(read_scene_sample(path()).scene_direct.empty());
  Rng rng(6);
  sample.scene_direct = random_vectors(&rng, 2 * 8, 0, 5);
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), sample); }),
              HasSubstr("scene_indirect"));  // one without the other
  sample.scene_indirect = random_vectors(&rng, 2 * 8, 0, 5);
  write_scene_sample(path(), sample);
  EXPECT_EQ(read_scene_sample(path()).scene_direct, sample.scene_direct);
  EXPECT_EQ(read_scene_sample(path()).scene_indirect, sample.scene_indirect);
  sample.scene_direct[3].y = -1;
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), sample); }),
              AllOf(HasSubstr("scene_direct"), HasSubstr("entry 3")));
  sample.scene_direct.resize(5);
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), sample); }), HasSubstr("expected 16"));
}

TEST_F(SceneSampleFile, BadMetalAndIncidentRadianceAreRefused) {
  const auto error = [&](const std::function<void(SceneSample*)>& damage) {
    SceneSample sample = make_sample();
    Rng rng(4);
    sample.incident = make_incident(&rng, 3, 4, 2);
    damage(&sample);
    return error_of([&] { write_scene_sample(path(), sample); });
  };
  EXPECT_EQ(error([](SceneSample*) {}), "");
  EXPECT_THAT(error([](SceneSample* s) { s->scene_metallic = {1}; }), HasSubstr("scene_metallic"));
  EXPECT_THAT(error([](SceneSample* s) {
                s->scene_metallic.assign(8, 0);
                s->scene_roughness.assign(8, 2);
              }),
              HasSubstr("scene_roughness"));
  EXPECT_THAT(error([](SceneSample* s) { s->incident.direct[7] = Half{0x7c00}; }),
              AllOf(HasSubstr("incident_direct"), HasSubstr("value 7")));
  EXPECT_THAT(error([](SceneSample* s) { s->incident.indirect[5] = to_half(-1); }),
              AllOf(HasSubstr("incident_indirect"), HasSubstr("value 5")));
  EXPECT_THAT(error([](SceneSample* s) { s->incident.scale[2] = 0; }), HasSubstr("incident_scale"));
  EXPECT_THAT(error([](SceneSample* s) {
                s->incident.tangent[1] = {0, 1, 0};
              }),
              HasSubstr("perpendicular"));
  EXPECT_THAT(error([](SceneSample* s) { s->incident.direct.pop_back(); }),
              HasSubstr("incident_direct"));
  EXPECT_THAT(error([](SceneSample* s) { s->incident.roughness[0] = NAN; }),
              HasSubstr("incident_roughness"));
}

/// 2^-11 of a value, down to 2^-39 of the point's largest, whatever that is.
TEST(HalfScale, KeepsElevenBitsAtAnyMagnitude) {
  Rng rng(8);
  for (const float largest : {1e-30f, 1e-6f, 1.0f, 65504.0f, 1e6f, 3e38f}) {
    const float scale = half_scale(largest);
    int exponent = 0;
    EXPECT_EQ(std::frexp(scale, &exponent), 0.5f) << "a power of two";
    EXPECT_LT(largest / scale, 32768.0f);
    for (int i = 0; i < 1000; ++i) {
      const float value = largest * std::exp2(-rng.uniform(0, 30));
      const Half half = to_half(value / scale);
      ASSERT_TRUE(is_finite(half));
      const double back = double{to_float(half)} * scale;
      ASSERT_NEAR(back, value, std::max(double{value} / 2048, double{std::ldexp(largest, -39)}));
    }
  }
  EXPECT_EQ(half_scale(0), 1);
  EXPECT_THAT(error_of([] { half_scale(INFINITY); }), HasSubstr("finite"));
}

TEST_F(SceneSampleFile, KeepsOptionalTensorsOptionalAndBlackScenesEmpty) {
  SceneSample sample = make_sample(3, 2, 0);
  sample.path_traced_64.clear();
  sample.views.clear();
  write_scene_sample(path(), sample);
  expect_equal(read_scene_sample(path()), sample);
}

TEST_F(SceneSampleFile, PicturesOfFewPathsAreOptionalOneByOne) {
  SceneSample sample = make_sample();
  write_scene_sample(path(), sample);
  for (const auto& picture : read_scene_sample(path()).views[0].path_traced_few)
    EXPECT_TRUE(picture.empty());
  Rng rng(8);
  View& view = sample.views[0];
  view.path_traced_few[0] = random_vectors(&rng, 12, 0, 5);
  view.path_traced_few[2] = random_vectors(&rng, 12, 0, 50);
  write_scene_sample(path(), sample);
  EXPECT_EQ(read_scene_sample(path()).views[0].path_traced_few, view.path_traced_few);
  const SafetensorsFile file(path());
  EXPECT_EQ(file.at("view0_path_traced_16").shape, (std::vector<int64_t>{3, 4, 3}));
  EXPECT_FALSE(file.contains("view0_path_traced_4"));
  EXPECT_TRUE(file.contains("view0_path_traced_1"));
  view.path_traced_few[2][5].y = -1;
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), sample); }),
              AllOf(HasSubstr("view0_path_traced_1:"), HasSubstr("entry 5")));
  view.path_traced_few[2].resize(7);
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), sample); }),
              AllOf(HasSubstr("view0_path_traced_1:"), HasSubstr("expected 12")));
}

TEST_F(SceneSampleFile, SameSampleGivesSameBytes) {
  write_scene_sample(path(), make_sample());
  const std::string first = read_file(path());
  write_scene_sample(path(), make_sample());
  EXPECT_EQ(first, read_file(path()));
}

TEST_F(SceneSampleFile, HasTheDocumentedTensors) {
  write_scene_sample(path(), make_sample(8, 6, 2));
  const SafetensorsFile file(path());
  const std::map<std::string, std::vector<int64_t>> shapes{{"scene_position", {8, 3}},
                                                           {"scene_normal", {8, 3}},
                                                           {"scene_albedo", {8, 3}},
                                                           {"scene_emission", {8, 3}},
                                                           {"scene_area", {8}},
                                                           {"scene_light", {8}},
                                                           {"query_position", {6, 3}},
                                                           {"query_normal", {6, 3}},
                                                           {"query_albedo", {6, 3}},
                                                           {"direct", {2, 6, 3}},
                                                           {"indirect", {2, 6, 3}},
                                                           {"variance", {6}},
                                                           {"path_traced_64", {6, 3}},
                                                           {"view0_mask", {3, 4}},
                                                           {"view0_position", {3, 4, 3}},
                                                           {"view0_normal", {3, 4, 3}},
                                                           {"view0_albedo", {3, 4, 3}},
                                                           {"view0_direct", {2, 3, 4, 3}},
                                                           {"view0_indirect", {2, 3, 4, 3}},
                                                           {"view0_variance", {3, 4}},
                                                           {"view0_path_traced_64", {3, 4, 3}}};
  EXPECT_EQ(file.tensors().size(), shapes.size());
  for (const auto& [name, shape] : shapes) {
    ASSERT_TRUE(file.contains(name)) << name;
    EXPECT_EQ(file.at(name).shape, shape) << name;
    const DType expected = name == "scene_light"  ? DType::I32
                           : name == "view0_mask" ? DType::U8
                                                  : DType::F32;
    EXPECT_EQ(file.at(name).dtype, expected) << name;
  }
  EXPECT_EQ(file.metadata("format"), "lte-scene");
  EXPECT_EQ(file.metadata("version"), "1");
}

}  // namespace
}  // namespace lte::data::test
