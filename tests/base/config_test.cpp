#include "lte/base/config.h"

#include <gmock/gmock.h>

#include "lte/base/file.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

using test::error_of;
using test::TempDir;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

/// What reading `text` as a T says.
template <typename T>
std::string read_error(const std::string& text) {
  return error_of([&] {
    T value{};
    Config::parse("model:\n  channels: " + text + "\n", "cfg.yaml")
        .at("model")
        .read("channels", &value);
  });
}

template <typename T>
T read_value(const std::string& text) {
  T value{};
  Config::parse("x: " + text, "cfg.yaml").read("x", &value);
  return value;
}

TEST(Config, ReadsEveryType) {
  EXPECT_EQ(read_value<bool>("true"), true);
  EXPECT_EQ(read_value<bool>("false"), false);
  EXPECT_EQ(read_value<int>("-12"), -12);
  EXPECT_EQ(read_value<int>("+12"), 12);
  EXPECT_EQ(read_value<int64_t>("-9223372036854775808"), INT64_MIN);
  EXPECT_EQ(read_value<uint64_t>("18446744073709551615"), UINT64_MAX);
  EXPECT_EQ(read_value<float>("0.1"), 0.1f);
  EXPECT_EQ(read_value<double>("2e-4"), 2e-4);
  EXPECT_EQ(read_value<double>("3"), 3.0);
  EXPECT_EQ(read_value<std::string>("rooms"), "rooms");
  EXPECT_EQ(read_value<std::string>("\"12\""), "12");
  EXPECT_THAT(read_value<std::vector<int64_t>>("[2, 6, 2]"), ElementsAre(2, 6, 2));
  EXPECT_THAT(read_value<std::vector<double>>("[0.5, 1]"), ElementsAre(0.5, 1.0));
  EXPECT_THAT(read_value<std::vector<std::string>>("[]"), ElementsAre());
}

TEST(Config, LeavesDefaultsWhereAKeyIsMissing) {
  int n = 7;
  const Config config;
  config.read("n", &n);
  config.at("a").at("b").read("n", &n);
  config.finish();
  EXPECT_EQ(n, 7);
  EXPECT_FALSE(config.has("n"));
}

TEST(Config, IllTypedValueNamesFileLineKeyTypeAndText) {
  EXPECT_EQ(read_error<int>("abc"), "cfg.yaml:2: model.channels: expected an integer, got \"abc\"");
  EXPECT_THAT(read_error<int>("1.5"), HasSubstr("expected an integer, got \"1.5\""));
  EXPECT_THAT(read_error<int>("\"12\""), HasSubstr("expected an integer"));
  EXPECT_THAT(read_error<int>("12 13"), HasSubstr("expected an integer"));
  EXPECT_THAT(read_error<int>(""), HasSubstr("expected an integer, got nothing"));
  EXPECT_THAT(read_error<int>("[1]"), HasSubstr("expected an integer, got a list"));
  EXPECT_THAT(read_error<int>("{a: 1}"), HasSubstr("expected an integer, got a map"));
  EXPECT_THAT(read_error<int>("3000000000"), HasSubstr("from -2147483648 to 2147483647"));
  EXPECT_THAT(read_error<uint64_t>("-1"), HasSubstr("from 0 to 18446744073709551615"));
  EXPECT_THAT(read_error<bool>("yes"), HasSubstr("expected true or false, got \"yes\""));
  EXPECT_THAT(read_error<bool>("1"), HasSubstr("expected true or false"));
  EXPECT_THAT(read_error<double>("fast"), HasSubstr("expected a number, got \"fast\""));
  EXPECT_THAT(read_error<double>("nan"), HasSubstr("expected a finite number"));
  EXPECT_THAT(read_error<float>("1e39"), HasSubstr("expected a finite number"));
  EXPECT_THAT(read_error<std::string>("[a]"), HasSubstr("expected a text, got a list"));
  EXPECT_THAT(read_error<std::vector<int64_t>>("3"), HasSubstr("expected a list, got \"3\""));
  EXPECT_THAT(read_error<std::vector<int64_t>>("[1, x]"),
              HasSubstr("model.channels[1]: expected an integer"));
}

TEST(Config, ScalarWhereAMapIsExpectedIsAnError) {
  const Config config = Config::parse("a: 1", "cfg.yaml");
  EXPECT_EQ(error_of([&] { config.at("a"); }), "cfg.yaml:1: a: expected a map, got \"1\"");
  Config::parse("a:\n", "cfg.yaml").at("a");  // empty is an empty map
}

/// Reads what a small program would.
void read_model(const Config& config) {
  int n = 0;
  double rate = 0;
  config.at("model").read("channels", &n);
  config.at("model").read("heads", &n);
  config.at("train").read("learning_rate", &rate);
  config.finish();
}

TEST(Config, UnknownKeyNamesTheNearest) {
  read_model(Config::parse("model: {channels: 3}\ntrain: {learning_rate: 1}\n", "cfg.yaml"));
  EXPECT_EQ(error_of([] { read_model(Config::parse("model:\n  chanels: 3", "cfg.yaml")); }),
            "cfg.yaml:2: unknown key \"model.chanels\"; did you mean \"model.channels\"?");
  EXPECT_THAT(error_of([] { read_model(Config::parse("modle: {}", "cfg.yaml")); }),
              HasSubstr("did you mean \"model\"?"));
  EXPECT_THAT(error_of([] { read_model(Config::parse("learning_rat: 1", "cfg.yaml")); }),
              HasSubstr("did you mean \"train.learning_rate\"?"));
  for (const char* text : {"train: {lr: 1}", "train: {learn: 1}", "lr: 1"}) {
    EXPECT_THAT(error_of([&] { read_model(Config::parse(text, "cfg.yaml")); }),
                HasSubstr("did you mean \"train.learning_rate\"?"))
        << text;
  }
  EXPECT_EQ(error_of([] { read_model(Config::parse("zzzzzzzz: 1", "cfg.yaml")); }),
            "cfg.yaml:1: unknown key \"zzzzzzzz\"");
}

TEST(Config, OverridesReplaceAndAreCheckedToo) {
  const TempDir dir;
  write_file(dir / "cfg.yaml", "model:\n  channels: 3\n  heads: 2\n");
  const Config config =
      Config::load(dir / "cfg.yaml", {"model.channels=8", "model.list=[1, 2]", "new.deep.key=yes"});
  int channels = 0, heads = 0;
  std::vector<int64_t> list;
  std::string deep;
  config.at("model").read("channels", &channels);
  config.at("model").read("heads", &heads);
  config.at("model").read("list", &list);
  config.at("new").at("deep").read("key", &deep);
  config.finish();
  EXPECT_EQ(channels, 8);
  EXPECT_EQ(heads, 2);
  EXPECT_THAT(list, ElementsAre(1, 2));
  EXPECT_EQ(deep, "yes");
  const auto error = [&](const std::string& text) {
    return error_of([&] { read_model(Config::load(dir / "cfg.yaml", {text})); });
  };
  EXPECT_EQ(error("model.chanels=4"),
            "override \"model.chanels=4\": unknown key \"model.chanels\"; did you mean "
            "\"model.channels\"?");
  EXPECT_EQ(error("model.channels=abc"),
            "override \"model.channels=abc\": model.channels: expected an integer, got \"abc\"");
  EXPECT_THAT(error("model.channels"), HasSubstr("expected key=value"));
  EXPECT_THAT(error("=3"), HasSubstr("empty key"));
  EXPECT_THAT(error("model..x=3"), HasSubstr("empty key"));
  EXPECT_THAT(error("model.channels.x=3"), HasSubstr("\"model.channels\" is not a map"));
  EXPECT_THAT(error("model.channels=[1"),
              AllOf(StartsWith("override"), HasSubstr("not valid YAML")));
}

TEST(Config, ParentsGiveDefaults) {
  const TempDir dir;
  std::filesystem::create_directory(dir / "sub");
  write_file(dir / "base.yaml", "a: 1\nmap: {x: 1, y: 2}\nlist: [1, 2, 3]\n");
  write_file(dir / "mid.yaml", "parent: base.yaml\nmap: {y: 3}\n");
  write_file(dir / "sub/leaf.yaml", "parent: ../mid.yaml\nlist: [9]\nmap: {z: 4}\n");
  const Config config = Config::load(dir / "sub/leaf.yaml");
  int a = 0, x = 0, y = 0, z = 0;
  std::vector<int64_t> list;
  config.read("a", &a);
  config.at("map").read("x", &x);
  config.at("map").read("y", &y);
  config.at("map").read("z", &z);
  config.read("list", &list);
  config.finish();  // "parent" itself is no key to be read
  EXPECT_THAT((std::vector<int>{a, x, y, z}), ElementsAre(1, 1, 3, 4));
  EXPECT_THAT(list, ElementsAre(9));
}

TEST(Config, ErrorNamesTheFileTheValueStandsIn) {
  const TempDir dir;
  write_file(dir / "base.yaml", "\nn: abc\n");
  write_file(dir / "leaf.yaml", "parent: base.yaml\n");
  int n = 0;
  EXPECT_THAT(error_of([&] { Config::load(dir / "leaf.yaml").read("n", &n); }),
              HasSubstr("base.yaml:2: n: expected"));
}

TEST(Config, RefusesBrokenChains) {
  const TempDir dir;
  write_file(dir / "a.yaml", "parent: b.yaml\n");
  write_file(dir / "b.yaml", "parent: ./a.yaml\n");
  EXPECT_THAT(error_of([&] { Config::load(dir / "a.yaml"); }), HasSubstr("leads back to itself"));
  write_file(dir / "c.yaml", "x: 1\nparent: none.yaml\n");
  EXPECT_THAT(error_of([&] { Config::load(dir / "c.yaml"); }),
              AllOf(HasSubstr("c.yaml:2: parent"), HasSubstr("none.yaml")));
  write_file(dir / "d.yaml", "parent: [a.yaml]\n");
  EXPECT_THAT(error_of([&] { Config::load(dir / "d.yaml"); }),
              HasSubstr("expected the name of a file"));
}

TEST(Config, RefusesWhatIsNoMap) {
  const auto error = [](const std::string& text) {
    return error_of([&] { Config::parse(text, "cfg.yaml"); });
  };
  EXPECT_THAT(error("- 1\n- 2\n"), HasSubstr("expected a map of keys, got a list"));
  EXPECT_THAT(error("hello"), HasSubstr("expected a map of keys"));
  EXPECT_THAT(error("a: 1\nb: [1, 2\n"), StartsWith("cfg.yaml:"));
  EXPECT_THAT(error("a: 1\nb: 2\na: 3\n"), HasSubstr("cfg.yaml:3: key \"a\" stands here twice"));
  EXPECT_THAT(error("[1, 2]: 3\n"), HasSubstr("expected a plain key"));
  EXPECT_THAT(error("a: 1\n---\nb: 2\n"), HasSubstr("one YAML document"));
  Config::parse("", "cfg.yaml").finish();
  Config::parse("# only a comment\n", "cfg.yaml").finish();
  const TempDir dir;
  EXPECT_THAT(error_of([&] { Config::load(dir / "none.yaml"); }), HasSubstr("none.yaml"));
}

TEST(Config, SurvivesHostileText) {
  // Aliases that would unfold to 10^9 values, and nesting deeper than the stack.
  std::string bomb = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 9; ++i) {
    bomb += concat("a", i, ": &a", i, " [");
    for (int j = 0; j < 10; ++j) bomb += concat("*a", i - 1, j < 9 ? ", " : "]\n");
  }
  EXPECT_THAT(error_of([&] { Config::parse(bomb, "cfg.yaml"); }), HasSubstr("more than"));
  const std::string deep = "a: " + std::string(100'000, '[') + std::string(100'000, ']');
  EXPECT_THAT(error_of([&] { Config::parse(deep, "cfg.yaml"); }), StartsWith("cfg.yaml"));
  const std::string map_depth = "a: " + std::string(100, '[') + std::string(100, ']');
  EXPECT_THAT(error_of([&] { Config::parse(map_depth, "cfg.yaml"); }), HasSubstr("nested deeper"));
}

TEST(Config, YamlRoundTrip) {
  const std::string text =
      "n: 3\nrate: 2e-4\nquoted: \"12\"\nname: rooms\nempty: \"\"\nlist: [1, [2, 3]]\nmap: {x: "
      "true, y: {}}\nnone: ~\n";
  const Config config = Config::parse(text, "cfg.yaml");
  const std::string yaml = config.to_yaml();
  const Config again = Config::parse(yaml, "again.yaml");
  EXPECT_EQ(again.to_yaml(), yaml);
  int n = 0;
  double rate = 0;
  std::string quoted, empty = "x";
  bool x = false;
  again.read("n", &n);
  again.read("rate", &rate);
  again.read("quoted", &quoted);
  again.read("empty", &empty);
  again.at("map").read("x", &x);
  EXPECT_EQ(n, 3);
  EXPECT_EQ(rate, 2e-4);
  EXPECT_EQ(quoted, "12");
  EXPECT_EQ(empty, "");
  EXPECT_TRUE(x);
  EXPECT_THROW(again.read("quoted", &n), Error) << "quotes must survive";
  EXPECT_EQ(Config::parse(Config().to_yaml(), "empty.yaml").to_yaml(), Config().to_yaml());
}

TEST(NearestName, FindsTyposAndRejectsStrangers) {
  const std::vector<std::string> names = {"--config", "--checkpoint", "--seed"};
  EXPECT_EQ(nearest_name("--cofnig", names), "--config");
  EXPECT_EQ(nearest_name("--chekpoint", names), "--checkpoint");
  EXPECT_EQ(nearest_name("--seeds", names), "--seed");
  EXPECT_EQ(nearest_name("--resolution", names), "");
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(nearest_name("x", {}), "");
}

}  // namespace
}  // namespace lte
