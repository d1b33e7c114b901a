// Videos: what goes to ffmpeg, and what happens without it.
#include "infer/render/video.h"

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "infer/render/render_command.h"
#include "lte/base/file.h"
#include "lte/image/png.h"
#include "lte/scene/export.h"
#include "tests/support/command_line.h"
#include "tests/support/folder_files.h"
#include "tests/support/in_folder.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;
using test::CommandOutcome;
using test::expect_one_line;
using testing::HasSubstr;

class Videos : public test::InFolder {
 protected:
  Videos() : path_(std::getenv("PATH") != nullptr ? std::getenv("PATH") : "") {
    scene::Scene room = test::furnished_room();
    room.cameras.push_back({"a", {2, 1.6f, 2.8f}, {2, 1, 0}, {0, 1, 0}, 70});
    scene::write_glb("room.glb", room);
  }
  ~Videos() override { setenv("PATH", path_.c_str(), 1); }

  static CommandOutcome render(const std::string& rest, const std::string& size = "24x16") {
    std::vector<std::string> arguments{"room.glb", "--quiet", "--size", size};
    for (const std::string& word : CLI::detail::split(rest, ' ')) arguments.push_back(word);
    CLI::App app{"", "lte_render"};
    RenderRequest request;
    add_render_options(app, &request);
    return test::run_command(app, arguments, [&] { run_render(request); });
  }
  /// A program `ffmpeg` of this text alone on PATH, beside the system's own tools.
  static void put_ffmpeg(const std::string& script) {
    fs::create_directory("bin");
    write_file("bin/ffmpeg", "#!/bin/sh\n" + script);
    fs::permissions("bin/ffmpeg", fs::perms::owner_all);
    setenv("PATH", (fs::absolute("bin").string() + ":/bin:/usr/bin").c_str(), 1);
  }
  /// Copies what comes in into the last word, without its "file:", and its words beside it.
  static constexpr const char* kCopy =
      "for last; do :; done\necho \"$@\" > words.txt\ncat > \"${last#file:}\"\n";

 private:
  std::string path_;
};

TEST_F(Videos, HasTheBytesOfThePicturesInTheirOrder) {
  put_ffmpeg(kCopy);
  const std::string turn = "--turntable 3 --camera a --quality draft ";
  ASSERT_EQ(render(turn + "--out v.mp4 --set fps=30 --json v.json").code, 0);
  ASSERT_EQ(render(turn + "--out p_%d.png").code, 0);
  std::string expected;
  for (const char* name : {"p_0.png", "p_1.png", "p_2.png"}) {
    for (const uint8_t byte : image::to_bytes(image::read_png(name)))
      expected += static_cast<char>(byte);
  }
  EXPECT_EQ(read_file("v.mp4"), expected);
  const std::string words = read_file("words.txt");
  for (const char* part : {"-video_size 24x16", "-framerate 30", "libx264", "-f mp4"})
    EXPECT_THAT(words, HasSubstr(part));
  const nlohmann::json pictures = nlohmann::json::parse(read_file("v.json")).at("pictures");
  ASSERT_EQ(pictures.size(), 3u);
  EXPECT_EQ(pictures[2]["out"], "v.mp4#2");
  EXPECT_EQ(pictures[2]["exposure"], pictures[0]["exposure"]);
}

TEST_F(Videos, TakesATimeForEachPictureAndGreyDepth) {
  put_ffmpeg(kCopy);
  ASSERT_EQ(render("--turntable 2 --camera a --time 20ms --out v.webm").code, 0);
  EXPECT_EQ(read_file("v.webm").size(), size_t{2} * 24 * 16 * 3);
  ASSERT_EQ(render("--turntable 2 --camera a --output depth --out d.gif").code, 0);
  EXPECT_EQ(read_file("d.gif").size(), size_t{2} * 24 * 16 * 3);
}

TEST_F(Videos, WithoutFfmpegOneLineSaysSoBeforeAnyWork) {
  fs::create_directory("empty");
  setenv("PATH", fs::absolute("empty").c_str(), 1);
  const auto before = test::folder_files(".");
  expect_one_line(render("--turntable 3 --out v.mp4"), 1,
                  {"v.mp4: a video needs the program ffmpeg", "turn_%03d.png"});
  EXPECT_EQ(test::folder_files("."), before);
}

TEST_F(Videos, AnEncoderThatFailsLeavesItsWordsAndNoFile) {
  put_ffmpeg("echo 'Unknown encoder libx264' >&2\nexit 1\n");
  expect_one_line(render("--turntable 2 --quality draft --out v.mp4"), 1,
                  {"v.mp4: ffmpeg failed: Unknown encoder libx264"});
  put_ffmpeg("cat > /dev/null\nkill -9 $$\n");
  expect_one_line(render("--turntable 2 --quality draft --out v.mp4"), 1,
                  {"v.mp4: ffmpeg failed: it said nothing"});
  for (const auto& [name, text] : test::folder_files("."))
    EXPECT_THAT(name, testing::Not(HasSubstr("v.mp4")));
}

TEST_F(Videos, WhatMakesNoVideoIsRefused) {
  put_ffmpeg(kCopy);
  expect_one_line(render("--out v.mp4"), 1, {"v.mp4: a video needs several pictures"});
  expect_one_line(render("--turntable 2 --out v.mp4 --resume"), 1, {"--resume"});
  expect_one_line(render("--turntable 2 --out v.mp4", "25x16"), 1, {"even sides", "25x16"});
  expect_one_line(render("--turntable 2 --out v_%d.png --set fps=30"), 1, {"fps"});
  EXPECT_EQ(render("--turntable 2 --out v.avi").code, 2);
}

TEST_F(Videos, FfmpegEncodesAllPictures) {
  if (std::system("ffmpeg -version > version.txt 2>&1") != 0) GTEST_SKIP() << "no ffmpeg";
  for (const char* name : {"v.mp4", "v.webm", "v.gif"}) {
    ASSERT_EQ(render(std::string("--turntable 3 --quality draft --out ") + name, "64x48").code, 0);
    const std::string decode =
        std::string("ffmpeg -v error -i ") + name + " -f rawvideo -pix_fmt rgb24 -y frames.raw";
    ASSERT_EQ(std::system(decode.c_str()), 0);
    EXPECT_EQ(fs::file_size("frames.raw"), size_t{3} * 64 * 48 * 3) << name;
  }
}

}  // namespace
}  // namespace lte::infer
