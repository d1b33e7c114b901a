// Plans and shells of wild scenes: cells that do not overlap, walls that close.
#include "datagen/wild/plan.h"

#include <cmath>

#include <gtest/gtest.h>

#include "datagen/wild/ceiling.h"
#include "datagen/wild/openings.h"
#include "datagen/wild/shell.h"
#include "lte/pathtrace/bvh.h"

namespace lte::datagen::wild {
namespace {

Dice dice_of(uint64_t seed) { return {Rng(seed, 9)}; }

double surface_of(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += 0.5 * length(cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                              mesh.positions[t[2]] - mesh.positions[t[0]]));
  return sum;
}

TEST(WildPlan, CellsAreConvexAndDoNotOverlap) {
  for (uint64_t seed = 0; seed < 300; ++seed) {
    Dice dice = dice_of(seed);
    const Plan plan = make_plan(1, 5, 4, &dice);
    ASSERT_GE(plan.cells.size(), 1u);
    ASSERT_LE(plan.cells.size(), 5u);
    EXPECT_EQ(plan.links.size(), plan.cells.size() - 1);
    for (size_t i = 0; i < plan.cells.size(); ++i) {
      const Polygon& outline = plan.cells[i].outline;
      EXPECT_GT(area_of(outline), 0) << "counter-clockwise";
      for (const Vec2& p : outline) EXPECT_TRUE(inside(outline, p, -1e-4f));
      for (size_t j = 0; j < i; ++j)
        EXPECT_TRUE(apart(outline, plan.cells[j].outline, -2e-3f)) << seed;
    }
  }
}

TEST(WildPlan, WallsEndAtTheirCeilings) {
  for (uint64_t seed = 0; seed < 200; ++seed) {
    Dice dice = dice_of(seed);
    const Plan plan = make_plan(1, 5, 4, &dice);
    for (const Cell& cell : plan.cells) {
      for (size_t e = 0; e < cell.outline.size(); ++e) {
        const Edge edge = edge_of(cell.outline, e);
        for (const Vec2& p : cell.top_of(e))
          EXPECT_NEAR(cell.height_at(edge.at(p.x)), p.y, 2e-3f) << seed;
      }
    }
  }
}

TEST(WildPlan, AWallLacksTheAreaOfItsHoles) {
  const Edge edge = edge_of(rectangle(4, 3), 0);
  const std::vector<Vec2> gable{{0, 2}, {2, 3}, {4, 2}};
  EXPECT_NEAR(surface_of(wall_mesh(edge, 0, gable, {})), 10, 1e-5);
  Hole door, window;
  door.u0 = 0.5f;
  door.u1 = 1.5f;
  door.top = {{0.5f, 2}, {1.5f, 2}};
  window.u0 = 2;
  window.u1 = 3;
  window.low = 1;
  window.top = {{2, 1.5f}, {2.5f, 2}, {3, 1.5f}};
  EXPECT_NEAR(surface_of(wall_mesh(edge, 0, gable, {door, window})), 10 - 2 - 0.75, 1e-5);
  Hole whole;  // cuts through the slopes of the top
  whole.u1 = 4;
  whole.top = {{0, 2.5f}, {4, 2.5f}};
  EXPECT_NEAR(surface_of(wall_mesh(edge, 0, gable, {whole})), 0.5, 1e-5);
}

/// Whether rays from inside every cell meet a surface.
void expect_closed(const Plan& plan, const scene::Scene& scene, uint64_t seed) {
  const pathtrace::Bvh bvh(scene);
  Rng rng(seed);
  for (const Cell& cell : plan.cells) {
    const Vec2 p = centre_of(cell.outline);
    const Vec3 eye = in_space(p, 0.5f * (cell.floor + cell.ceiling.eaves));
    for (int i = 0; i < 400; ++i) {
      const float y = rng.uniform(-1, 1), a = rng.uniform(0, 2 * kPi), r = std::sqrt(1 - y * y);
      ASSERT_TRUE(bvh.intersect({eye, {r * std::cos(a), y, r * std::sin(a)}}).valid())
          << "seed " << seed;
    }
  }
}

TEST(WildPlan, ShellsWithoutWindowsAreClosed) {
  int joined = 0;
  for (uint64_t seed = 0; seed < 500; ++seed) {
    Dice dice = dice_of(seed);
    Plan plan = make_plan(1, 5, 4, &dice);
    cut_openings(false, &plan, &dice);
    bool open = false;
    for (const Cell& cell : plan.cells) {
      open = open || cell.ceiling.kind == CeilingKind::None;
      for (const std::vector<Hole>& holes : cell.holes)
        for (const Hole& hole : holes) open = open || hole.other < 0;
    }
    if (open) continue;
    if (plan.cells.size() > 1) ++joined;
    scene::Scene scene;
    Materials materials(&scene, {8}, seed);
    Builder builder(&scene, &plan, &materials);
    build_shell(&builder, &dice, scene::kNone);
    expect_closed(plan, scene, seed);
  }
  EXPECT_GT(joined, 20);
}

}  // namespace
}  // namespace lte::datagen::wild
