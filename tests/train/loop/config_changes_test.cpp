#include "train/loop/config_changes.h"

#include <gmock/gmock.h>

#include "tests/support/temp_dir.h"

namespace lte::train {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(ConfigChanges, NamesEveryKeyWithBothValues) {
  EXPECT_THAT(
      config_changes("seed: 1\ntrain: {steps: 6, autocast: none}\ndata: {root: a}\nloss: [1, 2]\n",
                     "data: {root: b}\ntrain: {steps: 1000, autocast: none}\nseed: 1\n"
                     "loss: [1, 3]\n"),
      ElementsAre("data.root: a -> b", "train.steps: 6 -> 1000", "loss: [1, 2] -> [1, 3]"));
}

TEST(ConfigChanges, AKeyThatIsMissingHasItsDefault) {
  EXPECT_THAT(
      config_changes("train: {steps: 6, clip_norm: 0.8}\n", "train: {steps: 6, ema_decay: 0}\n"),
      ElementsAre("train.ema_decay: its default -> 0", "train.clip_norm: 0.8 -> its default"));
}

TEST(ConfigChanges, TheSameInOtherWordsIsNoChange) {
  EXPECT_THAT(config_changes("train: {rate: 1e-4, on: true, name: 'x'}\n",
                             "train:\n  rate: 0.0001\n  name: x\n  on: true\n"),
              IsEmpty());
  EXPECT_THAT(config_changes("", ""), IsEmpty());
  const test::TempDir dir;
  const std::string path = dir.path().string();
  EXPECT_THAT(config_changes("output: " + path, "output: " + path + "/."), IsEmpty());
  EXPECT_THAT(config_changes("output: a", "output: b"), ElementsAre("output: a -> b"));
}

}  // namespace
}  // namespace lte::train
