#include "infer/view/replies.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "infer/view/session_scene.h"
#include "tests/infer/fixture.h"
#include "tests/infer/view/fake_pages.h"

namespace lte::infer::view {
namespace {

using nlohmann::json;

/// A chair of two parts that the file places together, beside the floor and the light.
scene::Scene with_chair() {
  scene::Scene scene = test::lit_floor();
  scene::Instance part = scene.instances[0];
  part.to_world.m[1][3] = 0.5f;
  scene.instances.push_back(part);
  scene.instances.push_back(part);
  return scene;
}

TEST(Replies, ListTheSceneAsItIsSet) {
  Session session(with_chair(), std::nullopt);
  const SceneDescription scene = describe_scene(*session.state(), list_objects(*session.state()));
  ASSERT_EQ(scene.objects.size(), 3u);
  EXPECT_EQ(scene.objects[2].instances.size(), 2u);
  const std::vector<PageEdit> edits{LightSetting{0, 0.25f, {1, 0.5f, 0.5f}, {}},
                                    ObjectSetting{2, {{0.5f, 0, 0}, 90, 1}},
                                    MaterialSetting{0, {0.25f, 0.5f, 0.75f}}};
  session.apply(session_edits(edits, scene));
  const std::vector<PageEdit> now = settings_of(*session.state(), scene);
  const json reply = json::parse(scene_reply(scene, now, {true, false}));
  EXPECT_EQ(reply.at("lights").at(0).at("gain"), 0.25);
  EXPECT_EQ(reply.at("lights").at(0).at("color"), json({1.0, 0.5, 0.5}));
  EXPECT_EQ(reply.at("lights").at(0).at("sort"), "surface");
  EXPECT_EQ(reply.at("materials").at(0).at("albedo"), json({0.25, 0.5, 0.75}));
  EXPECT_NEAR(reply.at("objects").at(2).at("turn").get<double>(), 90, 1e-3);
  EXPECT_NEAR(reply.at("objects").at(2).at("move").at(0).get<double>(), 0.5, 1e-5);
  EXPECT_TRUE(reply.at("objects").at(1).at("shines"));
  EXPECT_TRUE(reply.at("undo"));
  EXPECT_FALSE(reply.at("redo"));
  // All parts of an object have moved.
  const auto instances = session.state()->instances();
  EXPECT_EQ(instances[2].to_world.m, instances[3].to_world.m);
}

TEST(Replies, NumbersThatTheSceneLacksAreRefused) {
  const Session session(test::lit_floor(), std::nullopt);
  const SceneDescription scene = describe_scene(*session.state(), list_objects(*session.state()));
  for (const PageEdit& edit :
       {PageEdit(LightSetting{1, 1, {1, 1, 1}, {}}), PageEdit(MaterialSetting{99, {}}),
        PageEdit(ObjectSetting{2, {}}), PageEdit(LightSetting{0, 1, {1, 1, 1}, Vec3{1, 1, 1}})})
    EXPECT_THROW(session_edits(std::span(&edit, 1), scene), Error);
}

TEST(Replies, NamesThatAreNoTextAreMended) {
  SceneDescription scene;
  scene.name = "\xff\xfe";
  EXPECT_NO_THROW(json::parse(scene_reply(scene, {}, {})));
}

TEST(Replies, AFrameIsHeaderAndBytes) {
  PictureHeader header;
  header.picture = 7;
  header.handled[3] = {12, 11};
  header.answered_by = "gather";
  const std::string frame = picture_frame(header, std::string("\0\xffjpeg", 6));
  EXPECT_EQ(test::frame_header(frame).at("picture"), 7);
  EXPECT_EQ(test::frame_header(frame).at("answered_by"), "gather");
  EXPECT_EQ(test::frame_header(frame).at("handled").at("3"), json({12, 11}));
  EXPECT_EQ(test::frame_bytes(frame), std::string("\0\xffjpeg", 6));
  EXPECT_TRUE(test::frame_header(frame).at("check").is_null());
  header.check.emplace();
  header.check->paths = 8192;
  header.check->whole = {
      .ratio = 0.5, .standard_error = 0.02, .share = 1, .centre = {}, .off = true};
  header.check->regions = {header.check->whole};
  const json check = test::frame_header(picture_frame(header, "jpeg")).at("check");
  EXPECT_EQ(check.at("whole").at("ratio"), 0.5);
  EXPECT_EQ(check.at("note"), "the gathered indirect light is 0.50 (+-0.02) of the traced");
  header.check->whole.off = header.check->regions[0].off = false;
  EXPECT_EQ(test::frame_header(picture_frame(header, "jpeg")).at("check").at("note"), "");
}

}  // namespace
}  // namespace lte::infer::view
