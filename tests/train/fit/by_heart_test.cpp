// The loop that learns one scene by heart, on numbers whose best values are known.
#include "train/fit/by_heart.h"

#include <ATen/ATen.h>
#include <gtest/gtest.h>

namespace lte::train {
namespace {

constexpr int64_t kQueries = 4000;

ByHeartLimits steps(int64_t count) {
  ByHeartLimits limits;
  limits.steps = count;
  limits.clock = [] { return 0.0; };
  limits.rate = 0.05;
  limits.batch = 512;
  return limits;
}

const auto kOn = [](int64_t, double) { return true; };

TEST(ByHeart, EndsAtTheMeanOfNoisyTargets) {
  at::manual_seed(1);
  const at::Tensor truth = at::tensor({0.5, 1.0, 1.5}, at::kFloat);
  // A tenth of the targets is ten times as bright, as rare bright paths make them.
  const at::Tensor noise = at::rand({kQueries, 1}).lt(0.1).to(at::kFloat) * 10;
  at::Tensor value = at::ones({3}).requires_grad_();
  const ByHeart task{{value},
                     [&](const at::Tensor& rows) {
                       return value.expand({rows.size(0), 3});
                     },
                     truth * noise,
                     at::arange(kQueries)};
  EXPECT_EQ(learn_by_heart(task, steps(400), kOn), 400);
  const at::Tensor mean = task.target.mean(0);
  EXPECT_TRUE(at::allclose(value, mean, 0.03, 0)) << value << mean;
}

TEST(ByHeart, ReadsTheRowsThatAreShownAlone) {
  at::Tensor values = at::ones({kQueries, 3}).requires_grad_();
  const ByHeart task{{values},
                     [&](const at::Tensor& rows) { return values.index_select(0, rows); },
                     at::full({kQueries, 3}, 2.0f),
                     at::arange(kQueries / 2)};
  learn_by_heart(task, steps(300), kOn);
  EXPECT_TRUE(at::equal(values.slice(0, kQueries / 2), at::ones({kQueries / 2, 3})));
  EXPECT_GT(values.slice(0, 0, kQueries / 2).mean().item<float>(), 1.5f);
}

TEST(ByHeart, EndsWithItsTimeOrWhenToldTo) {
  at::Tensor value = at::ones({3}).requires_grad_();
  const ByHeart task{{value},
                     [&](const at::Tensor& rows) {
                       return value.expand({rows.size(0), 3});
                     },
                     at::ones({kQueries, 3}),
                     at::arange(kQueries)};
  double now = 0;
  ByHeartLimits limits = steps(1000);
  limits.seconds = 5;
  limits.clock = [&] { return now += 0.25; };
  EXPECT_EQ(learn_by_heart(task, limits, kOn), 20);
  EXPECT_EQ(learn_by_heart(task, steps(1000), [](int64_t done, double) { return done < 7; }), 7);
}

}  // namespace
}  // namespace lte::train
