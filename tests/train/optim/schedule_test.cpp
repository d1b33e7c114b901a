#include "train/optim/schedule.h"

#include <gtest/gtest.h>

namespace lte::train {
namespace {

OptimConfig config() {
  OptimConfig train;
  train.steps = 111;
  train.warmup_steps = 10;
  train.learning_rate = 1.0;
  train.min_learning_rate = 0.2;
  return train;
}

TEST(Schedule, WarmsUpLinearly) {
  EXPECT_DOUBLE_EQ(learning_rate(config(), 0), 0.1);
  EXPECT_DOUBLE_EQ(learning_rate(config(), 4), 0.5);
  EXPECT_DOUBLE_EQ(learning_rate(config(), 9), 1.0);
}

TEST(Schedule, FallsAlongHalfACosineToTheFloorAtTheLastStep) {
  EXPECT_DOUBLE_EQ(learning_rate(config(), 10), 1.0);
  EXPECT_NEAR(learning_rate(config(), 35), 0.2 + 0.8 * 0.5 * (1 + 0.70710678118654752), 1e-12);
  EXPECT_NEAR(learning_rate(config(), 60), 0.6, 1e-12);
  EXPECT_NEAR(learning_rate(config(), 110), 0.2, 1e-12);
  EXPECT_NEAR(learning_rate(config(), 5000), 0.2, 1e-12);
}

TEST(Schedule, StaysConstantUntilTheLastShareOfTheSteps) {
  OptimConfig train = config();
  train.steps = 101;
  train.decay_share = 0.2;  // the last 20 steps
  EXPECT_DOUBLE_EQ(learning_rate(train, 4), 0.5);
  EXPECT_DOUBLE_EQ(learning_rate(train, 10), 1.0);
  EXPECT_DOUBLE_EQ(learning_rate(train, 81), 1.0);
  EXPECT_LT(learning_rate(train, 82), 1.0);
  EXPECT_NEAR(learning_rate(train, 100), 0.2, 1e-12);
}

TEST(Schedule, WithoutWarmUpStartsAtTheTop) {
  OptimConfig train = config();
  train.warmup_steps = 0;
  EXPECT_DOUBLE_EQ(learning_rate(train, 0), 1.0);
}

TEST(Schedule, OneStepAndAWarmUpBeyondTheEndAreHarmless) {
  OptimConfig train = config();
  train.steps = 1;
  train.warmup_steps = 0;
  EXPECT_DOUBLE_EQ(learning_rate(train, 0), 1.0);
  train.warmup_steps = 1000;
  EXPECT_DOUBLE_EQ(learning_rate(train, 0), 0.001);
}

TEST(Schedule, AverageForgetsItsStart) {
  OptimConfig train = config();
  train.ema_decay = 0.99;
  EXPECT_DOUBLE_EQ(ema_decay(train, 0), 0.1);
  EXPECT_DOUBLE_EQ(ema_decay(train, 10), 0.55);
  EXPECT_DOUBLE_EQ(ema_decay(train, 100'000), 0.99);
}

}  // namespace
}  // namespace lte::train
