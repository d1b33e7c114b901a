#include "infer/view/inbox.h"

#include <gtest/gtest.h>

namespace lte::infer::view {
namespace {

MoveCamera camera_along(float x) {
  MoveCamera move;
  move.camera.origin = {x, 0, 0};
  return move;
}

MakeEdit gain(int light, float value, int64_t gesture = 1) {
  return {LightSetting{light, value, {1, 1, 1}, {}}, gesture};
}

TEST(Inbox, TheLatestCameraWins) {
  Inbox inbox;
  for (int i = 1; i <= 100; ++i) ASSERT_TRUE(inbox.post(3, i, camera_along(static_cast<float>(i))));
  const Inbox::Batch batch = inbox.take(Inbox::kNoWait);
  ASSERT_EQ(batch.requests.size(), 1u);
  EXPECT_EQ(std::get<MoveCamera>(batch.requests[0].request).camera.origin.x, 100);
  EXPECT_EQ(batch.last_number.at(3), 100);
  EXPECT_FALSE(inbox.waiting());
}

TEST(Inbox, ViewsAreMergedKeyByKey) {
  Inbox inbox;
  ChangeView shown, ev, later;
  shown.shown = Shown::Direct;
  ev.ev = 1.0f;
  later.ev = 2.0f;
  inbox.post(1, 1, shown);
  inbox.post(1, 2, ev);
  inbox.post(2, 1, later);
  const Inbox::Batch batch = inbox.take(Inbox::kNoWait);
  ASSERT_EQ(batch.requests.size(), 1u);
  const auto& view = std::get<ChangeView>(batch.requests[0].request);
  EXPECT_EQ(view.shown, Shown::Direct);
  EXPECT_EQ(view.ev, 2.0f);
}

TEST(Inbox, EditsOfOneTargetAndGestureAreOne) {
  Inbox inbox;
  for (int i = 1; i <= 50; ++i) inbox.post(1, i, gain(i % 2, static_cast<float>(i)));
  const Inbox::Batch batch = inbox.take(Inbox::kNoWait);
  ASSERT_EQ(batch.requests.size(), 2u);
  EXPECT_EQ(std::get<MakeEdit>(batch.requests[0].request).edit, gain(1, 49).edit);
  EXPECT_EQ(std::get<MakeEdit>(batch.requests[1].request).edit, gain(0, 50).edit);
}

TEST(Inbox, GesturesAndPagesStayApart) {
  Inbox inbox;
  inbox.post(1, 1, gain(0, 1, 1));
  inbox.post(1, 2, gain(0, 2, 2));
  inbox.post(2, 1, gain(0, 3, 2));
  EXPECT_EQ(inbox.take(Inbox::kNoWait).requests.size(), 3u);
}

TEST(Inbox, NothingIsTakenPastAnUndo) {
  Inbox inbox;
  inbox.post(1, 1, gain(0, 1));
  inbox.post(1, 2, Undo{});
  inbox.post(1, 3, gain(0, 2));
  const Inbox::Batch batch = inbox.take(Inbox::kNoWait);
  ASSERT_EQ(batch.requests.size(), 3u);
  EXPECT_TRUE(std::holds_alternative<Undo>(batch.requests[1].request));
}

TEST(Inbox, APickKeepsTheCameraItWasMadeWith) {
  Inbox inbox;
  inbox.post(1, 1, camera_along(1));
  inbox.post(1, 2, PickAt{0.5f, 0.5f});
  inbox.post(1, 3, camera_along(2));
  EXPECT_EQ(inbox.take(Inbox::kNoWait).requests.size(), 3u);
}

TEST(Inbox, IsBounded) {
  Inbox inbox;
  for (size_t i = 0; i < Inbox::kMaxPending; ++i)
    ASSERT_TRUE(inbox.post(1, static_cast<int64_t>(i) + 1, PickAt{}));
  EXPECT_FALSE(inbox.post(1, 5000, PickAt{}));
  EXPECT_FALSE(inbox.post(2, 1, Undo{}));
  EXPECT_EQ(inbox.take(Inbox::kNoWait).last_number.at(1), static_cast<int64_t>(Inbox::kMaxPending));
}

TEST(Inbox, APageThatHasGoneIsToldNothing) {
  Inbox inbox;
  inbox.post(1, 1, PickAt{});
  inbox.post(1, 2, gain(0, 2));
  inbox.forget(1);
  const Inbox::Batch batch = inbox.take(Inbox::kNoWait);
  ASSERT_EQ(batch.requests.size(), 1u);  // what it has edited stays
  EXPECT_TRUE(std::holds_alternative<MakeEdit>(batch.requests[0].request));
  EXPECT_TRUE(batch.last_number.empty());
}

}  // namespace
}  // namespace lte::infer::view
