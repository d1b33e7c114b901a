#include "lte/cli/cli.h"

#include <new>
#include <stdexcept>

#include <gmock/gmock.h>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/parallel.h"
#include "lte/base/version.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A tool with commands, as lte_datagen is.
struct Tool {
  CLI::App app{"Makes things.", "lte_x"};
  CommonOptions common;
  int scenes = 0;
  std::string out;
  int code = -1;
  bool ran = false;
  std::string standard_out, standard_error;

  Tool() {
    add_common_options(app, &common);
    app.require_subcommand(1);
    CLI::App* generate = app.add_subcommand("generate", "Generates.");
    generate->add_option("--scenes", scenes, "How many");
    generate->add_option("--out", out, "Where to")->required();
    app.add_subcommand("info", "Informs.");
  }

  Tool& run(
      std::vector<std::string> arguments, const std::function<void()>& body = [] {}) {
    arguments.insert(arguments.begin(), "path/lte_x");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    code = run_tool(app, static_cast<int>(argv.size()), argv.data(), [&] {
      ran = true;
      body();
    });
    standard_out = testing::internal::GetCapturedStdout();
    standard_error = testing::internal::GetCapturedStderr();
    return *this;
  }
};

TEST(RunTool, ReturnsZeroOnSuccess) {
  Tool tool;
  tool.run({"--threads", "3", "generate", "--out", "here", "--scenes=4"});
  EXPECT_EQ(tool.code, 0);
  EXPECT_TRUE(tool.ran);
  EXPECT_EQ(tool.common.threads, 3);
  EXPECT_EQ(tool.scenes, 4);
  EXPECT_EQ(tool.standard_error, "");
}

TEST(RunTool, HelpAndVersionGoToStandardOutput) {
  Tool help, command_help, version_tool;
  help.run({"--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.standard_out,
              AllOf(HasSubstr("Makes things."), HasSubstr("--threads"), HasSubstr("generate")));
  command_help.run({"generate", "--help"});
  EXPECT_EQ(command_help.code, 0);
  EXPECT_THAT(command_help.standard_out, HasSubstr("--scenes"));
  version_tool.run({"--version"});
  EXPECT_EQ(version_tool.code, 0);
  EXPECT_EQ(version_tool.standard_out, std::string("lte_x ") + version() + "\n");
  EXPECT_FALSE(help.ran || command_help.ran || version_tool.ran);
}

TEST(RunTool, WrongUsageIsOneLineThatNamesTheNearestName) {
  const auto usage = [](const std::vector<std::string>& arguments) {
    Tool tool;
    tool.run(arguments);
    EXPECT_EQ(tool.code, 2);
    EXPECT_FALSE(tool.ran);
    EXPECT_EQ(std::count(tool.standard_error.begin(), tool.standard_error.end(), '\n'), 1)
        << tool.standard_error;
    EXPECT_EQ(tool.standard_out, "");
    return tool.standard_error;
  };
  EXPECT_EQ(usage({"generate", "--out", "a", "--scnes", "4"}),
            "lte_x: unknown option --scnes; did you mean --scenes? (see lte_x --help)\n");
  EXPECT_THAT(usage({"generate", "--uot=a"}),
              HasSubstr("unknown option --uot; did you mean --out?"));
  EXPECT_THAT(usage({"--thread", "4", "info"}),
              HasSubstr("unknown option --thread; did you mean --threads?"));
  EXPECT_EQ(usage({"info", "--threads", "4"}),
            "lte_x: unknown option --threads (see lte_x --help)\n")
      << "which the tool takes before the command";
  EXPECT_THAT(usage({"genrate"}), HasSubstr("unknown command \"genrate\"; did you mean generate?"));
  for (const std::vector<std::string>& rest : {std::vector<std::string>{}, {"--help"}, {"-h"}}) {
    std::vector<std::string> arguments = {"nonsense"};
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    EXPECT_EQ(usage(arguments),
              "lte_x: unknown command \"nonsense\"; the commands are generate, info (see lte_x "
              "--help)\n");
  }
  EXPECT_THAT(usage({"genrate", "--help"}), HasSubstr("did you mean generate?"));
  EXPECT_THAT(usage({"info", "surplus"}), HasSubstr("unexpected argument \"surplus\""));
  EXPECT_THAT(usage({"generate"}), HasSubstr("--out is required"));
  EXPECT_THAT(usage({}), HasSubstr("subcommand is required"));
  EXPECT_THAT(usage({"--threads", "-1", "info"}), HasSubstr("--threads"));
  EXPECT_THAT(usage({"--threads", "many", "info"}), HasSubstr("--threads"));
  const std::string most = std::to_string(max_threads());
  for (const std::string& number : {std::to_string(max_threads() + 1), std::string("1073741824")})
    EXPECT_THAT(usage({"--threads", number, "info"}),
                HasSubstr("--threads: " + number + " is more than " + most));
  EXPECT_THAT(usage({"--threads", "99999999999999", "info"}), HasSubstr("--threads"));
}

TEST(RunTool, FailureIsOneLineAndOne) {
  const auto failure = [](const std::function<void()>& body) {
    Tool tool;
    tool.run({"info"}, body);
    EXPECT_EQ(tool.code, 1);
    return tool.standard_error;
  };
  EXPECT_EQ(failure([] { throw Error("scene.gltf: no\nmeshes"); }),
            "lte_x: scene.gltf: no meshes\n");
  EXPECT_EQ(failure([] {
              throw std::runtime_error("message\nException raised from f (file.cpp:3)\nframe #0");
            }),
            "lte_x: message\n");
  EXPECT_EQ(failure([] { throw std::bad_alloc(); }), "lte_x: out of memory\n");
  EXPECT_EQ(failure([] { throw 3; }), "lte_x: unknown failure\n");
}

TEST(RunTool, UsageErrorOfTheBodyIsWrongUsage) {
  Tool tool;
  tool.run({"info"}, [] { throw CLI::ValidationError("--size", "expected WxH"); });
  EXPECT_EQ(tool.code, 2);
  EXPECT_EQ(tool.standard_error, "lte_x: --size: expected WxH (see lte_x --help)\n");
}

TEST(CommonOptions, Apply) {
  const test::TempDir dir;
  CommonOptions options;
  options.threads = 3;
  options.quiet = true;
  options.log_file = (dir / "log").string();
  apply_common_options(options);
  EXPECT_EQ(num_threads(), 3);
  EXPECT_EQ(log_level(), LogLevel::Warning);
  log_info("quiet, but logged");
  EXPECT_EQ(read_file(dir / "log"), "quiet, but logged\n");
  apply_common_options(CommonOptions{});
  EXPECT_EQ(log_level(), LogLevel::Info);
}

TEST(ConfigText, HasEveryFlagAsItStands) {
  CLI::App app{"", "a"};
  CommonOptions common;
  add_common_options(app, &common);
  std::string out, model;
  int rays = 16;
  bool dark = false, loud = false;
  app.add_option("--out", out);
  app.add_option("--model", model);
  app.add_option("--rays", rays);
  app.add_flag("--dark", dark);
  app.add_flag("--loud", loud);
  app.add_option_function<int>("--limit", [](int) {})->default_str("7");
  app.parse("--out 'a b.png' --dark --threads 2");
  model = "found later";
  const std::string text = "\n" + config_text(app);
  for (const char* line :
       {"out=\"a b.png\"", "model=\"found later\"", "rays=16", "dark=true", "loud=false", "limit=7",
        "threads=2", "quiet=false", "log-file=\"\"", "json=\"\""}) {
    EXPECT_THAT(text, HasSubstr(concat("\n", line, "\n")));
  }
}

TEST(CommonOptions, JsonIsOptional) {
  CLI::App with{"", "a"}, without{"", "b"};
  CommonOptions options;
  add_common_options(with, &options);
  add_common_options(without, &options, false);
  EXPECT_NE(with.get_option_no_throw("--json"), nullptr);
  EXPECT_EQ(without.get_option_no_throw("--json"), nullptr);
}

}  // namespace
}  // namespace lte
