#include "infer/view/conversation.h"

#include <gtest/gtest.h>

#include "lte/base/check.h"

namespace lte::infer::view {
namespace {

constexpr const char* kHello = R"({"type":"hello","protocol":1,"n":1})";

TEST(Conversation, BeginsWithHello) {
  Conversation talk;
  EXPECT_THROW(talk.next(R"({"type":"undo","n":1})"), Error);
  EXPECT_TRUE(talk.over());
  Conversation garbage;
  EXPECT_THROW(garbage.next("GET / HTTP/1.1"), Error);
  EXPECT_TRUE(garbage.over());
  Conversation other;
  EXPECT_THROW(other.next(R"({"type":"hello","protocol":2,"n":1})"), Error);
  EXPECT_TRUE(other.over());
  Conversation good;
  good.next(kHello);
  EXPECT_TRUE(good.welcomed());
  EXPECT_FALSE(good.over());
}

TEST(Conversation, MessagesOutOfOrderAreRefused) {
  Conversation talk;
  talk.next(kHello);
  EXPECT_EQ(talk.next(R"({"type":"undo","n":5})").number, 5);
  EXPECT_THROW(talk.next(R"({"type":"undo","n":5})"), Error);
  EXPECT_THROW(talk.next(R"({"type":"undo","n":4})"), Error);
  EXPECT_THROW(talk.next(R"({"type":"hello","protocol":1,"n":6})"), Error);
  EXPECT_EQ(talk.next(R"({"type":"undo","n":7})").number, 7);
  EXPECT_FALSE(talk.over());
}

TEST(Conversation, EndsAfterFaultUponFault) {
  Conversation talk;
  talk.next(kHello);
  for (int i = 0; i < Conversation::kMaxFaults; ++i) {
    EXPECT_FALSE(talk.over());
    EXPECT_THROW(talk.next("x"), Error);
  }
  EXPECT_TRUE(talk.over());
}

}  // namespace
}  // namespace lte::infer::view
