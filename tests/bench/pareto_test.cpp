// lte_bench pareto: the rows of every method on a small room, the front, scores of known pictures,
// and what is refused.
#include "bench/pareto/pareto.h"

#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/bench_command.h"
#include "bench/pareto/pareto_report.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/scene/export.h"
#include "tests/infer/fixture.h"
#include "tests/support/command_line.h"
#include "tests/support/folder_files.h"
#include "tests/support/in_folder.h"
#include "tests/support/room.h"
#include "tests/support/temp_dir.h"

namespace lte::bench {
namespace {

using infer::PictureScore;
using infer::score_picture;
using testing::ElementsAre;
using testing::HasSubstr;

class Pareto : public test::InFolder {
 protected:
  Pareto() {
    set_log_level(LogLevel::Quiet);
    scene::Scene room = test::furnished_room();
    room.cameras.push_back({"inside", {2, 1.6F, 2.8F}, {2, 1, 0}, {0, 1, 0}, 70});
    scene::write_glb("room.glb", room);
    test::save_tiny_model("tiny.safetensors");
    options_.scenes = {"room.glb"};
    options_.checkpoint = "tiny.safetensors";
    options_.sizes = {{16, 12}};
    options_.repeats = 1;
    options_.views = 2;
    options_.reference_spp = 512;
  }
  std::vector<ParetoRow> rows_of(const std::vector<std::string>& methods) {
    options_.methods = methods;
    return measure_pareto(options_).front().rows;
  }

  static test::CommandOutcome run(std::vector<std::string> arguments) {
    CLI::App app{"", "lte_bench"};
    BenchRequest request;
    add_bench_options(app, &request);
    arguments.insert(arguments.begin(), "pareto");
    return test::run_command(app, arguments, [&] { run_bench(request); });
  }

  ParetoOptions options_;
};

TEST_F(Pareto, EveryMethodHasFiniteFigures) {
  const std::vector<Method> methods = all_methods();
  std::vector<std::string> names;
  for (const Method& method : methods) {
    // The longest cost a minute and differ from the others by a number.
    if (method.name != "paths-1024" && method.name != "paths-256" &&
        (method.family != "time" || method.name == "time-0.5s"))
      names.push_back(method.name);
  }
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), methods.size() - 7);
  const std::vector<ParetoRow> rows = rows_of(names);
  ASSERT_EQ(rows.size(), names.size());
  for (const ParetoRow& row : rows) {
    SCOPED_TRACE(row.name);
    for (const PictureScore& score : {row.whole, row.indirect}) {
      EXPECT_TRUE(std::isfinite(score.mse) && score.mse > 0);
      EXPECT_TRUE(std::isfinite(score.relmse) && score.relmse > 0);
      EXPECT_TRUE(score.flip > 0 && score.flip < 1);
      EXPECT_TRUE(score.ssim < 1);
    }
    EXPECT_GT(row.view.wall, 0);
    EXPECT_NEAR(row.seconds(10) - row.seconds(1), 9 * row.view.wall, 1e-9);
  }
}

/// The error of n independent paths falls as 1/n, that of stratified ones faster.
TEST_F(Pareto, TheErrorOfPathTracingFallsWithPaths) {
  const std::vector<ParetoRow> rows = rows_of({"paths-1", "paths-16", "paths-64"});
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_LT(rows[1].whole.mse, rows[0].whole.mse / 6);  // a few hundred pixels, some of them rare
  EXPECT_LT(rows[2].whole.mse, rows[1].whole.mse / 2);
  EXPECT_LT(rows[2].indirect.mse, rows[0].indirect.mse / 16);
  EXPECT_LT(rows[2].whole.flip, rows[0].whole.flip);
  EXPECT_GT(rows[2].whole.ssim, rows[0].whole.ssim);
}

/// A reference of 64 paths is as noisy as a picture of 64 other ones.
TEST_F(Pareto, OwnErrorsAreWithoutTheReferencesNoise) {
  options_.reference_spp = 64;
  options_.methods = {"paths-64"};
  const ParetoChart chart = measure_pareto(options_).at(0);
  const ParetoRow& row = chart.rows.at(0);
  // The noise of 64 stratified paths is less than that of the mean of twice 32.
  const auto even = [](double raw, double noise) {
    EXPECT_GT(raw - noise, 0.3 * noise);
    EXPECT_LT(raw - noise, 1.7 * noise);
  };
  even(row.whole.mse, chart.whole_noise.mse);
  even(row.whole.relmse, chart.whole_noise.relmse);
  even(row.indirect.mse, chart.indirect_noise.mse);
  even(row.indirect.relmse, chart.indirect_noise.relmse);
}

TEST_F(Pareto, EqualSeedsGiveEqualPictures) {
  const auto pictures = [&] {
    std::vector<std::vector<uint64_t>> out;
    for (const ParetoRow& row : rows_of({"paths-4", "network-draft", "gather-draft"}))
      out.push_back(row.pictures);
    return out;
  };
  const auto first = pictures();
  EXPECT_EQ(pictures(), first);
  options_.seed = 1;
  EXPECT_NE(pictures(), first);
}

TEST_F(Pareto, KeptReferencesAreReadAgain) {
  const std::vector<std::string> words = {"room.glb", "--size",          "16x12",  "--methods",
                                          "paths-1",  "--views",         "1",      "--repeats",
                                          "1",        "--reference-spp", "8",      "--references",
                                          "kept",     "--json",          "p.json", "--quiet"};
  const auto error = [&] {
    EXPECT_EQ(run(words).code, 0);
    return nlohmann::json::parse(read_file("p.json"))["charts"][0]["rows"][0]["whole"]["mse"];
  };
  const nlohmann::json first = error();
  std::vector<std::filesystem::path> kept;
  for (const auto& entry : std::filesystem::directory_iterator("kept"))
    kept.push_back(entry.path());
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(error(), first);
  write_file(kept[0], "no picture");
  const test::CommandOutcome done = run(words);
  EXPECT_EQ(done.code, 1);
  EXPECT_THAT(done.err, HasSubstr(kept[0].filename().string()));
}

TEST_F(Pareto, CommandWritesData) {
  const test::CommandOutcome done =
      run({"room.glb", "--checkpoint", "tiny.safetensors", "--size", "16x12,20x16", "--methods",
           "paths-1,paths-4,network-draft", "--views", "2", "--repeats", "1", "--reference-spp",
           "64", "--json", "p.json", "--quiet"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("network-draft"));
  const nlohmann::json json = nlohmann::json::parse(read_file("p.json"));
  EXPECT_EQ(json.at("reference_spp"), 64);
  ASSERT_EQ(json.at("charts").size(), 2u);
  const nlohmann::json& chart = json["charts"][1];
  EXPECT_EQ(chart.at("width"), 20);
  for (const char* light : {"whole", "indirect"}) {
    for (const char* error : {"mse", "relmse"}) {
      const double noise = chart.at("reference_noise").at(light).at(error);
      EXPECT_GT(noise, 0);
      const nlohmann::json& score = chart["rows"][0].at(light);
      EXPECT_NEAR(score.at(std::string("own_") + error).get<double>() + noise,
                  score.at(error).get<double>(), 1e-9 * score.at(error).get<double>());
    }
  }
  ASSERT_EQ(chart.at("rows").size(), 3u);
  const nlohmann::json& row = chart["rows"][2];
  EXPECT_EQ(row.at("family"), "network");
  for (const char* key : {"mse", "relmse", "flip", "ssim"})
    EXPECT_TRUE(row.at("whole").at(key).is_number() && row.at("indirect").at(key).is_number());
  for (const char* key : {"seconds", "processor_seconds"})
    EXPECT_TRUE(row.at("once").at(key).is_number() && row.at("view").at(key).is_number());
  EXPECT_GT(row["once"].at("seconds"), 0) << "encoding";
  EXPECT_TRUE(row.at("seconds_of_views").at("100").is_number());
  EXPECT_TRUE(row.at("on_front_of_views").is_array());
}

TEST_F(Pareto, BadInputIsOneLineAndWritesNothing) {
  scene::Scene dark = test::lit_floor();
  for (scene::Material& material : dark.materials) material.emission = {};
  for (scene::Instance& instance : dark.instances) instance.light_group = scene::kNone;
  dark.light_groups.clear();
  scene::write_glb("dark.glb", dark);
  const auto before = test::folder_files(".");
  const std::vector<std::string> common = {"--checkpoint", "tiny.safetensors", "--json", "p.json"};
  const auto refused = [&](std::vector<std::string> words, int code,
                           const std::vector<std::string>& parts) {
    words.insert(words.end(), common.begin(), common.end());
    test::expect_one_line(run(words), code, parts);
    EXPECT_EQ(test::folder_files("."), before);
  };
  refused({"dark.glb"}, 1, {"dark.glb", "emits light"});
  refused({"none.glb"}, 1, {"none.glb"});
  refused({"room.glb", "--methods", "paths,magic"}, 1, {"--methods", "\"magic\"", "gather"});
  refused({"room.glb", "--size", "10x200"}, 1, {"--size 10x200", "11"});
  refused({"room.glb", "--size", "0x9"}, 2, {"--size"});
  refused({"room.glb", "--views", "0"}, 2, {"--views"});
  refused({"room.glb", "--camera", "attic"}, 1, {"attic"});
}

TEST(ParetoFront, KeepsWhatNoOtherBeats) {
  const double nan = std::nan("");
  EXPECT_THAT(pareto_front({{1, 5}, {2, 6}, {3, 2}, {3, 1}, {0.5, 9}, {4, 1}, {nan, 0}, {0, nan}}),
              ElementsAre(4, 0, 3));
  EXPECT_THAT(pareto_front({}), ElementsAre());
}

TEST(ParetoScore, KnowsTheErrorsOfPlainPictures) {
  image::Image gray(16, 12, 3), bright(16, 12, 3);
  for (float& value : gray.pixels) value = 0.5F;
  for (float& value : bright.pixels) value = 0.75F;
  const PictureScore same = score_picture(gray, gray), off = score_picture(bright, gray);
  EXPECT_EQ(same.mse, 0);
  EXPECT_EQ(same.relmse, 0);
  EXPECT_NEAR(same.flip, 0, 1e-6);
  EXPECT_NEAR(same.ssim, 1, 1e-6);
  EXPECT_NEAR(off.mse, 0.0625, 1e-6);
  EXPECT_NEAR(off.relmse, 0.25 / 1.01, 1e-5);  // the mean becomes 1
  EXPECT_GT(off.flip, 0.01);
  EXPECT_TRUE(std::isnan(score_picture({}, gray).mse));
}

TEST(ParetoViews, AreTheCamerasGivenOrOneThatTurnsInItsPlace) {
  scene::Scene scene = test::furnished_room();
  scene.cameras.push_back({"a", {2, 1.6F, 2.8F}, {2, 1.6F, 0}, {0, 1, 0}, 70});
  scene.cameras.push_back({"b", {1, 1.6F, 2.8F}, {2, 1.6F, 0}, {0, 1, 0}, 70});
  const pathtrace::Bvh bvh(scene);
  const std::vector<scene::Camera> all = pareto_views(bvh, "all", 2, 1);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[1].name, "b");
  const std::vector<scene::Camera> turned = pareto_views(bvh, "", 4, 1);
  ASSERT_EQ(turned.size(), 4u);
  std::set<float> angles;
  for (const scene::Camera& camera : turned) {
    EXPECT_EQ(camera.origin, scene.cameras[0].origin);
    const Vec3 view = camera.target - camera.origin;
    EXPECT_NEAR(length(view), 2.8F, 1e-5);
    angles.insert(std::round(std::atan2(view.x, -view.z) * 180 / kPi));
  }
  EXPECT_THAT(angles, ElementsAre(-16, -8, 0, 8));
}

}  // namespace
}  // namespace lte::bench
