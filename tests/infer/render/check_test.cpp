// Checked pictures: a model that is made wrong is said to be, a right answer is not, and no pixel
// depends on the check.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "infer/renderer/renderer.h"
#include "lte/base/file.h"
#include "lte/base/safetensors.h"
#include "tests/infer/tools_fixture.h"

namespace lte::infer {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kShipped = LTE_SOURCE_DIR "/assets";

/// The shipped model with the last layer of its decoder times `factor`.
void write_scaled_model(const std::string& path, float factor) {
  const SafetensorsFile shipped(std::string(kShipped) + "/models/lte.safetensors");
  SafetensorsWriter out;
  for (const auto& [key, value] : shipped.metadata()) {
    if (key != kChecksumKey) out.set_metadata(key, value);
  }
  std::vector<std::vector<float>> scaled;
  for (const auto& [name, tensor] : shipped.tensors()) {
    if (!name.starts_with("decoder.head.output.")) {
      out.add(name, tensor);
      continue;
    }
    const std::span<const float> values = shipped.values<float>(name, tensor.shape);
    scaled.emplace_back(values.begin(), values.end());
    for (float& value : scaled.back()) value *= factor;
    out.add(name, tensor.shape, scaled.back().data());
  }
  out.write(path);
}

class CheckedPictures : public Tools {
 protected:
  static Outcome living_room(const std::string& rest) {
    return run_tool("lte_render", std::string(kShipped) + "/scenes/living_room.glb" +
                                      " --size 128x96 --quality preview --json " +
                                      at("check.json") + " --out " + at("check.png") + " " + rest);
  }
  static nlohmann::json found() {
    return nlohmann::json::parse(read_file(at("check.json"))).at("check");
  }
};

TEST_F(CheckedPictures, AModelThatIsMadeWrongIsSaidAndTheShippedOneIsNot) {
  const std::string wrong = at("wrong.safetensors");
  write_scaled_model(wrong, -64.0f);
  const Outcome said = living_room("--integrator network --checkpoint " + wrong);
  ASSERT_EQ(said.code, 0) << said.text;
  EXPECT_THAT(said.text, AllOf(HasSubstr("warning"),
                               HasSubstr("check.png: the network's indirect "
                                         "light is "),
                               HasSubstr(" of the traced")));
  EXPECT_TRUE(found().at("whole").at("off").get<bool>() || found().at("fault").is_object());
  const Outcome right = living_room("--integrator network");
  ASSERT_EQ(right.code, 0) << right.text;
  EXPECT_FALSE(found().at("whole").at("off").get<bool>()) << found().dump();
  EXPECT_NEAR(found().at("whole").at("ratio").get<double>(), 1, 0.05);
  EXPECT_THAT(right.text, Not(HasSubstr("of the traced")));
}

TEST_F(CheckedPictures, GatheredLightPasses) {
  const Outcome run = living_room("--integrator gather");
  ASSERT_EQ(run.code, 0) << run.text;
  EXPECT_THAT(run.text, Not(HasSubstr("of the traced"))) << found().dump();
  EXPECT_NEAR(found().at("whole").at("ratio").get<double>(), 1, 0.05);
}

TEST_F(CheckedPictures, TheCheckChangesNoPixel) {
  for (const std::string how : {"--integrator network", "--integrator gather"}) {
    ASSERT_EQ(living_room(how).code, 0);
    const std::string checked = read_file(at("check.png"));
    EXPECT_TRUE(found().is_object());
    ASSERT_EQ(living_room(how + " --set check=off").code, 0);
    EXPECT_EQ(read_file(at("check.png")), checked) << how;
    EXPECT_FALSE(found().is_object());
  }
  ASSERT_EQ(living_room("--integrator path").code, 0);
  EXPECT_FALSE(found().is_object()) << "paths are what others are held against";
}

TEST_F(CheckedPictures, EachOfSeveralPicturesIsChecked) {
  const Outcome run =
      run_tool("lte_render", at("room.glb") + " --size 48x32 --quality draft --camera all" +
                                 " --out " + at("view_%d.png") + " --json " + at("views.json"));
  ASSERT_EQ(run.code, 0) << run.text;
  const nlohmann::json json = nlohmann::json::parse(read_file(at("views.json")));
  for (const nlohmann::json& picture : json.at("pictures"))
    EXPECT_TRUE(picture.at("check").is_object());
  EXPECT_GT(json.at("seconds").at("check").get<double>(), 0);
}

}  // namespace
}  // namespace lte::infer
