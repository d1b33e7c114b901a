// What pages are told of attention, against the scene that they see.
#include "infer/view/attention_view.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/infer/session/session_fixture.h"
#include "tests/support/scenes.h"
#include "tests/support/temp_dir.h"

namespace lte::infer::view {
namespace {

using nlohmann::json;

LookInside floor_point() {
  LookInside look;
  look.position = {2, 0, 1.2f};
  look.normal = {0, 1, 0};
  return look;
}

class AttentionOfARoom : public testing::Test {
 protected:
  AttentionOfARoom() : session_(test::furnished_room(), session_test::network()) {}

  json ask(const LookInside& look) {
    return json::parse(view_.answer(*session_.state(), session_test::camera(), look));
  }
  std::string refusal(const LookInside& look) {
    return test::error_of([&] { ask(look); });
  }

  Session session_;
  AttentionView view_;
};

Vec3 place(const json& dot) { return {dot.at(0), dot.at(1), dot.at(2)}; }

TEST_F(AttentionOfARoom, TheDecodersDotsLieOnWhatTheCameraSees) {
  const json told = ask(floor_point());
  EXPECT_EQ(told.at("type"), "attention");
  EXPECT_GT(told.at("dots").size(), 2u);
  EXPECT_GT(told.at("most").get<double>(), 1);
  const StatePtr state = session_.state();
  const Vec3 eye = session_test::camera().origin;
  for (const json& dot : told.at("dots")) {
    const Vec3 way = place(dot) - eye;
    const pathtrace::Hit hit = state->bvh().intersect({eye, way, 0, INFINITY});
    ASSERT_TRUE(hit.valid());
    EXPECT_NEAR(hit.t, 1, 0.01) << dot;
    EXPECT_LE(dot.at(3), told.at("most"));
  }
}

TEST_F(AttentionOfARoom, BlocksHaveHeadsAndEntropies) {
  const json told = ask(floor_point());
  ASSERT_FALSE(told.at("blocks").empty());
  const json& first = told.at("blocks").at(0);
  EXPECT_EQ(first.at("name"), "down0.0");
  EXPECT_GT(first.at("entropy"), 0);
  EXPECT_LE(first.at("entropy"), 1);
  LookInside look = floor_point();
  look.block = "down0.0";
  look.head = 0;
  const json block = ask(look);
  EXPECT_EQ(block.at("block"), "down0.0");
  EXPECT_GT(block.at("dots").size(), told.at("dots").size()) << "all latents that are seen";
  EXPECT_LT(length(place(block.at("latent")) - look.position), 2);
}

TEST_F(AttentionOfARoom, AnEditIsSeenByTheNextQuestion) {
  const json before = ask(floor_point());
  const InstanceInfo object = session_.state()->instances().front();
  Affine moved = object.to_world;
  moved.m[0][3] += 0.25f;
  session_.apply(MoveInstance{object.id, moved});
  EXPECT_NE(ask(floor_point()).at("dots"), before.at("dots"));
  session_.undo();
  EXPECT_EQ(ask(floor_point()), before);
}

TEST_F(AttentionOfARoom, RefusesInOneLine) {
  LookInside far = floor_point(), block = floor_point(), head = floor_point();
  far.position = {2, 40, 1};
  block.block = "sideways";
  head.block = "down0.0";
  head.head = 500;
  EXPECT_THAT(refusal(far), testing::HasSubstr("no surface near"));
  EXPECT_THAT(refusal(block), testing::AllOf(testing::HasSubstr("no block \"sideways\""),
                                             testing::HasSubstr("decoder.0 to decoder.")));
  EXPECT_THAT(refusal(head), testing::HasSubstr("head 500: block down0.0 has"));
  const Session traced(test::lit_floor(), std::nullopt);
  EXPECT_THAT(test::error_of([&] {
                AttentionView().answer(*traced.state(), test::downward_camera(), floor_point());
              }),
              testing::HasSubstr("no attention"));
}

}  // namespace
}  // namespace lte::infer::view
