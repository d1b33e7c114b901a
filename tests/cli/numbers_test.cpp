#include "lte/cli/numbers.h"

#include <cstdint>
#include <optional>

#include "tests/support/command_line.h"

namespace lte {
namespace {

struct Values {
  int count = 0;
  int64_t points = 0;
  uint64_t seed = 0;
  std::optional<uint64_t> other_seed;
  double turn = 0;
  std::optional<double> exposure;
  std::vector<double> list;
  std::string text;
};

void declare(CLI::App& app, Values* values) {
  app.add_option("--count", values->count);
  app.add_option("--points", values->points);
  app.add_option("--seed", values->seed);
  app.add_option("--other-seed", values->other_seed);
  app.add_option("--turn", values->turn);
  app.add_option("--exposure", values->exposure)->check(positive_number());
  app.add_option("--rate", values->turn)->check(non_negative_number());
  app.add_option("--list", values->list);
  app.add_option("--text", values->text);
  app.add_subcommand("command", "")->add_option("--deep", values->count)->check(CLI::Range(1, 9));
}

test::CommandOutcome given(Values* values, const std::vector<std::string>& arguments) {
  CLI::App app{"", "lte_x"};
  declare(app, values);
  return test::run_command(app, arguments);
}

TEST(Numbers, WhatIsNoNumberIsRefusedByEveryFlag) {
  static Values values;
  test::expect_numbers_refused([](CLI::App& app) { declare(app, &values); },
                               {"--count", "--points", "--seed", "--other-seed", "--turn",
                                "--exposure", "--rate", "--list", "--deep"});
}

TEST(Numbers, WhatIsOneArrivesAsItIs) {
  Values values;
  const auto outcome =
      given(&values, {"--count=-7", "--points", "9223372036854775807", "--seed",
                      "18446744073709551615", "--other-seed=+5", "--turn=-1e-3", "--exposure",
                      "0.25", "--list", "1", "2.5", "--text", "nan"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(values.count, -7);
  EXPECT_EQ(values.points, INT64_MAX);
  EXPECT_EQ(values.seed, UINT64_MAX);
  EXPECT_EQ(values.other_seed, 5u);
  EXPECT_EQ(values.turn, -1e-3);
  EXPECT_EQ(values.exposure, 0.25);
  EXPECT_EQ(values.list, (std::vector<double>{1, 2.5}));
  EXPECT_EQ(values.text, "nan") << "texts are left alone";
}

TEST(Numbers, DigitsBehindAZeroAreDecimal) {
  Values values;
  EXPECT_EQ(given(&values, {"--count", "010"}).code, 0);
  EXPECT_EQ(values.count, 10);
}

TEST(Numbers, MessagesSayWhatWasExpected) {
  Values values;
  test::expect_one_line(given(&values, {"--seed", "-1"}), 2,
                        {"--seed", "from 0 to 18446744073709551615", "\"-1\""});
  test::expect_one_line(given(&values, {"--exposure", "nan"}), 2, {"--exposure", "finite"});
  test::expect_one_line(given(&values, {"--exposure", "0"}), 2, {"--exposure", "above 0"});
  test::expect_one_line(given(&values, {"--rate", "-0.5"}), 2, {"--rate", "0 or", "\"-0.5\""});
  test::expect_one_line(given(&values, {"--count", "3000000000"}), 2, {"--count"});
}

}  // namespace
}  // namespace lte
