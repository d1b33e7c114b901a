// Parts of G-buffers against the whole.
#include "lte/pathtrace/gbuffer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "tests/support/scenes.h"

namespace lte::pathtrace {
namespace {

scene::Camera view() { return {"view", {3.7f, 1.5f, 2.7f}, {1, 0.8f, 1}, {0, 1, 0}, 60}; }

template <typename Values>
Values part(const Values& values, size_t first, size_t count) {
  return {values.begin() + static_cast<int64_t>(first),
          values.begin() + static_cast<int64_t>(first + count)};
}

TEST(GBuffer, RowsAndPointsAreThoseOfTheWhole) {
  scene::Scene scene = test::furnished_room();
  scene.materials[1].metallic = 0.5f;
  const Bvh bvh(scene);
  constexpr int kWidth = 21, kHeight = 14;
  const GBuffer whole = trace_gbuffer(bvh, view(), kWidth, kHeight);
  const GBuffer rows = trace_gbuffer_rows(bvh, view(), kWidth, kHeight, 5, 9);
  ASSERT_EQ(rows.height, 4);
  const size_t first = 5 * kWidth, count = 4 * kWidth;
  EXPECT_EQ(rows.position, part(whole.position, first, count));
  EXPECT_EQ(rows.normal, part(whole.normal, first, count));
  EXPECT_EQ(rows.albedo, part(whole.albedo, first, count));
  EXPECT_EQ(rows.depth, part(whole.depth, first, count));
  EXPECT_EQ(rows.instance, part(whole.instance, first, count));
  EXPECT_EQ(rows.metallic, part(whole.metallic, first, count));
  const GBuffer copy = rows_of(whole, 5, 9);
  EXPECT_EQ(copy.height, rows.height);
  EXPECT_EQ(copy.position, rows.position);
  EXPECT_EQ(copy.emission, rows.emission);
  EXPECT_EQ(copy.mask, rows.mask);
  EXPECT_EQ(copy.metallic, rows.metallic);
  EXPECT_THROW(rows_of(whole, 5, 15), Error);

  std::vector<Vec2> points;
  for (size_t i = 0; i < count; ++i) {
    const size_t pixel = first + i;
    points.push_back(
        {static_cast<float>(pixel % kWidth) + 0.5f, static_cast<float>(pixel / kWidth) + 0.5f});
  }
  GBuffer hits;
  append_image_points(bvh, view(), kWidth, kHeight, std::span(points).first(1), &hits);
  append_image_points(bvh, view(), kWidth, kHeight, std::span(points).subspan(1), &hits);
  EXPECT_EQ(hits.position, rows.position);
  EXPECT_EQ(hits.albedo, rows.albedo);
  EXPECT_EQ(hits.emission, rows.emission);
  append_image_points(bvh, view(), kWidth, kHeight, {}, &hits);
  EXPECT_EQ(hits.mask.size(), count);
  EXPECT_THROW(trace_gbuffer_rows(bvh, view(), kWidth, kHeight, 5, 15), Error);
}

TEST(GBuffer, KnowsInstancesAndMetal) {
  scene::Scene scene = test::furnished_room();
  EXPECT_TRUE(trace_gbuffer(Bvh(scene), view(), 8, 8).metallic.empty());
  scene.materials[1].metallic = 0.5f;
  const Bvh bvh(scene);
  const GBuffer hits = trace_gbuffer(bvh, view(), 24, 16);
  int boxes = 0;
  for (size_t i = 0; i < hits.mask.size(); ++i) {
    const Hit hit = bvh.intersect({view().origin, hits.position[i] - view().origin});
    ASSERT_EQ(hits.instance[i], hit.instance);
    EXPECT_EQ(hits.metallic[i], hit.instance == 1 ? 0.5f : 0.0f);
    boxes += hit.instance == 1 ? 1 : 0;
  }
  EXPECT_GT(boxes, 10);
}

}  // namespace
}  // namespace lte::pathtrace
