// The command line of lte_render: flags that change nothing are noted, every flag has its place in
// the help, and a picture without a name is named after its scene.
#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/render/render_request.h"
#include "infer/render/unused_flags.h"

namespace lte::infer {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class RenderFlags : public testing::Test {
 protected:
  RenderFlags() { add_render_options(app_, &request_); }
  void parse(std::vector<std::string> words) {
    std::reverse(words.begin(), words.end());
    app_.parse(words);
  }
  std::string notes() {
    testing::internal::CaptureStderr();
    note_unused_flags(request_);
    return testing::internal::GetCapturedStderr();
  }

  CLI::App app_;
  RenderRequest request_;
};

TEST_F(RenderFlags, ThatAReferenceNeverReadsAreNoted) {
  parse({"room.glb", "--mode", "reference", "--quality", "draft", "--spp", "8", "--aa", "4"});
  EXPECT_THAT(notes(), AllOf(HasSubstr("--quality is ignored: a reference takes --spp"),
                             HasSubstr("--aa is ignored"), Not(HasSubstr("--spp is ignored"))));
}

TEST_F(RenderFlags, ThatAreReadAreNotNoted) {
  parse({"room.glb", "--quality", "draft", "--spp", "8", "--aa", "4", "--tone", "filmic"});
  EXPECT_THAT(notes(), IsEmpty());
}

TEST_F(RenderFlags, PathsThatNoPixelNeedsAreNoted) {
  parse({"room.glb", "--spp", "128"});
  const auto note = [&](int64_t traced) {
    testing::internal::CaptureStderr();
    note_unused_paths(request_, traced);
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_THAT(note(0), HasSubstr("--spp 128 is ignored"));
  EXPECT_THAT(note(7), IsEmpty());
}

TEST_F(RenderFlags, APictureIsNamedAfterItsScene) {
  parse({"scenes/room.v2.glb"});
  EXPECT_EQ(request_.out, "room.v2.png");
  EXPECT_TRUE(request_.named_by_scene);
}

TEST_F(RenderFlags, PicturesOfSeveralCamerasAreNumbered) {
  parse({"room.glb", "--turntable", "4"});
  EXPECT_EQ(request_.out, "room_%02d.png");
}

TEST_F(RenderFlags, AllHaveAPlaceInTheHelp) {
  for (const CLI::Option* option : app_.get_options()) {
    if (option->get_lnames().empty() || option->get_lnames()[0] == "help") continue;
    EXPECT_NE(option->get_group(), "Options") << option->get_name();
  }
}

}  // namespace
}  // namespace lte::infer
