// The binaries: exit codes, one line on failure, nothing half-written.
#include <algorithm>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lte/base/file.h"
#include "lte/image/exr.h"
#include "lte/image/png.h"
#include "lte/scene/export.h"
#include "tests/infer/tools_fixture.h"
#include "tests/support/every_light.h"

namespace lte::infer {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST_F(Tools, RenderWritesPictureAndTimes) {
  const Outcome done = render("--out " + at("a.exr") + " --json " + at("a.json"));
  ASSERT_EQ(done.code, 0) << done.text;
  for (const char* layer : {"", "albedo", "normal", "depth", "direct", "indirect", "emission"}) {
    EXPECT_EQ(image::read_exr(at("a.exr"), layer).width, 24);
  }
  const nlohmann::json json = nlohmann::json::parse(read_file(at("a.json")));
  for (const char* stage :
       {"load", "sample", "encode", "cache", "hits", "irradiance", "write", "total"}) {
    EXPECT_TRUE(json.at("seconds").at(stage).is_number()) << stage;
  }
  EXPECT_GT(json.at("peak_rss_mb").get<double>(), 1);
  EXPECT_GT(json.at("exposure").get<double>(), 0);
}

TEST_F(Tools, ASunThatTheModelHasNeverSeenIsSaidInOneLine) {
  scene::Scene sunny = test::dark_room();
  test::add_punctual(&sunny, scene::LightKind::Directional, {5, 5, 5});
  scene::write_glb(at("sunny.glb"), sunny);
  test::save_tiny_model(at("suns.safetensors"), {.suns = true});
  const auto render_sunny = [](const std::string& rest) {
    return run_tool("lte_render",
                    at("sunny.glb") + " --size 24x16 --out " + at("sunny.exr") + rest);
  };
  const std::string words = "1 directional light, but the model was trained without such light";
  const std::string network = " --integrator network --checkpoint ";
  const Outcome unseen = render_sunny(network + at("tiny.safetensors") + " --set check=off");
  EXPECT_EQ(unseen.code, 0);
  EXPECT_THAT(unseen.text, AllOf(HasSubstr(words), HasSubstr("indirect light is path-traced"),
                                 testing::Not(HasSubstr("warning"))));
  EXPECT_EQ(unseen.text.find(words), unseen.text.rfind(words));
  EXPECT_THAT(render_sunny(network + at("suns.safetensors")).text, testing::Not(HasSubstr(words)));
  EXPECT_THAT(render_sunny(" --integrator path --spp 1").text, testing::Not(HasSubstr(words)));
  EXPECT_THAT(render_sunny(" --output direct").text, testing::Not(HasSubstr(words)));
}

TEST_F(Tools, LightThatReachesNothingSeenIsNamedAndLeftOut) {
  scene::Scene scene = test::furnished_room();
  const int wall = test::add_material(&scene, {0.5f, 0.5f, 0.5f}, {}, /*double_sided=*/true);
  test::add_instance(&scene, test::box_mesh({8, 0, 0}, {9, 1, 1}, wall, /*inwards=*/true));
  test::add_punctual(&scene, scene::LightKind::Point, {5, 5, 5}, {8.5f, 0.5f, 0.5f});
  scene.cameras.push_back({"inside", {2, 1.6f, 2.8f}, {2, 1, 0}, {0, 1, 0}, 70});
  scene::write_glb(at("boxed.glb"), scene);
  const auto culled = [](const std::string& prune, std::string* text) {
    const Outcome done =
        run_tool("lte_render", at("boxed.glb") + " --size 24x16 --out " + at("boxed.exr") +
                                   " --integrator network --checkpoint " + at("tiny.safetensors") +
                                   " --json " + at("boxed.json") + " --set prune=" + prune);
    EXPECT_EQ(done.code, 0) << done.text;
    *text = done.text;
    return nlohmann::json::parse(read_file(at("boxed.json"))).at("left_out_lights").size();
  };
  std::string text;
  EXPECT_EQ(culled("on", &text), 1u);
  EXPECT_THAT(text, AllOf(HasSubstr("does not read light"), HasSubstr("--set prune=off")));
  EXPECT_EQ(culled("off", &text), 0u);
  EXPECT_THAT(text, testing::Not(HasSubstr("does not read light")));
  const std::string unknown = "the model was trained without such light";
  EXPECT_EQ(culled("on --environment 1,1,1", &text), 2u);
  EXPECT_THAT(text, testing::Not(HasSubstr(unknown))) << "the network does not meet the sky";
  EXPECT_EQ(culled("off --environment 1,1,1", &text), 0u);
  EXPECT_THAT(text, HasSubstr(unknown));
}

TEST_F(Tools, TheSameSeedGivesTheSamePictureAndExposureIsRespected) {
  ASSERT_EQ(render("--out " + at("b1.png") + " --set exposure=0.5").code, 0);
  ASSERT_EQ(render("--out " + at("b2.png") + " --set exposure=0.5").code, 0);
  ASSERT_EQ(render("--out " + at("b3.png") + " --set exposure=0.05").code, 0);
  EXPECT_EQ(read_file(at("b1.png")), read_file(at("b2.png")));
  EXPECT_NE(read_file(at("b1.png")), read_file(at("b3.png")));
}

TEST_F(Tools, AWrongCommandLineIsUsage) {
  expect_failure(render("--out " + at("c.png") + " --size 0x16"), 2, HasSubstr("--size"));
  expect_failure(render("--out " + at("c.jpg")), 2, HasSubstr("--out"));
  expect_failure(render("--out " + at("c.png") + " --output glow"), 2, HasSubstr("--output"));
  expect_failure(render("--out " + at("c.png") + " --set exposure=-1"), 1,
                 HasSubstr("--set exposure"));
  expect_failure(eval("--split all"), 2, HasSubstr("--split"));
  expect_failure(eval(""), 2, HasSubstr("--split"));
  expect_failure(eval("--fit-baselines " + at("data")), 2, HasSubstr("--out"));
  expect_failure(render("--out " + at("c.png") + " --set precision=half"), 1,
                 HasSubstr("--set precision: expected fp32 or bf16"));
  expect_failure(render("--out " + at("c.png") + " --set max_memory=2T"), 1,
                 HasSubstr("--set max_memory"));
  expect_failure(eval("--split test --precision fp64"), 2, HasSubstr("--precision"));
  EXPECT_FALSE(std::filesystem::exists(at("c.png")));
}

TEST_F(Tools, BadInputIsOneLineThatNamesTheFile) {
  const std::string out = "--quiet --size 24x16 --out " + at("d.png");
  expect_failure(run_tool("lte_render", at("none.glb") + " " + out), 1, HasSubstr("none.glb"));
  expect_failure(render("--out " + at("none/d.png")), 1, HasSubstr("none/d.png"));
  expect_failure(render("--out " + at("d.png") + " --json " + at("none/d.json")), 1,
                 HasSubstr("none/d.json"));
  expect_failure(render("--out " + at("d.png") + " --camera " + at("none.json")), 1,
                 HasSubstr("none.json"));
  write_file(at("garbage.safetensors"),
             "not a model at all, but long enough to have a header length");
  expect_failure(
      run_tool("lte_render", at("room.glb") + " " + out + " --integrator network --checkpoint " +
                                 at("garbage.safetensors")),
      1, HasSubstr("garbage.safetensors"));
  expect_failure(run_tool("lte_eval", "--quiet --split test --checkpoint " +
                                          at("garbage.safetensors") + " --data " + at("data")),
                 1, HasSubstr("garbage.safetensors"));
  expect_failure(run_tool("lte_eval", "--quiet --split test --checkpoint " +
                                          at("tiny.safetensors") + " --data " + at("none")),
                 1, HasSubstr("none"));
  expect_failure(render("--out " + at("d.png") + " --set max_memory=1"), 1,
                 HasSubstr("--set max_memory"));
  EXPECT_FALSE(std::filesystem::exists(at("d.png")));
}

TEST_F(Tools, MemoryThatIsLimitedOrLacksIsSaidWithNeedAndRemedy) {
  const auto words =
      AllOf(HasSubstr("--max-memory"), HasSubstr("scene points"), HasSubstr("raise the limit"));
  expect_failure(render("--out " + at("m.png") + " --set max_memory=1M"), 1,
                 AllOf(HasSubstr("--set max_memory"), HasSubstr("300 scene points")));
  expect_failure(eval("--split test --max-memory 1"), 1, words);
  const std::string bench = "--channels 16 --repeats 1 --scene-points ";
  expect_failure(run_tool("lte_bench", "encoder --max-memory 30M " + bench + "900000000"), 1,
                 words);
  expect_failure(run_tool("lte_bench", "encoder " + bench + "900000000000"), 1,
                 AllOf(HasSubstr("out of memory"), HasSubstr("--scene-points"), HasSubstr("GiB")));
  expect_failure(run_tool("lte_bench", "decoder --queries 900000000000 " + bench + "500"), 1,
                 AllOf(HasSubstr("out of memory"), HasSubstr("--queries"), HasSubstr("GiB")));
  EXPECT_FALSE(std::filesystem::exists(at("m.png")));
}

TEST_F(Tools, PrecisionAndMemoryLimitReachTheNetwork) {
  const auto metrics = [](const std::string& path) {
    return nlohmann::json::parse(read_file(path)).at("metrics").at("neural").at("points");
  };
  ASSERT_EQ(eval("--split test --json " + at("p1.json")).code, 0);
  ASSERT_EQ(eval("--split test --precision bf16 --json " + at("p2.json")).code, 0);
  ASSERT_EQ(eval("--split test --max-memory 200M --json " + at("p3.json")).code, 0);
  EXPECT_NE(metrics(at("p1.json")), metrics(at("p2.json")));
  EXPECT_EQ(metrics(at("p1.json")), metrics(at("p3.json")));
  ASSERT_EQ(render("--set precision=bf16 --out " + at("p.png") + " --json " + at("p4.json")).code,
            0);
  EXPECT_EQ(nlohmann::json::parse(read_file(at("p4.json"))).at("precision"), "bf16");
  const Outcome bench = run_tool("lte_bench",
                                 "decoder --channels 16 --scene-points 500 --queries 3000 "
                                 "--repeats 1 --precision bf16 --max-memory 40M --json " +
                                     at("p5.json"));
  ASSERT_EQ(bench.code, 0) << bench.text;
  const nlohmann::json row = nlohmann::json::parse(read_file(at("p5.json"))).at(0);
  EXPECT_EQ(row.at("precision"), "bf16");
  for (const char* key : {"name", "n", "seconds_min", "seconds_median", "flops",
                          "gemm_gflops_measured", "peak_rss", "rss_above_model_mb"})
    EXPECT_TRUE(row.contains(key)) << key;
}

TEST_F(Tools, ASceneLargerThanTheModelKnowsIsShrunkUnlessRefused) {
  test::TinyModel small;
  small.scale = 2;
  test::save_tiny_model(at("small.safetensors"), small);
  const std::string common = at("room.glb") +
                             " --quiet --size 24x16 --integrator network --checkpoint " +
                             at("small.safetensors");
  const std::string no = " --set rescale=off";
  expect_failure(run_tool("lte_render", common + no + " --out " + at("e.png")), 1,
                 HasSubstr("the model knows scenes up to 2 m"));
  expect_failure(run_tool("lte_render", common + no + " --validate-only"), 1,
                 HasSubstr("the model knows scenes up to 2 m"));
  for (const char* flag : {"", " --set rescale=on"}) {
    const Outcome done = run_tool("lte_render", common + flag + " --out " + at("e.png"));
    EXPECT_EQ(done.code, 0) << done.text;
  }
  const Outcome said = run_tool(
      "lte_render", at("room.glb") + " --validate-only --integrator network --checkpoint " +
                        at("small.safetensors"));
  EXPECT_EQ(said.code, 0);
  EXPECT_THAT(said.text, HasSubstr("shrunk to the 2 m"));
}

TEST_F(Tools, ValidationRefusesWhatRenderingWould) {
  for (const std::string& flags : std::vector<std::string>{
           " --camera none.json", " --camera sofa", " --up z", " --camera all --out " + at("v.png"),
           " --set environment_turn=3"}) {
    const bool has_out = flags.find("--out") != std::string::npos;
    const std::string out = has_out ? "" : " --out " + at("v.png");
    const Outcome validated = render(flags + " --validate-only"), rendered = render(flags + out);
    EXPECT_EQ(validated.code, 1) << flags;
    EXPECT_EQ(validated.text, rendered.text) << flags;
  }
  EXPECT_EQ(render("--set max_memory=1M --validate-only").code, 1);
  expect_failure(
      run_tool("lte_render", at("room.glb") +
                                 " --quiet --validate-only --integrator network --checkpoint " +
                                 at("none.safetensors")),
      1, HasSubstr("none.safetensors"));
  EXPECT_FALSE(std::filesystem::exists(at("v.png")));
}

TEST_F(Tools, SeveralCamerasMakeSeveralPictures) {
  const auto json = [&](const std::string& name) {
    return nlohmann::json::parse(read_file(at(name)));
  };
  ASSERT_EQ(render("--camera all --out " + at("all_%02d.png") + " --json " + at("all.json")).code,
            0);
  EXPECT_TRUE(std::filesystem::exists(at("all_01.png")));
  const nlohmann::json all = json("all.json");
  ASSERT_EQ(all.at("pictures").size(), 2u);
  EXPECT_EQ(all["pictures"][1]["out"], at("all_01.png"));
  EXPECT_EQ(all["pictures"][1]["camera"]["name"], "outside");
  // Each is the picture that its camera makes alone, by name, by index and from the result.
  ASSERT_EQ(render("--camera outside --out " + at("one.png") + " --json " + at("one.json")).code,
            0);
  EXPECT_EQ(read_file(at("one.png")), read_file(at("all_01.png")));
  EXPECT_EQ(json("one.json").at("camera"), all["pictures"][1]["camera"]);
  ASSERT_EQ(render("--camera 1 --out " + at("two.exr")).code, 0);
  ASSERT_EQ(render("--camera " + at("one.json") + " --out " + at("three.exr")).code, 0);
  ASSERT_EQ(render("--camera " + at("two.exr") + " --out " + at("four.exr")).code, 0);
  EXPECT_EQ(read_file(at("two.exr")), read_file(at("three.exr")));
  EXPECT_EQ(read_file(at("two.exr")), read_file(at("four.exr")));
  expect_failure(render("--camera all --out " + at("x.png")), 1, HasSubstr("%d"));
  expect_failure(render("--camera outsid --out " + at("x.png")), 1, HasSubstr("\"outside\""));
}

TEST_F(Tools, StopsAreSaidAndFactorsFedBack) {
  const auto exposure = [&](const std::string& flags) {
    const Outcome done = render(flags + " --out " + at("ev.png") + " --json " + at("ev.json"));
    EXPECT_EQ(done.code, 0) << done.text;
    const nlohmann::json json = nlohmann::json::parse(read_file(at("ev.json")));
    return std::pair(json.at("exposure").get<double>(), json.at("ev").get<double>());
  };
  const auto [plain, none] = exposure("");
  EXPECT_EQ(none, 0);
  const auto [brighter, two] = exposure("--set ev=2");
  EXPECT_EQ(two, 2);
  EXPECT_NEAR(brighter, 4 * plain, 1e-4 * plain);
  EXPECT_NEAR(exposure("--set exposure=0.5 --set ev=-1").first, 0.25, 1e-6);
  for (const char* key : {"exposure=nan", "exposure=inf", "ev=nan"})
    expect_failure(render("--out " + at("n.png") + " --set " + key), 1, HasSubstr("expected"));
}

TEST_F(Tools, ValidateOnlyWritesNothingAndADarkSceneIsAWarning) {
  const std::vector<std::string> before = folder_->names();
  EXPECT_EQ(render("--validate-only").code, 0);
  EXPECT_EQ(folder_->names(), before);
  const Outcome dark =
      run_tool("lte_render", at("dark.glb") + " --size 24x16 --out " + at("dark.png"));
  EXPECT_EQ(dark.code, 0) << dark.text;
  EXPECT_THAT(dark.text, AllOf(HasSubstr("nothing emits light"), HasSubstr("--environment 1,1,1"),
                               HasSubstr("--add-light auto")));
  EXPECT_THAT(image::read_png(at("dark.png")).pixels, testing::Each(0.0f));
}

TEST_F(Tools, ALightThatIsAddedLightsADarkScene) {
  for (const std::string mode : {"network", "path"}) {
    for (const char* light : {"auto", "0,1.8,0,100", "-0.5,1.5,0,40 --add-light 0.5,1.5,0,40"}) {
      const Outcome lit = run_tool(
          "lte_render", at("dark.glb") + " --size 24x16 --integrator " + mode +
                            (mode == "path" ? "" : " --checkpoint " + at("tiny.safetensors")) +
                            " --out " + at("lit.exr") + " --add-light " + light);
      ASSERT_EQ(lit.code, 0) << lit.text;
      EXPECT_THAT(lit.text, testing::Not(HasSubstr("nothing emits light")));
      const std::vector<float> pixels = image::read_exr(at("lit.exr"), "").pixels;
      EXPECT_GT(*std::max_element(pixels.begin(), pixels.end()), 0) << mode << " " << light;
    }
  }
  expect_failure(render("--out " + at("l.png") + " --add-light 1,2,3"), 1,
                 HasSubstr("x,y,z,power"));
  EXPECT_EQ(render("--validate-only --add-light auto").code, 0);
}

TEST_F(Tools, ALightThatIsAddedByItselfIsWhereTheCameraStands) {
  const auto added = [&](const std::string& flags) {
    return run_tool("lte_render",
                    at("room.glb") +
                        " --validate-only --add-light auto --integrator network --checkpoint " +
                        at("tiny.safetensors") + " " + flags)
        .text;
  };
  const std::string panel = "added a panel", sky = "added an environment";
  EXPECT_THAT(added(""), AllOf(HasSubstr(panel), testing::Not(HasSubstr("environment of"))))
      << "the first";
  EXPECT_THAT(added("--camera outside"), AllOf(HasSubstr(sky), testing::Not(HasSubstr(panel))));
  EXPECT_THAT(added("--camera 1"), HasSubstr(sky));
  EXPECT_THAT(added("--camera auto"), HasSubstr(panel));
  EXPECT_THAT(added("--camera all --out " + at("%d.png")),
              AllOf(HasSubstr(panel), HasSubstr("an environment of radiance 1")));
  expect_failure(run_tool("lte_render", at("room.glb") + " --validate-only --add-light auto" +
                                            " --camera nobody"),
                 1, HasSubstr("nobody"));
}

TEST_F(Tools, APictureThatDoesNotFitIsRefusedBeforeAnyWork) {
  const auto run = [](const std::string& size, const std::string& rest) {
    return run_tool("lte_render", at("room.glb") + " --quiet --size " + size + " " + rest);
  };
  for (const std::string integrator : {"gather", "path"}) {
    const std::string limited = "--set max_memory=1G --integrator " + integrator;
    expect_failure(run("20000x20000", limited + " --out " + at("h.exr")), 1,
                   AllOf(HasSubstr("20000x20000"), HasSubstr("--size"), HasSubstr("GiB")));
    expect_failure(run("8000x8000", limited + " --validate-only"), 1,
                   AllOf(HasSubstr("8000x8000"), HasSubstr("--set max_memory")));
    expect_failure(run("65536x65536", "--integrator " + integrator + " --out " + at("h.exr")), 1,
                   HasSubstr("65536x65536"));
  }
  EXPECT_FALSE(std::filesystem::exists(at("h.exr")));
}

TEST_F(Tools, ProgressIsShownAndQuietIsQuiet) {
  const std::string common = at("room.glb") + " --size 24x16 --out " + at("q.png");
  for (const char* integrator : {"gather", "path"}) {
    const Outcome shown = run_tool("lte_render", common + " --integrator " + integrator);
    EXPECT_THAT(shown.text, HasSubstr("rendering: ")) << integrator;
    EXPECT_EQ(run_tool("lte_render", common + " --quiet --integrator " + integrator).text, "");
  }
  const std::string exporting = "--checkpoint " + at("tiny.safetensors") + " --out " + at("q.pt");
  EXPECT_THAT(run_tool("lte_export", exporting + " --verify").text,
              AllOf(HasSubstr("export: reading"), HasSubstr("export: writing"),
                    HasSubstr("export: comparing at 257 scene points")));
  EXPECT_THAT(run_tool("lte_export", exporting + " --quiet").text,
              testing::Not(HasSubstr("export: ")));
  const Outcome half = run_tool("lte_export", exporting + " --bf16");
  EXPECT_EQ(half.code, 1);
  EXPECT_THAT(half.text, HasSubstr("q.pt: --bf16 writes a model file"));
}

TEST_F(Tools, EvalWritesItsJsonAndReport) {
  const Outcome done = eval("--split test --report " + at("report") + " --json " + at("eval.json"));
  ASSERT_EQ(done.code, 0) << done.text;
  EXPECT_THAT(done.text, AllOf(HasSubstr("neural"), HasSubstr("mean over scenes")));
  EXPECT_TRUE(nlohmann::json::parse(read_file(at("eval.json"))).at("metrics").contains("neural"));
  EXPECT_TRUE(std::filesystem::exists(at("report/report.html")));
  EXPECT_TRUE(std::filesystem::exists(at("report/test0.png")));
}

TEST_F(Tools, FittedBaselinesStandInForTheTrainingSplit) {
  test::write_random_dataset(at("more"), 16);
  ASSERT_EQ(
      run_tool("lte_eval", "--quiet --fit-baselines " + at("more") + " --out " + at("fit.json"))
          .code,
      0);
  const Outcome fitted =
      eval("--split test --baselines " + at("fit.json") + " --json " + at("f1.json"));
  const Outcome implicit = eval("--split test --json " + at("f2.json"));
  ASSERT_EQ(fitted.code, 0) << fitted.text;
  ASSERT_EQ(implicit.code, 0) << implicit.text;
  const auto metrics = [](const std::string& path) {
    return nlohmann::json::parse(read_file(path)).at("metrics");
  };
  EXPECT_EQ(metrics(at("f1.json")), metrics(at("f2.json")));
  expect_failure(eval("--split test --baselines " + at("none.json")), 1, HasSubstr("none.json"));
}

TEST_F(Tools, NoBaselinesAndNoTrainingScenesIsSaidWithTheRemedy) {
  data::DatasetInfo info = data::read_dataset_info(at("data"));
  std::erase_if(info.scenes,
                [](const data::DatasetEntry& entry) { return entry.split == data::Split::Train; });
  info.planned = static_cast<int64_t>(info.scenes.size());
  std::filesystem::copy(at("data"), at("test_only"), std::filesystem::copy_options::recursive);
  data::write_dataset_info(at("test_only"), info);
  expect_failure(run_tool("lte_eval", "--quiet --split test --checkpoint " +
                                          at("tiny.safetensors") + " --data " + at("test_only")),
                 1, HasSubstr("--fit-baselines"));
}

TEST_F(Tools, HelpShowsExamplesAndVersionIsPrinted) {
  for (const char* tool : {"lte_render", "lte_eval", "lte_probe"}) {
    const Outcome help = run_tool(tool, "--help"), version = run_tool(tool, "--version");
    EXPECT_EQ(help.code, 0);
    EXPECT_THAT(help.text, AllOf(HasSubstr("Examples:"), HasSubstr("memory"), HasSubstr("device"),
                                 HasSubstr("precision")));
    EXPECT_EQ(version.code, 0);
    EXPECT_THAT(version.text, HasSubstr(tool));
  }
}

TEST_F(Tools, ScenesReadNothingOutsideTheirFolderUnlessAllowed) {
  std::filesystem::create_directory(at("inner"));
  write_file(at("part.pbrt"), "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n");
  write_file(at("inner/s.pbrt"), "WorldBegin\nInclude \"../part.pbrt\"\n");
  const std::string render = at("inner/s.pbrt") + " --validate-only";
  const auto words =
      AllOf(HasSubstr("s.pbrt:2: \"../part.pbrt\" lies outside"), HasSubstr("(--allow-outside)"));
  expect_failure(run_tool("lte_render", render), 1, words);
  expect_failure(run_tool("lte_bench", "pathtrace --scene " + at("inner/s.pbrt")), 1, words);
  EXPECT_EQ(run_tool("lte_render", render + " --quiet --allow-outside").code, 0);
  expect_failure(run_tool("lte_render", at("room.glb") + " --validate-only --limits triangles=1"),
                 1, AllOf(HasSubstr("more than 1 triangles"), HasSubstr("(--limits triangles=")));
}

}  // namespace
}  // namespace lte::infer
