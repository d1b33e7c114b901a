// The tools of a build without LibTorch: pictures and points by gathered light and by paths, and
// one line where a network is wanted.
#include <filesystem>

#include <gtest/gtest.h>

#include "infer/probe/probe_command.h"
#include "infer/render/render_command.h"
#include "lte/base/file.h"
#include "lte/scene/export.h"
#include "tests/infer/fixture.h"
#include "tests/support/command_line.h"
#include "tests/support/folder_files.h"
#include "tests/support/in_folder.h"
#include "tests/support/temp_dir.h"

namespace lte::infer {
namespace {

namespace fs = std::filesystem;
using test::CommandOutcome;

class NoNetwork : public test::InFolder {
 protected:
  template <typename Request, typename Add, typename Run>
  static CommandOutcome run(const char* tool, const Add& add, const Run& body,
                            const std::string& rest) {
    CLI::App app{"", tool};
    Request request;
    add(app, &request);
    return test::run_command(app, split("--quiet " + rest), [&] { body(request); });
  }

  NoNetwork() {
    scene::write_glb("floor.glb", test::lit_floor());
    test::write_text("points.csv", "px,py,pz,nx,ny,nz\n0.5,0,0,0,1,0\n-1,0,0.50,0,2,0\n");
  }
  static CommandOutcome render(const std::string& rest) {
    return run<RenderRequest>("lte_render", add_render_options, run_render, rest);
  }
  static CommandOutcome probe(const std::string& rest) {
    return run<ProbeRequest>("lte_probe", add_probe_options, run_probe, rest);
  }
};

TEST_F(NoNetwork, GatheredLightAndPathsNeedNone) {
  for (const std::string how : {"gather", "path"}) {
    const CommandOutcome picture = render("floor.glb --size 24x16 --quality draft --integrator " +
                                          how + " --out " + how + ".png");
    EXPECT_EQ(picture.code, 0) << picture.err;
    const CommandOutcome points = probe("floor.glb --points points.csv --spp 64 --integrator " +
                                        how + " --out " + how + ".csv");
    EXPECT_EQ(points.code, 0) << points.err;
    EXPECT_GT(fs::file_size(how + ".png"), 100u);
    EXPECT_GT(fs::file_size(how + ".csv"), 100u);
  }
}

TEST_F(NoNetwork, WhoWantsOneIsToldInOneLine) {
  const auto before = test::folder_files(".");
  const auto refused = [&](const CommandOutcome& outcome) {
    test::expect_one_line(outcome, 1, {"no network", "LTE_TORCH=ON"});
    EXPECT_EQ(test::folder_files("."), before);
  };
  refused(render("floor.glb --integrator network --out a.png"));
  refused(render("floor.glb --integrator network --validate-only"));
  refused(probe("floor.glb --points points.csv --integrator network --out a.csv"));
}

}  // namespace
}  // namespace lte::infer
