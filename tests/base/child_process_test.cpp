// Programs beside this process: their exit status, their descriptors, and their end.
#include "lte/base/child_process.h"

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "lte/base/check.h"

namespace lte {
namespace {

TEST(ChildProcess, GivesItsExitStatusOnce) {
  ChildProcess three({"sh", "-c", "exit 3"}), killed({"sh", "-c", "kill -9 $$"});
  EXPECT_EQ(three.wait(), 3);
  EXPECT_EQ(three.wait(), -1) << "it has ended before";
  EXPECT_EQ(killed.wait(), -1);
}

TEST(ChildProcess, ReadsAndWritesTheDescriptorsThatItIsGiven) {
  std::array<int, 2> in{}, errors{};
  ASSERT_EQ(pipe(in.data()), 0);
  ASSERT_EQ(pipe(errors.data()), 0);
  ASSERT_EQ(write(in[1], "words", 5), 5);
  close(in[1]);
  {
    ChildProcess child({"sh", "-c", "cat >&2; echo to nobody"}, in[0], errors[1]);
    close(errors[1]);
    EXPECT_EQ(child.wait(), 0);
  }
  std::array<char, 16> said{};
  EXPECT_EQ(read(errors[0], said.data(), said.size()), 5);
  EXPECT_STREQ(said.data(), "words");
  close(in[0]);
  close(errors[0]);
}

TEST(ChildProcess, EndsWithItsOwner) {
  std::array<int, 2> errors{};
  ASSERT_EQ(pipe(errors.data()), 0);
  { const ChildProcess sleeper({"sleep", "1000"}, -1, errors[1]); }
  close(errors[1]);
  char byte = 0;
  EXPECT_EQ(read(errors[0], &byte, 1), 0) << "nobody has the other end";
  close(errors[0]);
}

TEST(ChildProcess, ThatThereIsNotIsNamed) {
  try {
    const ChildProcess none({"no-such-program"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("no-such-program"));
  }
}

}  // namespace
}  // namespace lte
