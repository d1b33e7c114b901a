// lte_render's quality and time, as its users ask for them.
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lte/base/file.h"
#include "lte/gi/table_entries.h"
#include "lte/image/exr.h"
#include "lte/image/png.h"
#include "tests/infer/tools_fixture.h"

namespace lte::infer {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST_F(Tools, AntialiasingIsOnAndCanBeTurnedOff) {
  const auto edges = [](const std::string& path) {
    return nlohmann::json::parse(read_file(path)).at("edge_pixels").get<int64_t>();
  };
  ASSERT_EQ(render("--out " + at("aa.png") + " --json " + at("aa.json")).code, 0);
  ASSERT_EQ(render("--aa off --out " + at("aa.png") + " --json " + at("off.json")).code, 0);
  EXPECT_GT(edges(at("aa.json")), 0);
  EXPECT_EQ(edges(at("off.json")), 0);
  for (const char* bad : {"on", "0", "-4", "257", "4x", "1e2"}) {
    expect_failure(render("--out " + at("n.png") + " --aa " + bad), 2, HasSubstr("--aa"));
  }
}

TEST_F(Tools, TheDialSetsSwitchesAndFlagsByHandWin) {
  const auto told = [](const std::string& flags) {
    const Outcome done = render("--out " + at("q.exr") + " --json " + at("q.json") + flags);
    EXPECT_EQ(done.code, 0) << done.text;
    return nlohmann::json::parse(read_file(at("q.json")));
  };
  const nlohmann::json last = told(""), draft = told(" --quality draft"),
                       mixed = told(" --quality draft --direct-samples 9 --aa 2 --sparse off");
  EXPECT_EQ(last.at("quality"), "final");
  EXPECT_EQ(last.at("sparse"), false);
  EXPECT_EQ(last.at("direct_samples"), 64);
  EXPECT_EQ(last.at("antialias"), 16);
  EXPECT_EQ(last.at("decoded_pixels"), last.at("queries"));
  EXPECT_EQ(draft.at("quality"), "draft");
  EXPECT_EQ(draft.at("sparse").at("step"), 8);
  EXPECT_EQ(draft.at("antialias"), 0);
  EXPECT_LT(draft.at("decoded_pixels"), draft.at("queries"));
  EXPECT_EQ(mixed.at("direct_samples"), 9);
  EXPECT_EQ(mixed.at("antialias"), 2);
  EXPECT_EQ(mixed.at("decoded_pixels"), mixed.at("queries"));
  const nlohmann::json timed = told(" --time-budget 300s");
  EXPECT_EQ(timed.at("quality"), "final");
  EXPECT_EQ(timed.at("time_budget_seconds"), 300);
}

TEST_F(Tools, GatheredPicturesNeedNoModelAndKeepOneTable) {
  const std::string common = at("room.glb") + " --size 24x16";
  const auto told = [&](const std::string& flags) {
    const Outcome done = run_tool("lte_render", common + flags + " --json " + at("g.json"));
    EXPECT_EQ(done.code, 0) << done.text;
    EXPECT_THAT(done.text, HasSubstr("no model is needed"));
    return nlohmann::json::parse(read_file(at("g.json")));
  };
  const nlohmann::json one = told(" --out " + at("g.exr"));
  EXPECT_EQ(one.at("indirect"), "gather");
  EXPECT_EQ(one.at("decoded_pixels"), 0);
  EXPECT_GT(one.at("gather").at("pixels"), 100);
  EXPECT_EQ(one.at("table").at("light"), "raw");
  EXPECT_GT(one.at("seconds").at("table"), 0);
  EXPECT_GT(one.at("seconds").at("gather"), 0);
  EXPECT_EQ(image::read_exr(at("g.exr"), "indirect").width, 24);
  const nlohmann::json many = told(
      " --gather-rays 4 --correction-paths 2 --table-points 500 --quality draft --turntable 3 "
      "--camera inside --out " +
      at("turn%d.png"));
  ASSERT_EQ(many.at("pictures").size(), 3u);
  EXPECT_LE(many.at("table").at("entries"), 500 * gi::kEntryPoints);
  for (const nlohmann::json& picture : many.at("pictures")) {
    EXPECT_EQ(picture.at("gather").at("rays"), 4);
    EXPECT_EQ(picture.at("gather").at("correction_paths"), 2);
  }
  const Outcome filled = render("--indirect network --out " + at("n.exr"));
  EXPECT_EQ(filled.code, 0) << filled.text;
}

/// The same view twice: by itself it is the same picture, with the light of the first it is sooner
/// ready.
TEST_F(Tools, PicturesOfADraftShareTheirLight) {
  const std::string camera =
      R"("origin": [2, 1.6, 2.8], "target": [2, 1, 0], "up": [0, 1, 0], "vfov": 70})";
  write_file(at("two.json"), R"([{"name": "a", )" + camera + R"(, {"name": "b", )" + camera + "]");
  const auto pictures = [&](const std::string& keep) {
    const Outcome done = run_tool(
        "lte_render", at("room.glb") + " --size 24x16 --quality draft --one-exposure --cameras " +
                          at("two.json") + " --keep-light " + keep + " --out " +
                          at(keep + "{name}.png") + " --json " + at("two_done.json"));
    EXPECT_EQ(done.code, 0) << done.text;
    const nlohmann::json told = nlohmann::json::parse(read_file(at("two_done.json")));
    std::vector<int64_t> asked;
    for (const nlohmann::json& picture : told.at("pictures"))
      asked.push_back(picture.at("gather").at("pixels").get<int64_t>());
    return std::tuple(read_file(at(keep + "a.png")), read_file(at(keep + "b.png")), asked);
  };
  const auto [first, again, all] = pictures("off");
  EXPECT_EQ(first, again);
  EXPECT_EQ(all.at(0), all.at(1));
  const auto [same, taken, few] = pictures("on");
  EXPECT_EQ(same, first);
  EXPECT_EQ(few.at(0), all.at(0));
  EXPECT_LT(few.at(1), all.at(1) / 2);
  expect_failure(render("--keep-light maybe --out " + at("n.png")), 2, HasSubstr("--keep-light"));
}

TEST_F(Tools, FlagsOfGatheredLightThatMakeNoSenseAreOneLineAndNoFile) {
  const std::string out = "--out " + at("never.png");
  expect_failure(render(out + " --indirect decoded --gather-rays 4"), 1,
                 HasSubstr("--gather-rays goes with --indirect gather or network, not decoded"));
  expect_failure(run_tool("lte_render",
                          at("room.glb") + " --checkpoint " + at("tiny.safetensors") + " " + out),
                 1, HasSubstr("--checkpoint goes with --indirect network or decoded"));
  expect_failure(render(out + " --indirect gather --mode reference"), 1,
                 HasSubstr("needs --mode neural"));
  expect_failure(render(out + " --correction-paths 3"), 1, HasSubstr("an even number"));
  expect_failure(render(out + " --indirect light"), 2, HasSubstr("--indirect"));
  expect_failure(render(out + " --table-points 0"), 2, HasSubstr("--table-points"));
  expect_failure(render(out + " --gather-rays -1"), 2, HasSubstr("--gather-rays"));
  expect_failure(render(out + " --indirect gather --table-points 4000000 --max-memory 500M"), 1,
                 AllOf(HasSubstr("4000000 points"), HasSubstr("--table-points")));
  expect_failure(render(out + " --indirect gather --time-budget 1ms"), 1,
                 AllOf(HasSubstr("--time-budget"), HasSubstr("expected")));
  EXPECT_FALSE(std::filesystem::exists(at("never.png")));
}

TEST_F(Tools, ATimeBudgetThatCannotBeKeptIsOneLineAndNoFile) {
  const std::string out = "--out " + at("never.png");
  expect_failure(render(out + " --time-budget 1ms"), 1,
                 AllOf(HasSubstr("--time-budget"), HasSubstr("expected")));
  expect_failure(render(out + " --time-budget 0.5"), 2, HasSubstr("such as 0.5s or 200ms"));
  expect_failure(render(out + " --time-budget 1s --quality draft"), 2, HasSubstr("--quality"));
  expect_failure(render(out + " --time-budget 1s --mode reference"), 1,
                 HasSubstr("--time-budget needs --mode neural"));
  expect_failure(render(out + " --sparse on --mode reference"), 1,
                 HasSubstr("--sparse on needs --mode neural"));
  expect_failure(render(out + " --quality best"), 2, HasSubstr("best"));
  EXPECT_FALSE(std::filesystem::exists(at("never.png")));
}

}  // namespace
}  // namespace lte::infer
