#include "lte/data/scene_sample.h"

#include <cmath>
#include <limits>
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

class SceneSampleFile : public Folder {
 protected:
  std::filesystem::path path() const { return folder_ / "room.safetensors"; }
};

void expect_equal(const View& a, const View& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.albedo, b.albedo);
  EXPECT_EQ(a.mask, b.mask);
  EXPECT_EQ(a.direct, b.direct);
  EXPECT_EQ(a.indirect, b.indirect);
  EXPECT_EQ(a.variance, b.variance);
  EXPECT_EQ(a.path_traced_64, b.path_traced_64);
}

void expect_equal(const SceneSample& a, const SceneSample& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.scene_position, b.scene_position);
  EXPECT_EQ(a.scene_normal, b.scene_normal);
  EXPECT_EQ(a.scene_albedo, b.scene_albedo);
  EXPECT_EQ(a.scene_emission, b.scene_emission);
  EXPECT_EQ(a.scene_area, b.scene_area);
  EXPECT_EQ(a.scene_light, b.scene_light);
  EXPECT_EQ(a.query_position, b.query_position);
  EXPECT_EQ(a.query_normal, b.query_normal);
  EXPECT_EQ(a.query_albedo, b.query_albedo);
  EXPECT_EQ(a.light_groups, b.light_groups);
  EXPECT_EQ(a.direct, b.direct);
  EXPECT_EQ(a.indirect, b.indirect);
  EXPECT_EQ(a.variance, b.variance);
  EXPECT_EQ(a.query_rays, b.query_rays);
  EXPECT_EQ(a.path_traced_64, b.path_traced_64);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.rays, b.rays);
  EXPECT_EQ(a.target_error, b.target_error);
  EXPECT_EQ(a.pruned_scene_points, b.pruned_scene_points);
  EXPECT_EQ(a.pruned_query_points, b.pruned_query_points);
  EXPECT_EQ(a.max_depth, b.max_depth);
  EXPECT_EQ(a.bounds_low, b.bounds_low);
  EXPECT_EQ(a.bounds_high, b.bounds_high);
  ASSERT_EQ(a.views.size(), b.views.size());
  for (size_t k = 0; k < a.views.size(); ++k) expect_equal(a.views[k], b.views[k]);
}

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

TEST(DropIdleQueries, RemovesWhatNoGroupLightsAndKeepsTheRest) {
  SceneSample sample;
  sample.light_groups = 2;
  for (int i = 0; i < 5; ++i) {
    const float x = static_cast<float>(i);
    sample.query_position.push_back({x, 0, 0});
    sample.query_normal.push_back({0, 1, 0});
    sample.query_albedo.push_back(i < 4 ? Rgb{x + 1, 0, 0} : Rgb{});
    sample.variance.push_back(x);
    sample.query_rays.push_back(i);
  }
  // Point 0 has indirect light of group 1 only, point 2 direct light of group 0 only; 1 and 3 have
  // none; 4 is lit, but black.
  sample.direct = {{}, {}, {5, 0, 0}, {}, {9, 0, 0}, {}, {}, {}, {}, {}};
  sample.indirect = {{}, {}, {}, {}, {}, {0, 0, 7}, {}, {}, {}, {8, 0, 0}};
  View view;
  view.albedo = {{0, 0, 0}, {0, 0.1f, 0}, {0, 0, 0}, {1, 1, 1}};
  view.mask = {1, 1, 0, 1};
  sample.views = {view};
  EXPECT_EQ(drop_idle_queries(&sample), 3);
  EXPECT_EQ(sample.views[0].mask, (std::vector<uint8_t>{0, 1, 0, 1}));
  EXPECT_EQ(sample.query_position, (std::vector<Vec3>{{0, 0, 0}, {2, 0, 0}}));
  EXPECT_EQ(sample.variance, (std::vector<float>{0, 2}));
  EXPECT_EQ(sample.query_rays, (std::vector<int32_t>{0, 2}));
  EXPECT_EQ(sample.direct, (std::vector<Rgb>{{}, {5, 0, 0}, {}, {}}));
  EXPECT_EQ(sample.indirect, (std::vector<Rgb>{{}, {}, {0, 0, 7}, {}}));
  EXPECT_EQ(drop_idle_queries(&sample), 0);
}

TEST(DropIdleQueries, KeepsABlackSceneWhole) {
  SceneSample sample;
  sample.light_groups = 1;
  sample.query_position = sample.query_normal = sample.query_albedo = {{0, 1, 0}};
  sample.direct = sample.indirect = {{}};
  sample.variance = {0};
  EXPECT_EQ(drop_idle_queries(&sample), 0);
  EXPECT_EQ(sample.query_points(), 1);
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

TEST_F(SceneSampleFile, MissingFileIsNamed) {
  EXPECT_THAT(error_of([&] { read_scene_sample(path()); }), HasSubstr(path().string()));
}

TEST_F(SceneSampleFile, EveryTruncationIsRefused) {
  write_scene_sample(path(), make_sample());
  const std::string bytes = read_file(path());
  for (const size_t size :
       {size_t{0}, size_t{4}, size_t{8}, size_t{100}, bytes.size() / 2, bytes.size() - 1}) {
    const auto cut = folder_ / "cut.safetensors";
    write_file(cut, std::string_view(bytes).substr(0, size));
    EXPECT_THAT(error_of([&] { read_scene_sample(cut); }), HasSubstr(cut.string()))
        << size << " bytes";
  }
}

/// Every fifth bit, so that all places in a byte are met; refused, or the same sample.
TEST_F(SceneSampleFile, FlippedBitsAreRefusedOrHarmless) {
  const SceneSample whole = make_sample();
  write_scene_sample(path(), whole);
  const std::string bytes = read_file(path());
  const auto damaged = folder_ / "damaged.safetensors";
  size_t harmless = 0;
  for (size_t bit = 0; bit < 8 * bytes.size(); bit += 5) {
    std::string copy = bytes;
    copy[bit / 8] = static_cast<char>(copy[bit / 8] ^ (1 << bit % 8));
    lte::test::write_text(damaged, copy);
    try {
      expect_equal(read_scene_sample(damaged), whole);
      ++harmless;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("damaged.safetensors")) << "bit " << bit;
    }
  }
  EXPECT_LE(harmless, 8 * std::string(kChecksumKey).size()) << "in the name of that key alone";
}

TEST_F(SceneSampleFile, ForeignAndNewerFilesAreRefused) {
  const float values[3] = {1, 2, 3};
  SafetensorsWriter weights;
  weights.add("weight", {3}, values);
  weights.write(path());
  EXPECT_THAT(error_of([&] { read_scene_sample(path()); }),
              AllOf(HasSubstr(path().string()), HasSubstr("format is missing")));
  weights.set_metadata("format", "lte-scene");
  weights.set_metadata("version", "2");
  weights.write(path());
  EXPECT_THAT(error_of([&] { read_scene_sample(path()); }),
              AllOf(HasSubstr("version 2"), HasSubstr("update lte")));
  weights.set_metadata("version", "-1");
  weights.write(path());
  EXPECT_THAT(error_of([&] { read_scene_sample(path()); }), HasSubstr("metadata version"));
  write_file(path(), "glTF is not safetensors, and this text is longer than a header length");
  EXPECT_THAT(error_of([&] { read_scene_sample(path()); }), HasSubstr(path().string()));
}

/// Rewrites a good file with one tensor replaced (no data: left out) and returns the reader's line.
std::string error_with(const std::filesystem::path& path, const std::string& name,
                       const TensorView& tensor) {
  write_scene_sample(path, make_sample());
  const auto broken = path.parent_path() / "broken.safetensors";
  {
    const SafetensorsFile file(path);
    SafetensorsWriter writer;
    for (const auto& [key, value] : file.metadata()) writer.set_metadata(key, value);
    for (const auto& [key, value] : file.tensors())
      if (key != name) writer.add(key, value);
    if (tensor.data) writer.add(name, tensor);
    writer.write(broken);
  }
  return error_of([&] { read_scene_sample(broken); });
}

TensorView floats(std::vector<int64_t> shape, const std::vector<float>& values) {
  return {DType::F32, std::move(shape), reinterpret_cast<const std::byte*>(values.data())};
}

TEST_F(SceneSampleFile, BadValuesAreNamedWithTensorAndIndex) {
  const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
  struct Case {
    const char* tensor;
    std::vector<int64_t> shape;
    size_t at;  // flat index of the bad value
    float bad, good;
    const char* entry;
  };
  const std::vector<Case> cases{{"scene_position", {8, 3}, 22, nan, 0, "entry 7"},
                                {"query_position", {6, 3}, 4, inf, 0, "entry 1"},
                                {"scene_emission", {8, 3}, 3, -1, 0, "entry 1"},
                                {"scene_albedo", {8, 3}, 0, 1.5f, 0.5f, "entry 0"},
                                {"query_albedo", {6, 3}, 17, -0.5f, 0.5f, "entry 5"},
                                {"scene_normal", {8, 3}, 6, 2, 0.57735027f, "entry 2"},
                                {"query_normal", {6, 3}, 9, 0, 0.57735027f, "entry 3"},
                                {"scene_area", {8}, 5, -0.1f, 1, "entry 5"},
                                {"direct", {2, 6, 3}, 35, -1e-3f, 1, "entry 11"},
                                {"indirect", {2, 6, 3}, 20, nan, 1, "entry 6"},
                                {"variance", {6}, 2, nan, 1, "entry 2"},
                                {"path_traced_64", {6, 3}, 1, -2, 1, "entry 0"},
                                {"view0_variance", {3, 4}, 11, -1, 1, "entry 11"},
                                {"view0_indirect", {2, 3, 4, 3}, 36, nan, 0, "entry 12"},
                                {"view0_position", {3, 4, 3}, 4, 1, 0, "entry 1 "}};
  for (const Case& c : cases) {
    int64_t numel = 1;
    for (const int64_t n : c.shape) numel *= n;
    std::vector<float> values(static_cast<size_t>(numel), c.good);
    values[c.at] = c.bad;
    EXPECT_THAT(error_with(path(), c.tensor, floats(c.shape, values)),
                AllOf(HasSubstr("broken.safetensors"), HasSubstr(concat("tensor ", c.tensor, ":")),
                      HasSubstr(c.entry)));
  }
}

TEST_F(SceneSampleFile, LightGroupsAndMasksOutOfRangeAreRefused) {
  for (const int32_t bad : {2, -2}) {
    std::vector<int32_t> light(8, -1);
    light[3] = bad;
    const TensorView tensor{DType::I32, {8}, reinterpret_cast<const std::byte*>(light.data())};
    EXPECT_THAT(error_with(path(), "scene_light", tensor),
                AllOf(HasSubstr("scene_light: entry 3"), HasSubstr("below 2")));
  }
  std::vector<uint8_t> mask(12, 1);
  mask[7] = 2;
  const TensorView tensor{DType::U8, {3, 4}, reinterpret_cast<const std::byte*>(mask.data())};
  EXPECT_THAT(error_with(path(), "view0_mask", tensor), HasSubstr("view0_mask: entry 7 is 2"));
}

TEST_F(SceneSampleFile, MissingTensorsAndWrongShapesOrTypesAreNamed) {
  for (const char* name :
       {"scene_position", "scene_area", "direct", "variance", "view0_mask", "view0_indirect"})
    EXPECT_THAT(error_with(path(), name, {}),
                AllOf(HasSubstr("broken.safetensors"), HasSubstr(name)));
  const std::vector<float> ones(64, 1);
  EXPECT_THAT(error_with(path(), "scene_area", floats({7}, ones)), HasSubstr("scene_area"));
  EXPECT_THAT(error_with(path(), "direct", floats({6, 3}, ones)), HasSubstr("direct"));
  EXPECT_THAT(error_with(path(), "indirect", floats({3, 6, 3}, ones)), HasSubstr("indirect"));
  EXPECT_THAT(error_with(path(), "view0_mask", floats({3, 4}, ones)), HasSubstr("view0_mask"));
  EXPECT_THAT(error_with(path(), "view0_albedo", floats({4, 3, 3}, ones)),
              HasSubstr("view0_albedo"));
}

TEST_F(SceneSampleFile, BadMetadataIsNamed) {
  for (const auto& [key, value] :
       std::map<std::string, std::string>{{"seed", "one"},
                                          {"rays", "-5"},
                                          {"max_depth", "0"},
                                          {"target_error", "-0.1"},
                                          {"pruned_query_points", "few"},
                                          {"views", "99999"},
                                          {"bounds", "[0, 0, 0, 1]"},
                                          {"bounds", "[0, 0, 0, 1, 1, null]"}}) {
    write_scene_sample(path(), make_sample());
    const auto broken = folder_ / "broken.safetensors";
    const SafetensorsFile file(path());
    SafetensorsWriter writer;
    for (const auto& [name, tensor] : file.tensors()) writer.add(name, tensor);
    for (const auto& [name, text] : file.metadata()) writer.set_metadata(name, text);
    writer.set_metadata(key, value);
    writer.write(broken);
    EXPECT_THAT(error_of([&] { read_scene_sample(broken); }),
                AllOf(HasSubstr(broken.string()), HasSubstr(key)));
  }
}

TEST_F(SceneSampleFile, WriterRefusesWhatReaderWouldRefuse) {
  SceneSample short_array = make_sample();
  short_array.scene_area.pop_back();
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), short_array); }),
              HasSubstr("scene_area: expected 8 entries, got 7"));
  SceneSample black_hole = make_sample();
  black_hole.indirect[3].y = -1;
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), black_hole); }),
              HasSubstr("indirect: entry 3"));
  SceneSample wrong_group = make_sample();
  wrong_group.light_groups = 3;
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), wrong_group); }),
              HasSubstr("expected 18 entries, got 12"));
  SceneSample empty = make_sample(0, 6, 0);
  EXPECT_THAT(error_of([&] { write_scene_sample(path(), empty); }),
              HasSubstr("at least one scene point"));
  EXPECT_FALSE(std::filesystem::exists(path())) << "a refused sample left a file";
}

TEST_F(SceneSampleFile, UnwritablePlaceIsNamed) {
  write_file(folder_ / "file", "in the way");
  const auto below = folder_ / "file" / "room.safetensors";
  EXPECT_THAT(error_of([&] { write_scene_sample(below, make_sample()); }),
              HasSubstr(below.string()));
}

}  // namespace
}  // namespace lte::data::test
