#include "infer/view/security.h"

#include <gtest/gtest.h>

namespace lte::infer::view {
namespace {

const Access kLocal{"", true, 8420};
const Access kOpen{"secret-token", false, 80};

TEST(Security, ReadsPathAndQuery) {
  EXPECT_EQ(path_of("/socket?token=abc"), "/socket");
  EXPECT_EQ(path_of("/"), "/");
  EXPECT_EQ(query_value("/?a=1&token=abc&b=2", "token"), "abc");
  EXPECT_EQ(query_value("/?xtoken=abc", "token"), "");
  EXPECT_EQ(query_value("/?token", "token"), "");
  EXPECT_EQ(query_value("/?&&token=x", "token"), "x");
  EXPECT_EQ(query_value("/", "token"), "");
}

TEST(Security, OnLoopbackTheHostIsThisMachine) {
  for (const char* host : {"127.0.0.1:8420", "localhost:8420", "[::1]:8420", "localhost"})
    EXPECT_EQ(refusal(kLocal, {"/", host, ""}, false), nullptr) << host;
  // What a page of evil.example sends whose name has been pointed at 127.0.0.1.
  for (const char* host : {"evil.example:8420", "127.0.0.1.evil.example:8420", "localhost:80", "",
                           "localhost:8420.evil.example", "127.0.0.1:84200"})
    EXPECT_NE(refusal(kLocal, {"/", host, ""}, false), nullptr) << host;
}

TEST(Security, ASocketComesFromThePageOfThisServer) {
  const char* host = "127.0.0.1:8420";
  EXPECT_EQ(refusal(kLocal, {"/socket", host, "http://127.0.0.1:8420"}, true), nullptr);
  EXPECT_EQ(refusal(kLocal, {"/socket", host, ""}, true), nullptr);
  for (const char* origin : {"http://evil.example", "https://127.0.0.1:8420", "null",
                             "http://127.0.0.1:8421", "http://127.0.0.1"})
    EXPECT_NE(refusal(kLocal, {"/socket", host, origin}, true), nullptr) << origin;
}

TEST(Security, ATokenIsAskedForWhereThereIsOne) {
  const char* host = "192.168.1.5";
  EXPECT_EQ(refusal(kOpen, {"/?token=secret-token", host, ""}, false), nullptr);
  EXPECT_EQ(refusal(kOpen, {"/socket?token=secret-token", host, "http://192.168.1.5"}, true),
            nullptr);
  for (const char* target : {"/", "/?token=", "/?token=secret-toke", "/?token=secret-tokens",
                             "/?token=secret-tokem", "/?Token=secret-token"})
    EXPECT_NE(refusal(kOpen, {target, host, ""}, false), nullptr) << target;
}

TEST(Security, TokensByChanceDifferAndMayStandInAnAddress) {
  const std::string one = random_token(), other = random_token();
  EXPECT_EQ(one.size(), 32u);
  EXPECT_NE(one, other);
  EXPECT_TRUE(is_token(one));
  EXPECT_FALSE(is_token("short"));
  EXPECT_FALSE(is_token("with space in it"));
  EXPECT_FALSE(is_token("eight&more"));
}

}  // namespace
}  // namespace lte::infer::view
