// Tools as their users run them: by a command line, with an exit code and what they print.
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "lte/scene/export.h"
#include "tests/infer/fixture.h"
#include "tests/support/scenes.h"

namespace lte::infer {

struct Outcome {
  int code = -1;
  std::string text;  ///< both streams
};

inline Outcome run_tool(const std::string& tool, const std::string& arguments) {
  const std::string command =
      std::string(LTE_BINARY_DIR) + "/bin/" + tool + " " + arguments + " --threads 1 2>&1";
  Outcome out;
  std::FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return out;
  char buffer[4096];
  for (size_t n; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.text.append(buffer, n);
  const int status = pclose(pipe);
  out.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return out;
}

/// A failure that a user can act on: this exit code, one line, and these words in it.
inline void expect_failure(const Outcome& run, int code,
                           const testing::Matcher<std::string>& words) {
  EXPECT_EQ(run.code, code) << run.text;
  EXPECT_THAT(run.text, words);
  EXPECT_EQ(std::count(run.text.begin(), run.text.end(), '\n'), 1) << run.text;
}

class Tools : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TempDir();
    scene::Scene room = test::furnished_room();
    room.cameras.push_back({"inside", {2, 1.6f, 2.8f}, {2, 1, 0}, {0, 1, 0}, 70});
    room.cameras.push_back({"outside", {9, 2, 2.8f}, {2, 1, 0}, {0, 1, 0}, 60});
    scene::write_glb(*folder_ / "room.glb", room);
    scene::Scene dark = test::lit_floor();
    for (scene::Material& material : dark.materials) material.emission = {};
    for (scene::Instance& instance : dark.instances) instance.light_group = scene::kNone;
    dark.light_groups.clear();
    scene::write_glb(*folder_ / "dark.glb", dark);
    test::save_tiny_model(*folder_ / "tiny.safetensors");
    test::write_random_dataset(*folder_ / "data");
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::string at(const std::string& name) { return (*folder_ / name).string(); }
  static Outcome render(const std::string& rest) {
    return run_tool("lte_render", at("room.glb") + " --quiet --size 24x16" +
                                      test::network_flags(at("tiny.safetensors"), rest) + rest);
  }
  static Outcome eval(const std::string& rest) {
    return run_tool("lte_eval", "--quiet --checkpoint " + at("tiny.safetensors") + " --data " +
                                    at("data") + " " + rest);
  }
  inline static test::TempDir* folder_ = nullptr;
};

}  // namespace lte::infer
