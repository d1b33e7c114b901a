// Scores, their statistics, and a whole evaluation of made-up scenes.
#include "infer/eval/evaluate.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "infer/eval/measure/embed_sample.h"
#include "infer/eval/report/eval_report.h"
#include "lte/base/check.h"
#include "lte/data/sample_rows.h"
#include "lte/image/denoise.h"
#include "lte/image/png.h"
#include "tests/infer/fixture.h"

namespace lte::infer {
namespace {

TEST(Scores, AreTheirFormulasOnSmallNumbers) {
  // 99 % of the references are at most 2: white is 2.
  std::vector<Rgb> reference(200, Rgb{2, 2, 2}), prediction = reference;
  for (size_t i = 0; i < 50; ++i) prediction[i] = {3, 3, 3};
  const PointScore score = score_points(prediction, reference);
  EXPECT_NEAR(score[0], 0.25, 1e-6);
  EXPECT_NEAR(score[1], 10 * std::log10(4 / 0.25), 1e-5);
  EXPECT_NEAR(score[2], 0.25 / 4.01, 1e-6);
  EXPECT_NEAR(score[3],
              0.25 * std::pow((std::log(4.0) - std::log(3.0)) / (std::log(3.0) + 0.01), 2), 1e-6);
  EXPECT_NEAR(white_exposure(reference), 0.5, 1e-6);
  EXPECT_EQ(white_exposure(std::vector<Rgb>(5)), 1) << "a black reference";
}

TEST(Scores, PsnrDoesNotChangeWithTheUnitOfLight) {
  std::vector<Rgb> reference, prediction;
  for (int i = 0; i < 300; ++i) {
    const auto x = static_cast<float>(i);
    reference.push_back({x, x + 1, 2 * x});
    prediction.push_back({x + 2, x, x});
  }
  const double before = score_points(prediction, reference)[1];
  for (Rgb& value : reference) value *= 1000;
  for (Rgb& value : prediction) value *= 1000;
  EXPECT_NEAR(score_points(prediction, reference)[1], before, 1e-4);
}

TEST(Scores, OfAPerfectViewAreBestAndMaskedPixelsDoNotCount) {
  const int width = 16, height = 12;
  std::vector<uint8_t> mask(size_t{16} * 12, 1);
  std::vector<Rgb> values;
  for (size_t i = 0; i < mask.size(); ++i) {
    if (i % 5 == 0) {
      mask[i] = 0;
    } else {
      values.push_back(Rgb{1, 2, 3} * static_cast<float>(i % 7));
    }
  }
  const ViewScore score = score_view(values, values, values, mask, width, height);
  EXPECT_EQ(score[0], 0);
  EXPECT_EQ(score[1], 100) << "the cap";
  EXPECT_NEAR(score[2], 1, 1e-6);
  EXPECT_EQ(score[3], 0);
  EXPECT_EQ(score[4], 0);
  EXPECT_EQ(score[5], 0);
  const image::Image picture = fill_mask(values, mask, width, height);
  EXPECT_EQ(picture.rgb(5, 0), Rgb{});
  EXPECT_EQ(picture.rgb(6, 0), (Rgb{6, 12, 18}));
}

TEST(Scores, OfWhatIsSeenAreOfTheReferenceWithoutItsNoise) {
  const int width = 24, height = 16;
  const std::vector<uint8_t> mask(size_t{24} * 16, 1);
  std::vector<Rgb> clean, noisy;
  for (size_t i = 0; i < mask.size(); ++i) {
    clean.push_back(Rgb{1, 2, 3} * (1 + 0.1F * static_cast<float>(i % 24)));
    noisy.push_back(clean.back() * (i * 7 % 13 < 6 ? 1.3F : 0.7F));
  }
  const ViewScore raw = score_view(clean, noisy, noisy, mask, width, height),
                  score = score_view(clean, noisy, clean, mask, width, height);
  EXPECT_LT(raw[2], 0.9);
  EXPECT_NEAR(score[2], 1, 1e-6) << "SSIM";
  EXPECT_EQ(score[4], 0) << "FLIP";
  EXPECT_EQ(score[5], 0);
  for (const size_t k : {0, 1, 3}) EXPECT_EQ(score[k], raw[k]) << kViewMetrics[k];
}

TEST(Scores, MeanAndMedianAreOverScenesWithoutTheMissing) {
  std::vector<Scores> scenes(3);
  const double values[] = {1, 2, 9};
  for (size_t i = 0; i < 3; ++i) {
    Score neural, rare;
    neural.points[0] = values[i];
    if (i < 2) neural.views[2] = values[i];
    scenes[i].emplace_back("neural", neural);
    if (i == 1) scenes[i].emplace_back("rare", rare);
  }
  const Scores mean = mean_scores(scenes), median = median_scores(scenes);
  ASSERT_EQ(mean.size(), 1u) << "a predictor that some scenes lack is left out";
  EXPECT_EQ(mean[0].second.points[0], 4);
  EXPECT_EQ(median[0].second.points[0], 2);
  EXPECT_EQ(mean[0].second.views[2], 1.5);
  EXPECT_EQ(median[0].second.views[2], 1.5);
  EXPECT_TRUE(std::isnan(mean[0].second.points[1]));
}

class Evaluation : public testing::Test {
 protected:
  Evaluation() {
    test::write_random_dataset(folder_ / "data");
    test::save_tiny_model(folder_ / "tiny.safetensors");
    settings_.data = folder_ / "data";
  }
  runtime::Network predictor() const { return runtime::Network(folder_ / "tiny.safetensors"); }

  test::TempDir folder_;
  EvalSettings settings_;
};

TEST_F(Evaluation, WritesTheStructureThatOtherProgramsRead) {
  const runtime::Network model = predictor();
  const EvalResult result = evaluate(settings_, model, fit_baselines(settings_.data));
  const nlohmann::json json = nlohmann::json::parse(eval_json(result, "model", "data"));
  EXPECT_EQ(json.at("split"), "test");
  EXPECT_EQ(json.at("scenes"), 2);
  ASSERT_EQ(json.at("per_scene").size(), 2u);
  EXPECT_EQ(json.at("per_scene")[0].at("name"), "test0");
  for (const char* name : {"neural", "path_tracing_64", "constant_mean"}) {
    const nlohmann::json& entry = json.at("metrics").at(name);
    for (const char* metric : {"mse", "psnr", "relmse", "logrel"})
      EXPECT_TRUE(entry.at("points").at(metric).is_number());
    for (const char* metric : {"mse", "psnr", "ssim", "relmse", "flip", "hdrflip"})
      EXPECT_TRUE(entry.at("views").at(metric).is_number());
    double sum = 0;
    for (const nlohmann::json& scene : json.at("per_scene")) {
      sum += scene.at("metrics").at(name).at("points").at("mse").get<double>();
    }
    EXPECT_NEAR(entry.at("points").at("mse").get<double>(), sum / 2, 1e-9);
    EXPECT_NEAR(json.at("median").at(name).at("points").at("mse").get<double>(), sum / 2, 1e-9);
  }
}

TEST_F(Evaluation, ComparesIndirectIrradianceOverTheEmissionScalar) {
  const runtime::Network model = predictor();
  const EvalResult result = evaluate(settings_, model, fit_baselines(settings_.data));
  const data::SceneSample sample =
      data::read_scene_sample(data::scene_path(settings_.data, "test0"));
  const size_t N = sample.query_position.size();
  double error = 0;
  for (size_t i = 0; i < N; ++i) {
    const Rgb difference = sample.path_traced_64[i] - (sample.indirect[i] + sample.indirect[N + i]);
    error += dot(difference, difference) / (3.0 * static_cast<double>(N));
  }
  const SceneResult& scene = result.scenes[0];
  error /= scene.radiance * scene.radiance;
  EXPECT_EQ(scene.scores[1].first, "path_tracing_64");
  EXPECT_NEAR(scene.scores[1].second.points[0], error, 1e-4 * error);
  EXPECT_NEAR(scene.reference_noise, 1e-4 / (scene.radiance * scene.radiance), 1e-8);
}

TEST_F(Evaluation, ShowsTheModelAsManyScenePointsAsAsked) {
  const runtime::Network model = predictor();
  const Baselines baselines = fit_baselines(settings_.data);
  const auto points_mse = [&] {
    return find_score(evaluate(settings_, model, baselines).scenes[0].scores, "neural")->points[0];
  };
  const double of_all = points_mse();
  settings_.scene_points = 16;
  const double of_few = points_mse();
  EXPECT_NE(of_few, of_all);
  // The same of files that have no more.
  for (const char* name : {"test0", "test1"}) {
    const std::filesystem::path path = data::scene_path(settings_.data, name);
    data::SceneSample sample = data::read_scene_sample(path);
    ASSERT_GT(sample.scene_points(), 20);
    data::thin_scene_points(&sample, 16);
    data::write_scene_sample(path, sample);
  }
  settings_.scene_points = 0;
  EXPECT_EQ(points_mse(), of_few);
}

TEST_F(Evaluation, GivesIntervalsAndSamplesAroundItsFigures) {
  const runtime::Network model = predictor();
  settings_.bootstrap.resamples = 200;
  const EvalResult result = evaluate(settings_, model, fit_baselines(settings_.data));
  const nlohmann::json json = nlohmann::json::parse(eval_json(result, "model", "data"));
  EXPECT_EQ(json.at("confidence").at("resamples"), 200);
  const nlohmann::json& bounds =
      json.at("confidence").at("metrics").at("neural").at("points").at("mse");
  const double low = bounds.at(0), high = bounds.at(1);
  // Of two scenes, the resamples are one of them twice or both: the ends are the scenes.
  const auto of_scene = [&](size_t i) {
    return json.at("per_scene")[i].at("metrics").at("neural").at("points").at("mse").get<double>();
  };
  EXPECT_EQ(low, std::min(of_scene(0), of_scene(1)));
  EXPECT_EQ(high, std::max(of_scene(0), of_scene(1)));
  const nlohmann::json& samples = json.at("equal_samples");
  EXPECT_NEAR(samples.at("path_tracing_64").at("views").at("all").get<double>(), 64, 1e-6);
  EXPECT_NEAR(samples.at("path_tracing_16").at("points").at("all").get<double>(), 16, 1e-6);
  EXPECT_NEAR(samples.at("path_tracing_1").at("views").at("median").get<double>(), 1, 1e-6);
  EXPECT_TRUE(json.at("metrics").at("path_tracing_4").at("views").at("ssim").is_null());
  EXPECT_TRUE(json.at("per_scene")[0].at("equal_samples").at("neural").at("views").is_number());
  // The variance of one path by the stored spread: 1e-4 at 256 paths.
  const double stored = 1e-4 * 256;
  double by_64_paths = 0, by_spread = 0;
  for (const SceneResult& scene : result.scenes) {
    EXPECT_NEAR(scene.path_variance, stored / (scene.radiance * scene.radiance), 1e-6);
    by_64_paths +=
        64 * (find_score(scene.scores, "path_tracing_64")->points[0] - scene.reference_noise);
    by_spread += scene.path_variance;
  }
  EXPECT_NEAR(json.at("variance_check").at("ratio").get<double>(), by_64_paths / by_spread, 1e-6);
}

TEST_F(Evaluation, ScoresViewsThatWereTracedWithFewPaths) {
  const std::filesystem::path path = data::scene_path(settings_.data, "test1");
  data::SceneSample sample = data::read_scene_sample(path);
  const runtime::Network model = predictor();
  const auto score = [&](const char* row, size_t scene) {
    const EvalResult result = evaluate(settings_, model, fit_baselines(settings_.data));
    return *find_score(result.scenes[scene].scores, row);
  };
  const Score derived = score("path_tracing_4", 1);
  // Pictures that are off by 1, 2 and 3 times the emission scalar.
  const auto radiance = static_cast<float>(
      evaluate(settings_, model, fit_baselines(settings_.data)).scenes[1].radiance);
  for (data::View& view : sample.views) {
    const size_t pixels = view.mask.size();
    for (size_t i = 0; i < data::kFewPaths.size(); ++i) {
      const float off = radiance * static_cast<float>(i + 1);
      for (size_t p = 0; p < pixels; ++p) {
        const Rgb reference = view.indirect[p] + view.indirect[pixels + p];
        view.path_traced_few[i].push_back(view.mask[p] ? reference + Rgb{off, off, off} : Rgb{});
      }
    }
  }
  data::write_scene_sample(path, sample);
  const EvalResult result = evaluate(settings_, model, fit_baselines(settings_.data));
  double previous = 1;
  for (size_t i = 0; i < data::kFewPaths.size(); ++i) {
    const std::string row = concat("path_tracing_", data::kFewPaths[i]);
    const Score traced = *find_score(result.scenes[1].scores, row);
    EXPECT_NEAR(traced.views[0], std::pow(static_cast<double>(i + 1), 2), 1e-4) << row;
    for (const double value : traced.views) EXPECT_TRUE(std::isfinite(value)) << row;
    EXPECT_LT(traced.views[2], previous) << row << ": SSIM falls with the error";
    previous = traced.views[2];
    const Score other = *find_score(result.scenes[0].scores, row);
    EXPECT_TRUE(std::isnan(other.views[2])) << row << ": the other scene has no such picture";
    EXPECT_EQ(result.scenes[1].scores[2 + i].first, row);
  }
  EXPECT_EQ(find_score(result.scenes[1].scores, "path_tracing_4")->points[0], derived.points[0])
      << "points stay derived";
  const nlohmann::json json = nlohmann::json::parse(eval_json(result, "model", "data"));
  EXPECT_TRUE(json.at("metrics").at("path_tracing_1").at("views").at("flip").is_number());
  EXPECT_THAT(eval_table(result), testing::HasSubstr("derived at points, and traced in views"));
}

TEST_F(Evaluation, PutsTheViewsOfASceneOnOneSheetAndAllOfItOnOnePage) {
  const runtime::Network model = predictor();
  int views = 0;
  ContactSheets sheets(folder_.path());
  settings_.on_view = [&](const ViewPicture& picture) {
    ++views;
    EXPECT_EQ(picture.reference.size(), picture.neural.size());
    EXPECT_EQ(picture.reference.size(), picture.path_traced.size());
    sheets.add(picture);
  };
  const EvalResult result = evaluate(settings_, model, fit_baselines(settings_.data));
  EXPECT_EQ(views, 4);
  EXPECT_THAT(sheets.scenes(), testing::ElementsAre("test0", "test1"));
  const image::Image sheet = image::read_png(folder_ / "test1.png");
  EXPECT_EQ(sheet.height, 2 * 12 * 12 + 4) << "two views of 16 x 12 pixels, 12 times as large";
  EXPECT_EQ(sheet.width, 5 * 192 + 4 * 4);
  const bool denoises = image::Denoiser().is_oidn();
  // By itself, and combined with the network.
  EXPECT_EQ(result.scenes[0].scores.size(), denoises ? 8u : 6u);
  if (denoises) {
    for (const SceneResult& scene : result.scenes) {
      const auto error = [&](const char* row) {
        return std::sqrt(find_score(scene.scores, row)->views[0]);
      };
      const double network = error("neural"), paths = error("path_tracing_64_denoised"),
                   both = error("neural_and_64_denoised");
      EXPECT_LT(std::abs(both - paths), std::abs(both - network)) << "64 of 66 parts of the way";
    }
  }
  const std::string table = eval_table(result);
  EXPECT_THAT(table, testing::HasSubstr("median over scenes"));
  EXPECT_THAT(table, testing::HasSubstr("worth path-traced samples"));
  EXPECT_THAT(table, testing::HasSubstr("105 scenes of the paper"));
  const std::string page = eval_html(result, "a<b", "data", sheets);
  EXPECT_THAT(page, testing::HasSubstr("a&lt;b"));
  EXPECT_THAT(page, testing::HasSubstr("data:image/png;base64,"));
  EXPECT_THAT(page, testing::Not(testing::HasSubstr("http")));
}

TEST_F(Evaluation, DenoisedReferencesChangeWhatIsSeenAlone) {
  const runtime::Network model = predictor();
  const Baselines baselines = fit_baselines(settings_.data);
  const auto views = [&] {
    return evaluate(settings_, model, baselines).mean.front().second.views;
  };
  const ViewScore raw = views();
  settings_.denoise_references = true;
  if (!image::Denoiser().is_oidn()) {
    EXPECT_THROW(views(), Error);
    return;
  }
  const ViewScore seen = views();
  EXPECT_EQ(seen[0], raw[0]) << "MSE";
  EXPECT_NE(seen[2], raw[2]) << "SSIM";
  EXPECT_NE(seen[4], raw[4]) << "FLIP";
}

TEST_F(Evaluation, RefusesAnotherScaleAndAnEmptySplit) {
  const runtime::Network model = predictor();
  const Baselines baselines = fit_baselines(settings_.data);
  const auto message = [&] {
    try {
      evaluate(settings_, model, baselines);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("nothing was thrown");
  };
  settings_.split = data::Split::Val;
  EXPECT_THAT(message(),
              testing::AllOf(testing::HasSubstr("val"), testing::HasSubstr("train 2, test 2")));
  test::write_random_dataset(folder_ / "other", /*scale=*/8);
  settings_.data = folder_ / "other";
  EXPECT_THAT(message(), testing::AllOf(testing::HasSubstr("8"), testing::HasSubstr("16"),
                                        testing::HasSubstr("scale")));
}

TEST_F(Evaluation, RefusesDataWithoutTheLightThatTheModelReads) {
  test::TinyModel tiny;
  tiny.light_input = nn::LightInput::Traced;
  test::save_tiny_model(folder_ / "traced.safetensors", tiny);
  const runtime::Network model(folder_ / "traced.safetensors");
  try {
    evaluate(settings_, model, fit_baselines(settings_.data));
    ADD_FAILURE() << "took data without light on scene points";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("test0: has no scene_direct"));
  }
}

TEST_F(Evaluation, RefusesDataWithoutTheSidesThatTheModelReads) {
  test::TinyModel tiny;
  tiny.light_input = nn::LightInput::Traced;
  test::save_tiny_model(folder_ / "apart.safetensors", tiny);
  const runtime::Network model(folder_ / "apart.safetensors");
  for (const char* name : {"test0", "test1"}) {
    const std::filesystem::path path = data::scene_path(settings_.data, name);
    data::SceneSample sample = data::read_scene_sample(path);
    const auto count = static_cast<size_t>(sample.light_groups * sample.scene_points());
    sample.scene_direct.assign(count, Rgb{1, 1, 1});
    sample.scene_indirect.assign(count, Rgb{1, 1, 1});
    data::write_scene_sample(path, sample);
  }
  try {
    evaluate(settings_, model, fit_baselines(settings_.data));
    ADD_FAILURE() << "took data without the sides of surfaces";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("test0: has no scene_direct_back"));
  }
}

}  // namespace
}  // namespace lte::infer
