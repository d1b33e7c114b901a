// lte_probe in this process: its table, its modes, and what it refuses.
#include <cmath>
#include <filesystem>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "infer/probe/gathered_probe.h"
#include "infer/probe/probe_command.h"
#include "lte/base/file.h"
#include "lte/base/random.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/scene/export.h"
#include "tests/infer/fixture.h"
#include "tests/support/command_line.h"
#include "tests/support/folder_files.h"
#include "tests/support/in_folder.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;
using test::CommandOutcome;
using test::expect_one_line;

class ProbeTool : public test::InFolder {
 protected:
  ProbeTool() {
    scene::write_glb("floor.glb", test::lit_floor());
    scene::write_glb("room.glb", test::furnished_room());
    test::save_tiny_model("tiny.safetensors", {.light_input = nn::LightInput::Traced});
    test::write_text("points.csv", "px,py,pz,nx,ny,nz\n0.5,0,0,0,1,0\n-1,0,0.50,0,2,0\n");
  }
  static CommandOutcome probe(const std::string& rest, const std::string& quiet = "--quiet") {
    CLI::App app{"", "lte_probe"};
    ProbeRequest request;
    add_probe_options(app, &request);
    return test::run_command(app, split(quiet + " " + rest), [&] { run_probe(request); });
  }
  /// By rays that read the network's light.
  static CommandOutcome ask(const std::string& rest, const std::string& quiet = "--quiet") {
    return probe("--integrator network --checkpoint tiny.safetensors " + rest, quiet);
  }
  /// Header, then rows of numbers.
  struct Table {
    std::string header;
    std::vector<std::vector<double>> rows;
  };
  static Table table(const std::string& path) {
    std::istringstream text(read_file(path));
    Table out;
    std::getline(text, out.header);
    for (std::string line; std::getline(text, line);) {
      std::istringstream fields(line);
      out.rows.emplace_back();
      for (std::string field; std::getline(fields, field, ',');)
        out.rows.back().push_back(std::stod(field));
    }
    return out;
  }
};

constexpr size_t kTotal = 6, kDirect = 9, kStderr = 12, kRays = 15, kExpected = 16;

TEST_F(ProbeTool, GatherAndReferenceWriteTheSameColumns) {
  ASSERT_EQ(probe("floor.glb --points points.csv --out n.csv --spp 256 --json n.json").code, 0);
  ASSERT_EQ(probe("floor.glb --points points.csv --out r.csv --integrator path --spp 1024").code,
            0);
  const Table neural = table("n.csv"), reference = table("r.csv");
  EXPECT_EQ(neural.header,
            "px,py,pz,nx,ny,nz,total_r,total_g,total_b,direct_r,direct_g,direct_b,stderr_r,"
            "stderr_g,stderr_b,rays,expected_error");
  EXPECT_EQ(neural.header, reference.header);
  ASSERT_EQ(neural.rows.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    const std::vector<double>&n = neural.rows[i], &r = reference.rows[i];
    ASSERT_EQ(n.size(), 17u);
    // The floor alone reflects, so all of its light is direct.
    for (size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(n[kDirect + c], r[kDirect + c], 6 * (n[kStderr + c] + r[kStderr + c]));
      EXPECT_NEAR(r[kTotal + c], r[kDirect + c], 1e-6);
      EXPECT_EQ(n[kTotal + c], n[kDirect + c]);
    }
    EXPECT_EQ(n[kRays], 512) << "as many for either kind";
    EXPECT_GE(r[kRays], 1024);
    const double noise = std::hypot(r[kStderr], r[kStderr + 1], r[kStderr + 2]) / std::sqrt(3.0);
    EXPECT_NEAR(r[kExpected], noise, 1e-6 * noise) << "of paths: their standard error";
    EXPECT_GT(n[kExpected], 0);
  }
  EXPECT_EQ(nlohmann::json::parse(read_file("n.json")).at("points"), 2);
}

TEST_F(ProbeTool, WarnsOfUntrainedLightThatTheNetworkIsToldOf) {
  test::save_tiny_model("tiny.safetensors", {.scene_points = 400, .pruned = true});
  const std::string line = "room.glb --points in.csv --out out.csv --environment 1,1,1 ";
  test::write_text("in.csv", "px,py,pz,nx,ny,nz\n1,0,0.2,0,1,0\n");
  const std::string unknown = "the model was trained without such light";
  const auto said = [&](const std::string& flags) {
    const CommandOutcome run = ask(line + flags, "--threads 1");
    EXPECT_EQ(run.code, 0) << run.err;
    return run.err + run.out;
  };
  EXPECT_THAT(said(""), testing::Not(testing::HasSubstr(unknown)));
  EXPECT_THAT(said("--set prune=off"), testing::HasSubstr(unknown));
}

/// The numbers below the heading of a CSV file.
std::vector<double> numbers(const std::string& csv) {
  std::vector<double> out;
  std::istringstream in(csv.substr(csv.find('\n') + 1));
  for (std::string line; std::getline(in, line);) {
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) out.push_back(std::stod(cell));
  }
  return out;
}

TEST_F(ProbeTool, ASkyOutsideAClosedRoomChangesNoAnswer) {
  test::save_tiny_model(
      "tiny.safetensors",
      {.scene_points = 400, .pruned = true, .suns = true, .light_input = nn::LightInput::Traced});
  test::write_text("in.csv", "px,py,pz,nx,ny,nz\n1,0,0.2,0,1,0\n2,0,2.8,0,1,0\n");
  const std::string line = "room.glb --points in.csv ";
  const auto by = [&](const std::string& flags) {
    EXPECT_EQ(ask(line + "--out by.csv --json by.json " + flags).code, 0) << flags;
    return read_file("by.csv");
  };
  const std::string dim = by("--environment 1,1,1");
  EXPECT_EQ(nlohmann::json::parse(read_file("by.json"))["left_out_lights"],
            nlohmann::json({"environment"}));
  // Which light a sample goes to depends on the sky; how much light there is does not.
  const std::vector<double> expected = numbers(dim),
                            found = numbers(by("--environment 1000,1000,1000"));
  ASSERT_EQ(found.size(), expected.size());
  ASSERT_GT(found.size(), 20u);
  constexpr size_t kColumns = 17, kErrors = 12;  // their own noise is larger
  for (size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], (i % kColumns < kErrors ? 0.02 : 0.3) * expected[i]) << i;
  EXPECT_NE(by("--environment 1000,1000,1000 --set prune=off"),
            by("--environment 1,1,1 --set prune=off"));
  EXPECT_TRUE(nlohmann::json::parse(read_file("by.json"))["left_out_lights"].empty());
  test::write_text("out.csv", "px,py,pz,nx,ny,nz\n1,0,0.2,0,-1,0\n");
  const CommandOutcome outside =
      ask("room.glb --points out.csv --environment 1,1,1 --out o.csv", "--threads 1");
  EXPECT_THAT(outside.err + outside.out, testing::HasSubstr("does not reach the points ("));
}

TEST_F(ProbeTool, ASavedEmbeddingGivesTheSameAnswers) {
  ASSERT_EQ(ask("room.glb --points points.csv --out a.csv --save-embedding room.emb").code, 0);
  ASSERT_EQ(ask("room.glb --points points.csv --out b.csv --embedding room.emb").code, 0);
  EXPECT_EQ(read_file("a.csv"), read_file("b.csv"));
  expect_one_line(ask("floor.glb --points points.csv --out c.csv --embedding room.emb"), 1,
                  {"room.emb", "another scene geometry"});
  EXPECT_FALSE(fs::exists("c.csv"));
}

/// Against many paths, in units of what is expected: two thirds within 1, 95 % within 2.
TEST_F(ProbeTool, ExpectedErrorsAreThoseThatAreMade) {
  std::string points = "px,py,pz,nx,ny,nz\n";
  Rng rng(4);
  for (int i = 0; i < 150; ++i) {  // on the floor between the boxes, on walls and in mid-air
    const std::string x = std::to_string(1.4f + 0.9f * rng.uniform());
    const std::string h = std::to_string(0.2f + 2 * rng.uniform());
    const std::string z = std::to_string(0.1f + 2.8f * rng.uniform());
    points += i % 3 == 0   ? x + ",0," + z + ",0,1,0\n"
              : i % 3 == 1 ? "0," + h + "," + z + ",1,0,0\n"
                           : x + "," + h + "," + z + ",1,1,0\n";
  }
  test::write_text("many.csv", points);
  ASSERT_EQ(probe("room.glb --points many.csv --out g.csv").code, 0);
  ASSERT_EQ(
      probe("room.glb --points many.csv --out r.csv --integrator path --spp 8192 --seed 9").code,
      0);
  const Table gathered = table("g.csv"), reference = table("r.csv");
  int within_one = 0, within_two = 0;
  for (size_t i = 0; i < gathered.rows.size(); ++i) {
    double squares = 0;
    for (size_t c = 0; c < 3; ++c)
      squares += std::pow(gathered.rows[i][kTotal + c] - reference.rows[i][kTotal + c], 2) / 3;
    const double expected = std::hypot(gathered.rows[i][kExpected], reference.rows[i][kExpected]);
    within_one += std::sqrt(squares) <= expected ? 1 : 0;
    within_two += std::sqrt(squares) <= 2 * expected ? 1 : 0;
  }
  // More in a room as plain as this one: the share of what is unseen is that of harder ones.
  EXPECT_GT(within_one / 150.0, 0.6);
  EXPECT_LT(within_one / 150.0, 0.92);
  EXPECT_GT(within_two / 150.0, 0.92);
}

TEST_F(ProbeTool, TheFirstLineSaysWhoAnswers) {
  const auto said = [](const CommandOutcome& run) {
    EXPECT_EQ(run.code, 0) << run.err;
    return run.err + run.out;
  };
  const std::string line = "room.glb --points points.csv --out a.csv";
  EXPECT_THAT(said(probe(line, "--threads 1")),
              testing::HasSubstr("points.csv: indirect light by 256 rays a point that read "
                                 "path-traced light on surfaces"));
  EXPECT_THAT(said(ask(line, "--threads 1")), testing::HasSubstr("the network's light"));
  EXPECT_THAT(said(probe(line + " --integrator path", "--threads 1")),
              testing::HasSubstr("all light by paths"));
}

TEST_F(ProbeTool, WrongLightIsSaidUnlessTheCheckIsOff) {
  // An untrained network is off by far where most of the bounces are left to it.
  std::string rows = "px,py,pz,nx,ny,nz\n";
  for (int i = 0; i < 24; ++i)
    rows += concat(0.3 + 0.6 * (i % 6), ",2.5,", 0.4 + 0.7 * (i / 6), ",0,-1,0\n");
  test::write_text("ceiling.csv", rows);
  const std::string line = "room.glb --points ceiling.csv --json c.json --out a.csv";
  const CommandOutcome wrong = ask(line + " --set depth=20", "--threads 1");
  EXPECT_THAT(wrong.err + wrong.out, testing::HasSubstr("the network's indirect light is "));
  const nlohmann::json check = nlohmann::json::parse(read_file("c.json"))["check"];
  EXPECT_TRUE(check["whole"]["off"] || check["fault"].is_object()) << check.dump();
  const CommandOutcome unchecked = ask(line + " --set check=off", "--threads 1");
  EXPECT_THAT(unchecked.err + unchecked.out, testing::Not(testing::HasSubstr("of the traced")));
  EXPECT_EQ(nlohmann::json::parse(read_file("c.json"))["check"], false);
  const CommandOutcome right = probe(line, "--threads 1");
  EXPECT_THAT(right.err + right.out, testing::Not(testing::HasSubstr("of the traced")));
  EXPECT_NEAR(nlohmann::json::parse(read_file("c.json"))["check"]["whole"]["ratio"].get<double>(),
              1, 0.1);
}

TEST_F(ProbeTool, TheSameSeedGivesTheSameAnswers) {
  const std::string line = "room.glb --points points.csv --out ";
  ASSERT_EQ(ask(line + "a.csv --seed 5").code, 0);
  ASSERT_EQ(ask(line + "b.csv --seed 5").code, 0);
  ASSERT_EQ(ask(line + "c.csv --seed 6").code, 0);
  EXPECT_EQ(read_file("a.csv"), read_file("b.csv"));
  EXPECT_NE(read_file("a.csv"), read_file("c.csv"));
}

TEST_F(ProbeTool, BadInputIsOneLineAndWritesNothing) {
  test::write_text("bad.csv", "px,py,pz,nx,ny,nz\n0,0,x,0,1,0\n");
  test::write_text("empty.csv", "px,py,pz,nx,ny,nz\n");
  const auto before = test::folder_files(".");
  const auto refused = [&](const std::string& line, int code,
                           const std::vector<std::string>& words) {
    SCOPED_TRACE(line);
    expect_one_line(probe(line), code, words);
    EXPECT_EQ(test::folder_files("."), before);
  };
  refused("floor.glb --points bad.csv --out a.csv", 1, {"bad.csv: line 2, column pz"});
  refused("floor.glb --points empty.csv --out a.csv", 1, {"empty.csv: no points"});
  refused("floor.glb --points none.csv --out a.csv", 1, {"none.csv"});
  refused("none.glb --points points.csv --out a.csv", 1, {"none.glb"});
  refused("floor.glb --points points.csv --out points.csv", 1, {"--out", "--points"});
  refused("floor.glb --points points.csv --out no/a.csv", 1, {"no/a.csv"});
  refused("floor.glb --points points.csv", 1, {"--out"});
  refused("floor.glb --out a.csv", 1, {"--points"});
  const std::string line = "floor.glb --points points.csv --out a.csv ";
  refused(line + "--error 0.1", 1, {"--error goes with --integrator path"});
  refused(line + "--integrator path --embedding e", 1,
          {"--embedding goes with --integrator network"});
  refused(line + "--checkpoint tiny.safetensors", 1,
          {"--checkpoint goes with --integrator network"});
  refused(line + "--set scene_points=9", 1, {"--set scene_points"});
  refused(line + "--set detph=9", 1, {"did you mean depth?"});
  refused(line + "--integrator light", 2, {"--integrator"});
  EXPECT_EQ(probe("floor.glb --validate-only").code, 0);
  EXPECT_EQ(test::folder_files("."), before);
}

TEST_F(ProbeTool, WithoutLightEverythingIsBlack) {
  scene::Scene dark = test::lit_floor();
  for (scene::Material& material : dark.materials) material.emission = {};
  for (scene::Instance& instance : dark.instances) instance.light_group = scene::kNone;
  dark.light_groups.clear();
  scene::write_glb("dark.glb", dark);
  for (const std::string integrator : {"gather", "path"}) {
    ASSERT_EQ(probe("dark.glb --points points.csv --out d.csv --integrator " + integrator).code, 0);
    const Table rows = table("d.csv");
    for (size_t c = kTotal; c <= kExpected; ++c) EXPECT_EQ(rows.rows[1][c], 0);
  }
}

TEST(ProbeFlags, WhatIsNoNumberIsRefused) {
  test::expect_numbers_refused(
      [](CLI::App& app) {
        static ProbeRequest request;
        add_probe_options(app, &request);
      },
      {"--spp", "--error", "--seed"});
}

}  // namespace
}  // namespace lte::infer
