// The flags of the tools with a network, in this process: no output replaces an input, no number is
// another.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/bench_command.h"
#include "infer/eval/eval_command.h"
#include "infer/export/export_command.h"
#include "infer/render/render_command.h"
#include "lte/scene/export.h"
#include "tests/infer/fixture.h"
#include "tests/support/command_line.h"
#include "tests/support/folder_files.h"
#include "tests/support/in_folder.h"
#include "tests/support/temp_dir.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;
using test::CommandOutcome;
using test::expect_one_line;
using test::folder_files;

class InferFiles : public test::InFolder {
 protected:
  InferFiles() {
    scene::write_glb("room.glb", test::lit_floor());
    test::save_tiny_model("tiny.safetensors");
    test::write_random_dataset("homes");
    test::write_text("camera.json",
                     R"({"origin":[0,1,0],"target":[0,0,0],"up":[0,0,-1],"vfov":60})");
    test::write_text("red.mtl", "newmtl red\nKd 1 0 0\n");
    test::write_text("red.obj", "mtllib red.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    test::write_text("sky.png", "");
    fs::create_symlink("sky.png", "link.png");
    fs::create_hard_link("tiny.safetensors", "twin.safetensors");
    fs::create_directory_symlink("homes", "houses");
  }
  /// Runs a command line whose words have no blanks in them; the first is the tool.
  static CommandOutcome run_line(const std::string& line) {
    std::vector<std::string> arguments = split(line);
    const std::string tool = arguments.front();
    arguments.erase(arguments.begin());
    CLI::App app{"", tool};
    RenderRequest render;
    EvalRequest eval;
    bench::BenchRequest bench;
    ExportRequest exported;
    if (tool == "lte_render") {
      add_render_options(app, &render);
      return test::run_command(app, arguments, [&] { run_render(render); });
    }
    if (tool == "lte_eval") {
      add_eval_options(app, &eval);
      return test::run_command(app, arguments, [&] { run_eval(eval); });
    }
    if (tool == "lte_bench") {
      bench::add_bench_options(app, &bench);
      return test::run_command(app, arguments, [&] { bench::run_bench(bench); });
    }
    add_export_options(app, &exported);
    return test::run_command(app, arguments, [&] { run_export(exported); });
  }
};

TEST_F(InferFiles, NoOutputReplacesAnInputOrAnotherOutput) {
  struct Case {
    const char *line, *first, *second;
  };
  const Case cases[] = {
      {"lte_render room.glb --out a.png --json room.glb", "--json", "SCENE"},
      {"lte_render room.glb --out a.png --json a.png", "--json", "--out"},
      {"lte_render room.glb --out a.png --log-file room.glb", "--log-file", "SCENE"},
      {"lte_render room.glb --out a.png --camera camera.json --json camera.json", "--json",
       "--camera"},
      {"lte_render room.glb --out sky.png --environment sky.png", "--out", "--environment"},
      {"lte_render room.glb --out link.png --environment sky.png", "--out", "--environment"},
      {"lte_render room.glb --out a.png --integrator network --checkpoint tiny.safetensors --json "
       "twin.safetensors",
       "--json", "--checkpoint"},
      {"lte_render room.glb --validate-only --json room.glb", "--json", "SCENE"},
      {"lte_eval --split test --data homes --json houses/dataset.json", "--json", "--data"},
      {"lte_eval --split test --data houses --json homes/scenes/test0.safetensors", "--json",
       "--data"},
      {"lte_eval --split test --checkpoint tiny.safetensors --json tiny.safetensors", "--json",
       "--checkpoint"},
      {"lte_eval --split test --data homes --report r --json r/report.html", "--json", "--report"},
      {"lte_eval --fit-baselines homes --out homes/dataset.json", "--out", "--fit-baselines"},
      {"lte_eval --split test --data homes --baselines camera.json --json camera.json", "--json",
       "--baselines"},
      {"lte_eval --split test --config camera.json --json camera.json", "--json", "--config"},
      {"lte_bench pathtrace --scene room.glb --json room.glb", "--json", "--scene"},
      {"lte_bench pareto --checkpoint tiny.safetensors --json twin.safetensors", "--json",
       "--checkpoint"},
      {"lte_export --checkpoint tiny.safetensors --out tiny.safetensors", "--out", "--checkpoint"},
      {"lte_export --checkpoint tiny.safetensors --out twin.safetensors", "--out", "--checkpoint"},
      {"lte_export --bf16 --checkpoint tiny.safetensors --out tiny.safetensors", "--out",
       "--checkpoint"},
  };
  const auto before = folder_files(".");
  for (const Case& c : cases) {
    SCOPED_TRACE(c.line);
    expect_one_line(run_line(c.line), 1, {c.first, c.second, "name another file"});
    EXPECT_EQ(folder_files("."), before);
  }
}

TEST_F(InferFiles, FilesThatASceneNamesAreInputs) {
  const auto before = folder_files(".");
  expect_one_line(
      run_line("lte_render red.obj --environment 1,1,1 --integrator path --spp 1 --size "
               "8x8 --quiet --out a.png --json red.mtl"),
      1, {"--json", "input"});
  EXPECT_EQ(folder_files("."), before);
}

TEST(InferFlags, WhatIsNoNumberIsRefusedByEveryFlag) {
  test::expect_numbers_refused(
      [](CLI::App& app) {
        static RenderRequest request;
        add_render_options(app, &request);
      },
      {"--seed", "--spp", "--threads"});
  test::expect_numbers_refused(
      [](CLI::App& app) {
        static EvalRequest request;
        add_eval_options(app, &request);
      },
      {"--scene-points", "--resamples"});
  test::expect_numbers_refused(
      [](CLI::App& app) {
        static bench::BenchRequest request;
        bench::add_bench_options(app, &request);
      },
      {"--repeats", "--queries", "--reference-spp", "--views"});
}

}  // namespace
}  // namespace lte::infer
