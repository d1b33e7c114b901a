// What a session's cameras see decides which light its network is told of: against renderers that
// leave the same light out, fresh sessions, and edits that let the light in.
#include <numeric>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/session/dimmable_picture.h"
#include "infer/session/session.h"
#include "tests/infer/renderer/two_rooms.h"
#include "tests/infer/session/session_fixture.h"

namespace lte::infer {
namespace {

using namespace session_test;
using test::TwoRooms;
using testing::ElementsAre;
using testing::IsEmpty;

runtime::Network pruned_network(bool suns = true) {
  return network(nn::LightInput::Traced, /*pruned=*/true, suns);
}

SessionSettings seen_from(std::vector<scene::Camera> cameras) {
  SessionSettings settings;
  settings.pictures = Method::Network;
  settings.cameras = std::move(cameras);
  return settings;
}

scene::Camera elsewhere_inside() { return {"", {3.7f, 1.2f, 4.6f}, {1, 1, 1}, {0, 1, 0}, 60}; }

/// Without sampled light.
std::vector<float> reflected(const Session& session, const scene::Camera& camera) {
  return session.state()->render(camera, picture(Output::Gi)).color.pixels;
}

double sum_of(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(LookFrom, ASkyOutsideARoomIsNoneOfItsLight) {
  const runtime::Network net = pruned_network();
  const auto room_by = [&](float sky, const SessionSettings& settings) {
    const Session session(TwoRooms(sky).scene, net, settings);
    return reflected(session, TwoRooms::inside());
  };
  // Which light a sample goes to depends on the sky; how much light there is does not.
  const double dim = sum_of(room_by(1, seen_from({TwoRooms::inside()})));
  EXPECT_NEAR(sum_of(room_by(1000, seen_from({TwoRooms::inside()}))), dim, 0.2 * dim);
  EXPECT_NE(room_by(1000, seen_from({})), room_by(1, seen_from({})))
      << "of a session that does not know what is seen";
  const TwoRooms rooms(1000);
  Renderer renderer(rooms.scene);
  EmbedSettings culled;
  culled.culled_lights = {rooms.other_lamp, rooms.sky};
  renderer.embed(net, culled);
  renderer.make_cache(Method::Network, {});
  EXPECT_GT(renderer.render(TwoRooms::inside(), picture(Output::Gi)).color.pixels.size(), 0u);
}

TEST(LookFrom, OtherCamerasBringOtherLight) {
  const TwoRooms rooms(10);
  const Points points(rooms.scene);
  Session session(rooms.scene, pruned_network(), seen_from({TwoRooms::inside()}));
  EXPECT_THAT(session.state()->culled_lights(), ElementsAre(rooms.other_lamp, rooms.sky));
  const auto inside = session.state()->irradiance(points.queries());
  const std::optional<EditReport> out = session.look_from({TwoRooms::outside()});
  ASSERT_TRUE(out);
  EXPECT_EQ(out->encodings, 1);
  EXPECT_THAT(session.state()->culled_lights(), ElementsAre(rooms.lamp, rooms.other_lamp));
  EXPECT_NE(session.state()->irradiance(points.queries()), inside);
  EXPECT_EQ(change_against_fresh(session, points.queries()).largest, 0);
  EXPECT_FALSE(session.can_undo()) << "nothing has been edited";
  ASSERT_TRUE(session.look_from({TwoRooms::inside(), TwoRooms::outside()}));
  EXPECT_THAT(session.state()->culled_lights(), ElementsAre(rooms.other_lamp));
  ASSERT_TRUE(session.look_from({TwoRooms::inside()}));
  EXPECT_EQ(session.state()->irradiance(points.queries()), inside);
  ASSERT_TRUE(session.look_from({}));
  EXPECT_THAT(session.state()->culled_lights(), IsEmpty());
}

TEST(LookFrom, ACameraThatMovesWithinARoomChangesNothing) {
  Session session(TwoRooms().scene, pruned_network(), seen_from({TwoRooms::inside()}));
  const StatePtr before = session.state();
  EXPECT_FALSE(session.look_from({elsewhere_inside()}));
  EXPECT_EQ(session.state()->version(), before->version());
  EXPECT_EQ(session.state()->culled_lights(), before->culled_lights());
  // What has been found is known to the next edit.
  session.separate();
  EXPECT_EQ(session.apply(SetLight{0, 0.5, {}}, false, Accuracy::Kept).accuracy, Accuracy::Full);
}

TEST(LookFrom, ALampThatIsSwitchedOffIsNotLeftOut) {
  const TwoRooms rooms;
  Session session(rooms.scene, pruned_network(), seen_from({TwoRooms::inside()}));
  session.separate();
  session.apply(SetLight{rooms.lamp, 0, {}});
  EXPECT_FALSE(session.look_from({elsewhere_inside()}));
  EXPECT_THAT(session.state()->culled_lights(), ElementsAre(rooms.other_lamp, rooms.sky));
  EXPECT_EQ(session.apply(SetLight{rooms.lamp, 1, {}}).encodings, 0);
}

TEST(LookFrom, AnEditThatLetsLightInIsSeenAndTakenBack) {
  TwoRooms rooms(10, /*roof=*/false);
  const int lid = rooms.add_lid();
  Session session(rooms.scene, pruned_network(), seen_from({TwoRooms::inside()}));
  EXPECT_THAT(session.state()->culled_lights(), ElementsAre(rooms.other_lamp, rooms.sky));
  const std::vector<float> closed = reflected(session, TwoRooms::inside());
  session.apply(RemoveInstance{lid}, false, Accuracy::Kept);
  ASSERT_TRUE(session.refine(Accuracy::Coarse));
  EXPECT_THAT(session.state()->culled_lights(), ElementsAre(rooms.other_lamp));
  ASSERT_TRUE(session.refine());
  EXPECT_THAT(session.state()->culled_lights(), ElementsAre(rooms.other_lamp));
  EXPECT_NE(reflected(session, TwoRooms::inside()), closed);
  session.undo();
  EXPECT_THAT(session.state()->culled_lights(), ElementsAre(rooms.other_lamp, rooms.sky));
  EXPECT_EQ(reflected(session, TwoRooms::inside()), closed);
}

TEST(LookFrom, ARoomThatNoLightReachesIsBlack) {
  TwoRooms rooms(10);
  Session session(rooms.scene, pruned_network(), seen_from({TwoRooms::inside()}));
  ASSERT_FALSE(reflected(session, TwoRooms::inside()).empty());
  session.apply(RemoveLight{rooms.lamp});
  EXPECT_EQ(session.state()->culled_lights().size(), 2u);
  const std::vector<float> dark = reflected(session, TwoRooms::inside());
  EXPECT_EQ(dark, std::vector<float>(dark.size()));
  ASSERT_TRUE(session.undo());
  EXPECT_NE(reflected(session, TwoRooms::inside()), dark);
}

TEST(LookFrom, APictureByLuminaireIsTheSumOfThoseThatAreTold) {
  const TwoRooms rooms(10);
  Session session(rooms.scene, pruned_network(), seen_from({TwoRooms::inside()}));
  session.separate();
  DimmablePicture dimmable(session.state(), Output::Gi, 24 * 16);
  StageSeconds ignored;
  dimmable.add(TwoRooms::inside(), picture(Output::Gi), /*anew=*/true, &ignored);
  session.apply(std::vector<Edit>{SetLight{rooms.lamp, 0.5, {}}, SetLight{rooms.sky, 100, {}}});
  ASSERT_TRUE(dimmable.fits(*session.state()));
  const std::vector<float> whole = reflected(session, TwoRooms::inside());
  const image::Image sum = dimmable.color(*session.state());
  EXPECT_NEAR(sum_of(sum.pixels), sum_of(whole), 0.1 * sum_of(whole));
}

TEST(LookFrom, ANetworkAnswersWhereItIsToldOfNoUntrainedLight) {
  const TwoRooms rooms;
  Session session(rooms.scene, pruned_network(/*suns=*/false), seen_from({TwoRooms::inside()}));
  EXPECT_TRUE(session.state()->has_network()) << "the sky is outside";
  EXPECT_TRUE(session.look_from({TwoRooms::outside()}));
  EXPECT_FALSE(session.state()->has_network());
  EXPECT_TRUE(session.look_from({TwoRooms::inside()}));
  EXPECT_TRUE(session.state()->has_network());
}

}  // namespace
}  // namespace lte::infer
