// lte_render --output attention, as its users ask for it.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lte/base/file.h"
#include "lte/image/exr.h"
#include "lte/image/png.h"
#include "tests/infer/tools_fixture.h"

namespace lte::infer {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string attention(const std::string& rest) { return "--output attention " + rest; }

TEST_F(Tools, AttentionIsAPictureWithItsNumbers) {
  const Outcome done = render(attention("--point 2,0.02,1.2 --block down0.0 --head 0 --out " +
                                        at("attention.exr") + " --json " + at("attention.json")));
  ASSERT_EQ(done.code, 0) << done.text;
  const nlohmann::json told =
      nlohmann::json::parse(read_file(at("attention.json"))).at("attention");
  EXPECT_EQ(told.at("block"), "down0.0");
  EXPECT_EQ(told.at("head"), 0);
  EXPECT_NEAR(told.at("point").at(1).get<double>(), 0, 1e-5) << "on the floor";
  EXPECT_GT(told.at("normal").at(1), 0.99) << "on the side that the camera sees";
  EXPECT_GT(told.at("entropy"), 0);
  const image::Image values = image::read_exr(at("attention.exr"), "attention");
  ASSERT_EQ(values.channels, 1);
  float most = 0;
  for (const float value : values.pixels) most = std::max(most, value);
  EXPECT_GT(most, 0);
  EXPECT_LE(most, told.at("most").get<float>() * 1.0001f);
  const Outcome png = render(attention("--point 2,0.02,1.2 --out " + at("attention.png")));
  ASSERT_EQ(png.code, 0) << png.text;
  EXPECT_GT(std::filesystem::file_size(at("attention.png")), 200u);
}

TEST_F(Tools, AttentionThatCannotBeShownIsRefusedInALine) {
  const auto refused = [](const std::string& flags, const testing::Matcher<std::string>& words) {
    const std::string file = at("refused.png");
    expect_failure(render(flags + " --out " + file), 1, words);
    EXPECT_FALSE(std::filesystem::exists(file)) << flags;
  };
  refused(attention(""), HasSubstr("--point X,Y,Z"));
  refused(attention("--point 2,30,1"),
          AllOf(HasSubstr("--point 2,30,1"), HasSubstr("no surface within")));
  refused(attention("--point 2,0,1 --block up9.9"),
          AllOf(HasSubstr("--block up9.9"), HasSubstr("decoder, decoder.0 to")));
  refused(attention("--point 2,0,1 --block down0.0 --head 77"),
          AllOf(HasSubstr("--head 77"), HasSubstr("block down0.0 has")));
  refused(attention("--point 2,0,1 --head 1"), HasSubstr("the decoder has none"));
  refused(attention("--point 2,0,1 --mode reference"), HasSubstr("--mode neural"));
  refused("--point 2,0,1", HasSubstr("--output attention"));
  expect_failure(render(attention("--point 2,0 --out " + at("refused.png"))), 2,
                 HasSubstr("--point"));
}

}  // namespace
}  // namespace lte::infer
