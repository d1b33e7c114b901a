// lte_view of a build without LibTorch.
#include <gtest/gtest.h>

#include "infer/view/view_command.h"
#include "lte/scene/export.h"
#include "tests/infer/fixture.h"
#include "tests/support/command_line.h"
#include "tests/support/in_folder.h"

namespace lte::infer::view {
namespace {

class NoNetworkView : public test::InFolder {};

TEST_F(NoNetworkView, WantingOneIsRefusedInOneLine) {
  scene::write_glb("floor.glb", test::lit_floor());
  CLI::App app{"", "lte_view"};
  ViewRequest request;
  add_view_options(app, &request);
  const test::CommandOutcome outcome =
      test::run_command(app, {"--quiet", "floor.glb", "--integrator", "network", "--port", "0"},
                        [&] { run_view(request); });
  test::expect_one_line(outcome, 1, {"no network", "LTE_TORCH=ON"});
  EXPECT_EQ(outcome.out, "") << "no address of a server that is not there";
}

}  // namespace
}  // namespace lte::infer::view
