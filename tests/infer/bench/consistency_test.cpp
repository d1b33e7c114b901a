// What lte_bench consistency measures, on a small room and on answers that are known.
#include "infer/bench/consistency.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lte/base/file.h"
#include "tests/infer/session/session_fixture.h"
#include "tests/infer/tools_fixture.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using testing::HasSubstr;

TEST(RepeatedAnswers, AreHeldAgainstTheFirstAtTheirPoint) {
  RepeatedAnswers answers(3);
  answers.add(std::vector<size_t>{0, 2}, std::vector<Rgb>{{1, 2, 3}, {4, 5, 6}});
  EXPECT_EQ(answers.compared(), 0);
  answers.add(std::vector<size_t>{2, 1}, std::vector<Rgb>{{4, 5, 6}, {9, 9, 9}});
  EXPECT_EQ(answers.compared(), 1);
  EXPECT_EQ(answers.largest_change(), 0);
  answers.add(std::vector<size_t>{0}, std::vector<Rgb>{{1, 2.25f, 2.5f}});
  EXPECT_EQ(answers.largest_change(), 0.5);
  answers.add(std::vector<size_t>{1}, std::vector<Rgb>{{NAN, 9, 9}});
  EXPECT_TRUE(std::isnan(answers.largest_change()));
}

TEST(Consistency, CamerasTurnBySmallEvenSteps) {
  const scene::Scene scene = test::furnished_room();
  const pathtrace::Bvh bvh(scene);
  ConsistencyOptions options;
  options.frames = 5;
  options.degrees = 30;
  const auto cameras = consistency_cameras(bvh, session_test::camera(), options);
  ASSERT_EQ(cameras.size(), 5u);
  const auto ahead = [](const scene::Camera& c) {  // about the vertical
    return normalize(Vec3{c.target.x - c.origin.x, 0, c.target.z - c.origin.z});
  };
  for (size_t i = 0; i + 1 < cameras.size(); ++i) {
    EXPECT_NEAR(std::acos(dot(ahead(cameras[i]), ahead(cameras[i + 1]))), 6 * kPi / 180, 1e-3);
    EXPECT_EQ(cameras[i].origin, cameras[0].origin) << "within a room";
  }
}

TEST(Consistency, TheNetworksAnswersDoNotChangeAtAllAndPathsDo) {
  for (const nn::LightInput input : {nn::LightInput::Emission, nn::LightInput::Traced}) {
    const scene::Scene scene = test::furnished_room();
    Renderer renderer(scene);
    renderer.embed(session_test::network(input), {});
    ConsistencyOptions options;
    options.width = 48;
    options.height = 36;
    options.frames = 4;
    options.degrees = 8;
    options.spp = 4;
    const Consistency result = measure_consistency(
        &renderer, consistency_cameras(renderer.bvh(), session_test::camera(), options), options);
    EXPECT_GT(result.points, 100);
    EXPECT_GT(result.answers, result.points) << "most are seen by several frames";
    EXPECT_EQ(result.largest_change, 0);
    ASSERT_EQ(result.rows.size(), 4u);
    const ConsistencyRow &every = result.rows[0], &paths = result.rows[2];
    for (const ConsistencyRow& row : result.rows) EXPECT_GT(row.total.compared, 1000) << row.name;
    EXPECT_LT(every.indirect.change, paths.indirect.change);
    EXPECT_LT(result.rows[3].total.change, paths.total.change) << "denoised";
  }
}

TEST_F(Tools, ConsistencyIsMeasuredFromTheCommandLine) {
  const std::string scene = at("room.glb") + " --checkpoint " + at("tiny.safetensors");
  const Outcome done =
      run_tool("lte_bench", "consistency " + scene +
                                " --size 24x16 --frames 2 --degrees 3 --spp 2 --quiet --json " +
                                at("consistency.json"));
  ASSERT_EQ(done.code, 0) << done.text;
  EXPECT_THAT(done.text, HasSubstr("answers change by 0 W/m2"));
  const nlohmann::json told = nlohmann::json::parse(read_file(at("consistency.json")));
  EXPECT_EQ(told.at("largest_change"), 0);
  EXPECT_EQ(told.at("rows").size(), 4u);
  expect_failure(run_tool("lte_bench", "consistency " + scene + " --frames 1"), 2,
                 HasSubstr("--frames"));
  expect_failure(run_tool("lte_bench", "consistency " + at("dark.glb") + " --quiet"), 1,
                 HasSubstr("nothing emits light"));
}

}  // namespace
}  // namespace lte::infer
