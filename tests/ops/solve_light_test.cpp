// Light solved on tensors: against lte/radiosity on the CPU, and the CUDA twin against the CPU.
#include "lte/ops/solve_light.h"

#include <cmath>

#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "lte/ops/solve_light_twin.h"
#include "lte/radiosity/point_radiosity.h"
#include "tests/ops/fixtures.h"
#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

using test::throws_saying;

struct LitRoom {
  at::Tensor position, normal, albedo, emission, area;
};

/// The inside of a box of 4 x 2.5 x 5 m with a lamp under its ceiling, a board in it, and a point
/// of light outside.
LitRoom lit_room(int64_t count) {
  const at::Tensor draw = test::uniform({count, 4}, 3);
  LitRoom out{at::empty({count, 3}), at::zeros({count, 3}), test::uniform({count, 3}, 4),
              at::zeros({count, 3}), at::full({count}, 80.0f / static_cast<float>(count))};
  const float size[3] = {4, 2.5f, 5};
  for (int64_t i = 0; i < count; ++i) {
    const float* u = draw.const_data_ptr<float>() + 4 * i;
    float* p = out.position.data_ptr<float>() + 3 * i;
    const auto face = static_cast<int>(6.999f * u[3]), axis = face / 2 % 3;
    for (int a = 0; a < 3; ++a) p[a] = size[a] * u[a];
    if (face == 6) {  // the board
      p[0] = 1.5f;
      p[1] = 1.5f * u[1];
      out.normal[i][0] = 1;
      continue;
    }
    p[axis] = face % 2 == 0 ? 0 : size[axis];
    out.normal[i][axis] = face % 2 == 0 ? 1 : -1;
    if (face == 3 && std::abs(p[0] - 2) < 0.5f && std::abs(p[2] - 2) < 0.5f) {
      p[1] -= 0.05f;
      out.emission[i].fill_(5);
    }
  }
  if (count > 0) {
    out.position[0] = at::tensor({2.0f, 9.0f, 2.0f});
    out.normal[0] = at::tensor({0.0f, -1.0f, 0.0f});
    out.emission[0].fill_(30);
  }
  return out;
}

at::Tensor solve_room(const LitRoom& r) {
  return solve_light(r.position, r.normal, r.albedo, r.emission, r.area);
}

std::span<const Vec3> as_triples(const at::Tensor& t) {
  return {reinterpret_cast<const Vec3*>(t.const_data_ptr<float>()), static_cast<size_t>(t.size(0))};
}

class SolveLight : public test::PerDevice {
 protected:
  LitRoom put_room(const LitRoom& r) const {
    return {put(r.position), put(r.normal), put(r.albedo), put(r.emission), put(r.area)};
  }
};
LTE_FOR_EACH_DEVICE(SolveLight);

// Bit for bit on the CPU. On a GPU a pair that rounding makes see each other moves single points.
TEST_P(SolveLight, IsTheSolutionOfRadiosity) {
  for (const int64_t count : {0, 1, 2, 300, 3000}) {
    const LitRoom r = lit_room(count);
    const radiosity::PointIrradiance light = radiosity::solve(
        {as_triples(r.position), as_triples(r.normal), as_triples(r.albedo), as_triples(r.emission),
         std::span(r.area.const_data_ptr<float>(), static_cast<size_t>(count))},
        1);
    const at::Tensor got = solve_room(put_room(r));
    ASSERT_EQ(got.sizes(), (at::IntArrayRef{count, SolvedColumn::kCount}));
    EXPECT_EQ(got.device().type(), GetParam());
    const std::vector<std::pair<int64_t, const std::vector<Rgb>*>> parts = {
        {SolvedColumn::kDirect, &light.direct},
        {SolvedColumn::kIndirect, &light.indirect},
        {SolvedColumn::kDirectBack, &light.direct_back},
        {SolvedColumn::kIndirectBack, &light.indirect_back}};
    for (const auto& [column, part] : parts) {
      const at::Tensor mine = got.narrow(1, column, 3).cpu().contiguous();
      const at::Tensor expected =
          at::from_blob(const_cast<Rgb*>(part->data()), {count, 3}, at::kFloat).clone();
      if (on_cpu()) {
        EXPECT_TRUE(at::equal(mine, expected)) << "column " << column << " of " << count;
        continue;
      }
      const double mean = expected.abs().mean().item<double>();
      EXPECT_LE((mine - expected).abs().mean().item<double>(), 2e-3 * mean)
          << "column " << column << " of " << count;
    }
  }
}

/// The kernels of the CUDA twin, which the CPU can run too.
struct LoopKernels {
  void direct(const LitView& view, const at::Tensor& rows, const at::Tensor& light) const {
    const auto* row = rows.const_data_ptr<int64_t>();
    for (int64_t k = 0; k < rows.size(0); ++k)
      direct_at(view, row[k], light.data_ptr<float>() + 6 * k);
  }
  void links(const LitView& view, const at::Tensor& rows, const at::Tensor& senders,
             const at::Tensor& areas, const at::Tensor& links) const {
    const int64_t S = senders.size(0);
    const auto *row = rows.const_data_ptr<int64_t>(), *sender = senders.const_data_ptr<int64_t>();
    const auto* area = areas.const_data_ptr<float>();
    for (int64_t r = 0; r < rows.size(0); ++r) {
      for (int64_t s = 0; s < S; ++s) {
        const Transfer t = link_of(view, row[r], sender[s], area[s]);
        links.data_ptr<float>()[(2 * r + t.to_back) * 2 * S + t.from_back * S + s] = t.weight;
      }
    }
  }
};

TEST(SolveLightTwin, KernelsOfAGpuGiveTheSolutionOfTheCpu) {
  for (const int64_t count : {0, 1, 2, 300, 3000}) {
    const LitRoom r = lit_room(count);
    const at::Tensor expected = solve_room(r);
    const LoopKernels kernels;
    const at::Tensor got =
        LightTwin(r.position, r.normal, r.albedo, r.emission, r.area, kernels).run();
    ASSERT_EQ(got.sizes(), expected.sizes());
    // Products of matrices sum in another order.
    EXPECT_TRUE(at::allclose(got, expected, 1e-4, 1e-6)) << count;
  }
}

TEST(SolveLightTwin, MarchesOneByOneAsManyAtOnce) {
  const LitRoom r = lit_room(2000);
  const radiosity::OccupancyGrid grid(as_triples(r.position), as_triples(r.normal), 0.1f);
  const radiosity::MarkedGrid& marked = grid.marked();
  std::vector<float> surfels;
  for (const radiosity::Surfel& s : marked.surfels) {
    for (const Vec3& v : {s.middle, s.normal}) surfels.insert(surfels.end(), {v.x, v.y, v.z});
  }
  const BlockedView view{marked.clearance.data(),
                         surfels.data(),
                         {marked.shape.low.x, marked.shape.low.y, marked.shape.low.z},
                         marked.shape.cell,
                         marked.shape.inverse,
                         {marked.shape.size[0], marked.shape.size[1], marked.shape.size[2]}};
  int64_t blocked = 0, seen = 0;
  for (int64_t i = 0; i < 40; ++i) {
    const float* a = r.position.const_data_ptr<float>() + 3 * (37 * i);
    std::vector<uint8_t> visible;
    grid.see({a[0], a[1], a[2]}, as_triples(r.position), &visible);
    for (int64_t j = 0; j < r.position.size(0); ++j) {
      const bool sees_it =
          sees(view, triple_at(a), triple_at(r.position.const_data_ptr<float>() + 3 * j));
      EXPECT_EQ(sees_it, visible[static_cast<size_t>(j)] != 0) << i << " to " << j;
      ++(sees_it ? seen : blocked);
    }
  }
  EXPECT_GT(blocked, 1000);
  EXPECT_GT(seen, 1000);
}

TEST_P(SolveLight, PointsThatEmitCarryNone) {
  const LitRoom r = lit_room(1500);
  const at::Tensor light = solve_room(put_room(r)).cpu();
  const at::Tensor emits = r.emission.amax({1}).gt(0);
  ASSERT_GT(emits.sum().item<int64_t>(), 1);
  EXPECT_EQ(light.index({emits}).abs().max().item<float>(), 0);
  EXPECT_GT(light.narrow(1, SolvedColumn::kIndirect, 3).mean().item<float>(), 0);
}

TEST_P(SolveLight, RefusesBadInput) {
  const LitRoom good = put_room(lit_room(10));
  const auto refused = [&](LitRoom r, const char* words) {
    return throws_saying([&] { solve_room(r); }, words);
  };
  LitRoom r = good;
  r.normal = put(at::zeros({9, 3}));
  EXPECT_TRUE(refused(r, "normal must be [10, 3]"));
  r = good;
  r.area = put(at::zeros({10, 1}));
  EXPECT_TRUE(refused(r, "area must be [10]"));
  r = good;
  r.albedo = r.albedo.to(at::kDouble);
  EXPECT_TRUE(refused(r, "albedo must be Float"));
  r = good;
  r.emission = put(at::zeros({3, 10})).t();
  EXPECT_TRUE(refused(r, "emission must be contiguous"));
}

TEST(SolveLightOnTheCpu, RefusesWhatIsNotFinite) {
  LitRoom r = lit_room(10);
  r.emission[4][1] = NAN;
  EXPECT_TRUE(throws_saying([&] { solve_room(r); }, "row 4 of emission"));
  r = lit_room(10);
  r.area[7] = INFINITY;
  EXPECT_TRUE(throws_saying([&] { solve_room(r); }, "row 7 of area"));
}

}  // namespace
}  // namespace lte::ops
