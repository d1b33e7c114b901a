#include "lte/nn/model.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <torch/csrc/autograd/autograd.h>
#include <torch/optim/adam.h>

#include "lte/nn/cost.h"
#include "lte/nn/loss.h"
#include "tests/nn/support.h"

namespace lte::nn {
namespace {

LightTransportModel random_model(const ModelConfig& config = test::tiny_config()) {
  LightTransportModel model(config);
  test::randomize(*model, 21);
  model->eval();
  return model;
}

at::Tensor irradiance(LightTransportModel& model, const PointSet& points, const QuerySet& queries) {
  const at::NoGradGuard no_grad;
  return model->decode(model->encode(points), queries);
}

TEST(Model, ParameterCountsFollowTheFormulasAndThePaper) {
  const auto block = [](int64_t C) { return 40 * C * C + 17 * C; };
  const auto linear = [](int64_t in, int64_t out) { return (in + 1) * out; };
  for (const auto& [D, paper_millions] :
       {std::pair<int64_t, double>(64, 10.5), {128, 42.0}, {256, 167.7}}) {
    ModelConfig config;
    config.channels = D;
    const ParameterCounts counts = count_parameters(LightTransportModel(config));
    const int64_t nne = linear(12, D) + linear(D, D) + 2 * (linear(2 * D, D) + linear(D, D));
    const auto pool = [&](int64_t in, int64_t out) { return in * out + 3 * out; };
    const int64_t pools = pool(D, D) * 2 + pool(D, 2 * D) + pool(2 * D, 2 * D);
    const auto unpool = [](int64_t in, int64_t skip, int64_t out) {
      return (in + skip) * out + 6 * out;
    };
    const int64_t unpools = unpool(2 * D, 2 * D, 2 * D) + unpool(2 * D, D, 2 * D) +
                            unpool(2 * D, D, D) + unpool(D, D, D);
    const int64_t encoder = 125 * D * D + 2 * D + 6 * block(D) + 8 * block(2 * D) + pools +
                            unpools + 4 * block(D) + 4 * block(2 * D) + 2 * D;
    const int64_t layer = 4 * linear(D, D) + linear(D, 4 * D) + linear(4 * D, D) + 4 * D;
    const int64_t decoder = linear(9, D) + linear(D, D) + linear(3, 64) + linear(64, D) +
                            6 * layer + 2 * D + linear(D, D) + linear(D, 3);
    EXPECT_EQ(counts.nne, nne) << "D = " << D;
    EXPECT_EQ(counts.encoder, encoder) << "D = " << D;
    EXPECT_EQ(counts.decoder, decoder) << "D = " << D;
    EXPECT_EQ(counts.total, nne + encoder + decoder) << "D = " << D;
    EXPECT_NEAR(static_cast<double>(counts.total) * 1e-6, paper_millions, 0.003 * paper_millions);
  }
}

TEST(Model, IrradianceIsLinearInEmission) {
  LightTransportModel model = random_model();
  const PointSet points = test::box_scene(120, 1);
  const QuerySet queries = test::box_queries(40, 2);
  const at::Tensor once = irradiance(model, points, queries);
  EXPECT_GT(once.min().item<float>(), 0);
  for (const double factor : {0x1p-20, 0x1p-1, 0x1p20}) {
    PointSet scaled = points;
    scaled.emission = points.emission * factor;
    EXPECT_TRUE(torch::equal(irradiance(model, scaled, queries), once * factor)) << factor;
  }
  for (const double factor : {1e-6, 0.3, 1e6}) {
    PointSet scaled = points;
    scaled.emission = points.emission * factor;
    EXPECT_LT(test::relative_difference(irradiance(model, scaled, queries), once * factor), 1e-5);
  }
}

TEST(Model, ReadsTheLightOnScenePointsThatItsConfigurationNames) {
  const QuerySet queries = test::box_queries(40, 2);
  const PointSet points = test::box_scene(120, 1);
  PointSet more_direct = points, more_indirect = points, gained = points, noisy = points;
  more_direct.direct = points.direct * 2;
  more_indirect.indirect = points.indirect * 2;
  noisy.indirect_error = points.indirect_error * 0.5;
  for (at::Tensor* t : {&gained.emission, &gained.direct, &gained.indirect, &gained.direct_back,
                        &gained.indirect_back})
    *t = *t * 0.5;
  for (const LightInput input : {LightInput::Emission, LightInput::Traced, LightInput::Radiosity}) {
    SCOPED_TRACE(enum_name(input));
    ModelConfig config = test::tiny_config();
    config.light_input = input;
    LightTransportModel model = random_model(config);
    const at::Tensor answer = irradiance(model, points, queries);
    const auto changes = [&](const PointSet& other) {
      return !torch::equal(irradiance(model, other, queries), answer);
    };
    EXPECT_EQ(changes(more_direct), config.reads_light());
    EXPECT_EQ(changes(more_indirect), config.reads_light());
    EXPECT_EQ(changes(noisy), input == LightInput::Traced);
    EXPECT_TRUE(torch::equal(irradiance(model, gained, queries), answer * 0.5));
    PointSet without = points, bad = points;
    without.indirect = at::Tensor();
    bad.direct = points.direct.clone();
    bad.direct[7][1] = -1;
    if (input == LightInput::Emission) {
      without.direct = without.direct_back = without.indirect_back = at::Tensor();
      EXPECT_FALSE(changes(without));
      EXPECT_FALSE(changes(bad));
      continue;
    }
    test::expect_error([&] { irradiance(model, without, queries); },
                       {"scene points", "indirect irradiance is missing"});
    without.direct = at::Tensor();
    test::expect_error([&] { irradiance(model, without, queries); },
                       {"scene points", "direct irradiance is missing"});
    test::expect_error([&] { irradiance(model, bad, queries); }, {"direct irradiance", "row 7"});
  }
}

/// A sheet lit from below is not one lit from above.
TEST(Model, KnowsWhichSideOfASurfaceIsLit) {
  const QuerySet queries = test::box_queries(40, 2);
  const PointSet front = test::box_scene(120, 1);
  PointSet back = front;
  back.direct_back = front.direct - front.direct_back;
  back.indirect_back = front.indirect - front.indirect_back;
  for (const LightInput input : {LightInput::Traced, LightInput::Radiosity}) {
    ModelConfig config = test::tiny_config();
    config.light_input = input;
    LightTransportModel model = random_model(config);
    EXPECT_FALSE(torch::equal(irradiance(model, back, queries), irradiance(model, front, queries)));
  }
}

TEST(Model, RefusesSidesAndErrorsThatAreMissingOrImpossible) {
  ModelConfig config = test::tiny_config();
  config.light_input = LightInput::Traced;
  LightTransportModel model = random_model(config);
  const QuerySet queries = test::box_queries(5, 2);
  const auto refused = [&](const auto& edit, const std::vector<std::string>& words) {
    PointSet points = test::box_scene(60, 1);
    edit(&points);
    test::expect_error([&] { irradiance(model, points, queries); }, words);
  };
  refused([](PointSet* p) { p->direct_back = at::Tensor(); },
          {"scene points", "direct irradiance of the back is missing"});
  refused([](PointSet* p) { p->indirect_back = at::Tensor(); },
          {"indirect irradiance of the back"});
  refused([](PointSet* p) { p->indirect_error = at::Tensor(); }, {"standard error", "is missing"});
  refused([](PointSet* p) { p->indirect_back[7][2] = 4; }, {"row 7", "more than that of both"});
  refused([](PointSet* p) { p->direct_back[7][2] = -1; },
          {"direct irradiance of the back", "row 7"});
  refused([](PointSet* p) { p->indirect_error[9][1] = 1.5; }, {"row 9", "outside [0, 1]"});
  refused([](PointSet* p) { p->indirect_error[9][0] = NAN; }, {"row 9", "outside [0, 1]"});
  refused([](PointSet* p) { p->indirect_error = p->indirect_error.narrow(1, 0, 1); },
          {"must be [60, 2]"});
}

TEST(Model, BlackSceneIsExactlyBlack) {
  LightTransportModel model = random_model();
  PointSet points = test::box_scene(60, 1);
  points.emission.zero_();
  EXPECT_EQ(mean_emission(points), 1);
  EXPECT_EQ(irradiance(model, points, test::box_queries(40, 2)).abs().max().item<float>(), 0);
}

TEST(Model, RadianceScalarIsTheAreaWeightedMean) {
  PointSet points = test::box_scene(2, 1);
  points.emission = torch::tensor({{3.0f, 0.0f, 0.0f}, {0.0f, 6.0f, 6.0f}});
  points.area = torch::tensor({1.0f, 3.0f});
  EXPECT_NEAR(mean_emission(points), (1.0 * 1 + 4.0 * 3) / 4, 1e-12);
  const at::Tensor expected = torch::tensor({3.0 / 4, 18.0 / 4, 18.0 / 4}, at::kDouble);
  EXPECT_TRUE(at::allclose(emission_scale(points), expected, 0, 1e-12));
}

TEST(Model, ChannelsScaleApart) {
  LightTransportModel model = random_model();
  const QuerySet queries = test::box_queries(40, 2);
  PointSet points = test::box_scene(60, 1);
  const at::Tensor once = irradiance(model, points, queries);
  points.emission = points.emission * torch::tensor({4.0f, 0.5f, 1.0f});
  const at::Tensor tinted = irradiance(model, points, queries);
  EXPECT_TRUE(torch::equal(tinted, once * torch::tensor({4.0f, 0.5f, 1.0f})));
  points.emission.select(1, 1).zero_();
  const at::Tensor without_green = irradiance(model, points, queries);
  EXPECT_EQ(without_green.select(1, 1).abs().max().item<float>(), 0);
  EXPECT_GT(without_green.select(1, 0).min().item<float>(), 0);
}

TEST(Model, MovingTheWholeSceneChangesNothing) {
  LightTransportModel model = random_model();
  const PointSet points = test::box_scene(150, 3);
  const QuerySet queries = test::box_queries(40, 4);
  const at::Tensor here = irradiance(model, points, queries);
  // Sixteenths of a metre stay exact in float32 up to 2^20 m.
  for (const auto& offset :
       {torch::tensor({3.5f, -8.25f, 100.0f}), torch::tensor({1e6f, -1e6f, 1e6f})}) {
    PointSet moved = points;
    QuerySet asked = queries;
    moved.position = points.position + offset;
    asked.position = queries.position + offset;
    EXPECT_LT(test::relative_difference(irradiance(model, moved, asked), here), 1e-6);
  }
}

TEST(Model, QueriesDoNotSeeEachOther) {
  LightTransportModel model = random_model();
  const at::NoGradGuard no_grad;
  const Embedding embedding = model->encode(test::box_scene(200, 5));
  const QuerySet queries = test::box_queries(5000, 6);  // more than a block
  const auto pick = [&](const at::Tensor& index) {
    return model->decode(
        embedding, {queries.position.index_select(0, index), queries.normal.index_select(0, index),
                    queries.albedo.index_select(0, index)});
  };
  const at::Tensor all = model->decode(embedding, queries);
  const at::Tensor order = torch::randperm(5000);
  EXPECT_LT(test::relative_difference(pick(order), all.index_select(0, order)), 1e-6);
  for (const int64_t begin : {0, 4090, 4999}) {
    const at::Tensor few = torch::arange(begin, std::min<int64_t>(begin + 13, 5000));
    EXPECT_LT(test::relative_difference(pick(few), all.index_select(0, few)), 1e-6);
  }
  EXPECT_EQ(model->decode(embedding, test::box_queries(0, 1)).sizes(),
            (std::vector<int64_t>{0, 3}));
}

TEST(Model, DecodeIsTheNormalizedAnswerTimesTheScalar) {
  LightTransportModel model = random_model();
  const QuerySet queries = test::box_queries(64, 6);
  const Embedding embedding = model->encode(test::box_scene(200, 5));
  EXPECT_FALSE(embedding.table.defined());
  const at::Tensor expected =
      model->decode_normalized(embedding, queries) * embedding.emission_scale.to(at::kFloat);
  EXPECT_LT(test::relative_difference(model->decode(embedding, queries), expected), 1e-5);
  EXPECT_LT(
      test::relative_difference(irradiance(model, test::box_scene(200, 5), queries), expected),
      1e-5);
}

TEST(Model, AnyNumberAndArrangementOfPointsGivesFiniteIrradiance) {
  for (const Preset preset : {Preset::Paper, Preset::Lte}) {
    ModelConfig config = test::tiny_config();
    config.preset = preset;
    config.encoder_depths = {1, 1, 1, 1, 1};
    config.encoder_widths = {1, 1, 1, 2, 2};
    config.decoder_depths = {1, 1, 1, 0};
    config.decoder_widths = {1, 1, 2, 2};
    LightTransportModel model = random_model(config);
    const QuerySet queries = test::box_queries(30, 8);
    std::vector<PointSet> scenes;
    for (const int64_t M : {1, 2, 3, 5, 33, 257}) scenes.push_back(test::box_scene(M, 9));
    for (const double flat : {0.0, 1.0}) {  // coincident, then coplanar
      PointSet points = test::box_scene(120, 10);
      points.position *= torch::tensor({flat, flat, 0.0}).to(at::kFloat);
      scenes.push_back(points);
    }
    for (const PointSet& points : scenes) {
      const at::Tensor out = irradiance(model, points, queries);
      EXPECT_TRUE(out.isfinite().all().item<bool>())
          << enum_name(preset) << " " << points.position.size(0);
      EXPECT_GE(out.min().item<float>(), 0);
    }
  }
}

TEST(Model, ExtremeButFiniteInputStaysFinite) {
  LightTransportModel model = random_model();
  PointSet points = test::box_scene(100, 11);
  points.emission.mul_(1e30f);
  points.area.narrow(0, 0, 50).fill_(1e-30f);
  QuerySet queries = test::box_queries(4, 12);
  queries.position = torch::tensor(
      {{1e6f, 0.0f, 0.0f}, {-1e30f, 0.0f, 0.0f}, {0.0f, 3e4f, 0.0f}, {0.0f, 0.0f, 0.0f}});
  EXPECT_TRUE(irradiance(model, points, queries).isfinite().all().item<bool>());
}

TEST(Model, ThreadsDoNotChangeTheAnswer) {
  LightTransportModel model = random_model();
  const PointSet points = test::box_scene(400, 5);
  const QuerySet queries = test::box_queries(300, 6);
  const int threads = at::get_num_threads();
  const at::Tensor one = irradiance(model, points, queries);
  at::set_num_threads(3);
  const at::Tensor three = irradiance(model, points, queries);
  at::set_num_threads(threads);
  EXPECT_LT(test::relative_difference(three, one), 1e-6);
}

TEST(Model, BadInputIsRefusedWithItsPlace) {
  LightTransportModel model = random_model();
  const at::NoGradGuard no_grad;
  const auto encode = [&](at::Tensor PointSet::*field, int64_t row, float value) {
    return [&model, field, row, value] {
      PointSet points = test::box_scene(20, 13);
      points.*field = (points.*field).clone();
      (points.*field)[row].fill_(value);
      model->encode(points);
    };
  };
  test::expect_error(encode(&PointSet::position, 7, NAN), {"scene points", "position", "row 7"});
  test::expect_error(encode(&PointSet::normal, 3, INFINITY), {"normal", "row 3"});
  test::expect_error(encode(&PointSet::normal, 3, 2), {"normal", "row 3"});
  test::expect_error(encode(&PointSet::albedo, 0, NAN), {"albedo", "row 0"});
  test::expect_error(encode(&PointSet::albedo, 4, -1), {"albedo", "row 4"});
  test::expect_error(encode(&PointSet::emission, 19, NAN), {"emission", "row 19"});
  test::expect_error(encode(&PointSet::emission, 5, -2), {"emission", "row 5"});
  test::expect_error(encode(&PointSet::area, 2, NAN), {"area", "row 2"});
  test::expect_error([&] { model->encode(test::box_scene(0, 1)); }, {"scene points", "none"});
  test::expect_error(encode(&PointSet::position, 7, 40), {"40 m", "16 m", "Frame::scale"});
  const Embedding embedding = model->encode(test::box_scene(20, 13));
  QuerySet queries = test::box_queries(9, 14);
  queries.position[6][1] = NAN;
  test::expect_error([&] { model->decode(embedding, queries); },
                     {"query points", "position", "row 6"});
  test::expect_error([&] { model->decode_normalized(embedding, queries); }, {"row 6"});
  PointSet uneven = test::box_scene(20, 13);
  uneven.albedo = torch::rand({19, 3});
  test::expect_error([&] { model->encode(uneven); }, {"albedo", "[20, 3]", "[19, 3]"});
}

TEST(Model, CurveOrdersVaryInTrainingOnly) {
  LightTransportModel model = random_model();
  const PointSet points = test::box_scene(300, 15);
  const at::NoGradGuard no_grad;
  const auto features = [&](uint64_t seed) { return model->encode(points, seed).features; };
  EXPECT_TRUE(torch::equal(features(1), features(2)));
  model->train();
  EXPECT_TRUE(torch::equal(features(1), features(1)));
  bool varied = false;
  for (uint64_t seed = 2; seed < 12; ++seed) varied |= !torch::equal(features(1), features(seed));
  EXPECT_TRUE(varied);
}

class ModelOf : public testing::TestWithParam<ModelConfig> {};

TEST_P(ModelOf, GradientsMatchFiniteDifferencesThroughEverything) {
  LightTransportModel model = random_model(GetParam());
  model->to(at::kDouble);
  const PointSet points = test::as_double(test::box_scene(60, 16));
  const QuerySet queries = test::as_double(test::box_queries(6, 17));
  const at::Tensor target = torch::rand({6, 3}, at::kDouble);
  const auto loss = [&] {
    return relative_loss(model->decode_normalized(model->encode(points), queries), target, {});
  };
  test::expect_gradients_match(loss, model->parameters(), 1e-5);
}

TEST_P(ModelOf, AnswersAlikeWithAndWithoutGradients) {
  LightTransportModel model = random_model(GetParam());
  const PointSet points = test::box_scene(300, 20);
  const QuerySet queries = test::box_queries(200, 21);
  const at::Tensor trained = model->decode_normalized(model->encode(points), queries).detach();
  const at::NoGradGuard no_grad;
  EXPECT_LT(
      test::relative_difference(model->decode_normalized(model->encode(points), queries), trained),
      1e-5);
}

TEST_P(ModelOf, LearnsOneBatchByHeart) {
  torch::manual_seed(23);
  LightTransportModel model(GetParam());
  model->train();
  const PointSet points = test::box_scene(80, 18);
  const QuerySet queries = test::box_queries(32, 19);
  const at::Tensor target = 0.2 + 2 * torch::rand({32, 3}).square();
  torch::optim::Adam optimizer(model->parameters(), torch::optim::AdamOptions(3e-3));
  double first = 0, last = 0;
  for (int step = 0; step < 250; ++step) {
    const Embedding embedding = model->encode(points, static_cast<uint64_t>(step));
    const at::Tensor loss = relative_loss(model->decode_normalized(embedding, queries), target, {});
    optimizer.zero_grad();
    loss.backward();
    optimizer.step();
    last = loss.item<double>();
    if (step == 0) first = last;
  }
  EXPECT_GT(first, 0.1);
  EXPECT_LT(last, 0.005);
}

// Scenes of several sizes, so that some stages have one patch and some have several.
TEST_P(ModelOf, SeveralScenesInOnePassAreWhatEachIsAloneGradientsIncluded) {
  LightTransportModel model = random_model(GetParam());
  model->to(at::kDouble);
  std::vector<PointSet> scenes;
  std::vector<QuerySet> queries;
  std::vector<uint64_t> seeds;
  for (const int64_t M : {150, 40, 333, 20}) {
    const auto seed = static_cast<uint64_t>(M);
    scenes.push_back(test::as_double(test::box_scene(M, seed)));
    queries.push_back(test::as_double(test::box_queries(20 + M / 10, seed + 1)));
    seeds.push_back(seed + 2);
  }
  model->train();  // the tiny network has no dropout, and curves are drawn from the seeds
  const std::vector<at::Tensor> together =
      model->decode_normalized(model->encode_batch(scenes, seeds), queries);
  at::Tensor sum = torch::zeros({}, at::kDouble), alone_sum = sum;
  ASSERT_EQ(together.size(), scenes.size());
  for (size_t i = 0; i < scenes.size(); ++i) {
    const at::Tensor alone =
        model->decode_normalized(model->encode(scenes[i], seeds[i]), queries[i]);
    EXPECT_LT(test::relative_difference(together[i], alone), 1e-10) << "scene " << i;
    const at::Tensor weight = torch::rand_like(alone);
    sum = sum + (together[i] * weight).sum();
    alone_sum = alone_sum + (alone * weight).sum();
  }
  const auto got = torch::autograd::grad({sum}, model->parameters()),
             expected = torch::autograd::grad({alone_sum}, model->parameters());
  double largest = 0;
  for (const at::Tensor& g : expected) largest = std::max(largest, g.norm().item<double>());
  for (size_t i = 0; i < got.size(); ++i)
    EXPECT_LT((got[i] - expected[i]).norm().item<double>(), 1e-9 * largest) << "parameter " << i;
}

TEST(Model, RefusesAPassWithASceneOfFewerPointsThanNeighbours) {
  LightTransportModel model = random_model();
  test::expect_error(
      [&] {
        model->encode_batch({test::box_scene(100, 1), test::box_scene(8, 1)}, {0, 0});
      },
      {"scene 1 of a pass", "8 points", "one scene a pass"});
}

TEST(Model, RefusesMoreScenesInAPassThanThereIsRoomFor) {
  LightTransportModel model = random_model();
  const std::vector<PointSet> scenes(17, test::box_scene(8, 1));
  test::expect_error([&] { model->encode_batch(scenes, std::vector<uint64_t>(17, 0)); },
                     {"17 scenes", "1 to 16"});
}

INSTANTIATE_TEST_SUITE_P(Configurations, ModelOf,
                         testing::Values(test::tiny_config(), test::tiny_geometric_config()),
                         [](const auto& each) {
                           return each.param.reads_normals() ? "Geometric" : "AsInThePaper";
                         });

TEST(Model, TellsTheTwoSidesOfABoardApartByTheirNormals) {
  const PointSet points = test::box_scene(200, 22);
  const QuerySet queries = test::box_queries(40, 23);
  for (const bool geometric : {false, true}) {
    LightTransportModel model =
        random_model(geometric ? test::tiny_geometric_config() : test::tiny_config());
    const at::NoGradGuard no_grad;
    Embedding embedding = model->encode(points);
    const at::Tensor answer = model->decode(embedding, queries);
    EXPECT_EQ(embedding.normal.defined(), geometric);
    if (geometric) embedding.normal = -embedding.normal;
    EXPECT_EQ(!torch::equal(model->decode(embedding, queries), answer), geometric);
  }
}

}  // namespace
}  // namespace lte::nn
