#include "lte/runtime/memory_limit.h"

#include <cstdio>
#include <functional>
#include <new>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/tensor/functions.h"

namespace lte::runtime {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// What `body` refuses, and what it says would help.
struct Said {
  std::string message;
  std::vector<Hint> hints;
};

Said said_of(const std::function<void()>& body) {
  try {
    body();
  } catch (const LimitError& refusal) {
    return {refusal.what(), refusal.hints()};
  } catch (const Error& error) {
    return {error.what(), {}};
  }
  return {};
}

TEST(MemoryText, ChangesItsUnitAtAGibibyte) {
  EXPECT_EQ(memory_text(210.4), "210 MiB");
  EXPECT_EQ(memory_text(1536), "1.5 GiB");
}

TEST(MemoryLimit, CutsQueriesToWhatFits) {
  const nn::ModelConfig config;
  EXPECT_EQ(MemoryLimit().query_block(config, 10'000'000, kQueryBlock), kQueryBlock);
  EXPECT_EQ(MemoryLimit(100'000).query_block(config, 10'000'000, kQueryBlock), kQueryBlock);
  const double limit_mb = decode_mb(config, 1'000'000, 20'000) + 1;
  const int64_t block = MemoryLimit(limit_mb).query_block(config, 1'000'000, kQueryBlock);
  EXPECT_GT(block, 15'000);
  EXPECT_LE(decode_mb(config, 1'000'000, block), limit_mb);
  const Said said = said_of([&] { MemoryLimit(1).query_block(config, 1'000'000, kQueryBlock); });
  EXPECT_THAT(said.message, AllOf(HasSubstr("memory limit of 1 MiB"), HasSubstr("1000000 queries"),
                                  HasSubstr("raise the limit")));
  EXPECT_THAT(said.hints, ElementsAre(Hint::FewerQueries, Hint::MemoryLimit));
}

TEST(MemoryLimit, NamesTheNeedOfAnEncodingThatCannotFitAndHowManyPointsWould) {
  const nn::ModelConfig config;
  const MemoryLimit limit(1024);
  EXPECT_NO_THROW(limit.check_encoding(config, 20'000));
  const Said said = said_of([&] { limit.check_encoding(config, 10'000'000); });
  EXPECT_THAT(said.message, AllOf(HasSubstr("10000000 scene points"),
                                  HasSubstr(memory_text(encode_mb(config, 10'000'000)))));
  EXPECT_THAT(said.hints, ElementsAre(Hint::FewerScenePoints, Hint::MemoryLimit));
  int64_t fit = 0;
  const char* at = said.message.c_str() + said.message.find("take ");
  ASSERT_EQ(std::sscanf(at, "take %ld", &fit), 1) << said.message;
  EXPECT_NO_THROW(MemoryLimit(1024).check_encoding(config, fit * 99 / 100));
  EXPECT_THROW(MemoryLimit(1024).check_encoding(config, fit * 11 / 10), NotEnoughMemory);
}

TEST(OutOfMemory, IsSaidInOneLineWithTheNeed) {
  const auto explained = [](const std::function<void()>& body) {
    return said_of([&] {
      explain_out_of_memory(
          {"encoding 7 scene points", 210, "take fewer", {Hint::FewerScenePoints}}, body);
    });
  };
  const auto words =
      AllOf(HasSubstr("out of memory while encoding 7 scene points"), HasSubstr("210 MiB"),
            HasSubstr("take fewer"), testing::Not(HasSubstr("\n")));
  EXPECT_THAT(explained([] { at::empty({int64_t{1} << 45}); }).message, words);
  EXPECT_THAT(explained([] { throw std::bad_alloc(); }).message, words);
  EXPECT_THAT(explained([] { throw std::bad_alloc(); }).hints, ElementsAre(Hint::FewerScenePoints));
  EXPECT_EQ(explained([] { throw Error("something else"); }).message, "something else");
  EXPECT_EQ(explain_out_of_memory({}, [] { return 3; }), 3);
}

}  // namespace
}  // namespace lte::runtime
