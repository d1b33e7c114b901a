#include "infer/picture/hit_difference.h"

#include <gtest/gtest.h>

#include "lte/base/random.h"

namespace lte::infer {
namespace {

/// Hits that differ a little or much in one thing or another.
pathtrace::GBuffer random_hits(size_t count, bool metal) {
  Rng rng(11);
  pathtrace::GBuffer hits;
  hits.width = static_cast<int>(count);
  hits.height = 1;
  const auto sometimes = [&](float usual, float other) {
    return rng.uniform() < 0.1f ? other * rng.uniform() : usual;
  };
  for (size_t i = 0; i < count; ++i) {
    const bool surface = rng.uniform() < 0.9f;
    hits.mask.push_back(surface ? 1 : 0);
    hits.instance.push_back(surface ? static_cast<int32_t>(rng.uniform() < 0.1f) : -1);
    hits.depth.push_back(surface ? 2 + rng.uniform() : INFINITY);
    hits.position.push_back({rng.uniform(), rng.uniform(), sometimes(0, 0.02f)});
    hits.normal.push_back(normalize({sometimes(0, 0.5f), 0, 1}));
    const float grey = sometimes(0.5f, 1);
    hits.albedo.push_back({grey, grey, sometimes(grey, 0.6f)});
    hits.emission.push_back({sometimes(0, 3), 0, sometimes(0, 1)});
    if (metal) hits.metallic.push_back(sometimes(0, 1));
  }
  return hits;
}

TEST(HitDifference, ManyAtOnceAreTheSameAsOneByOne) {
  constexpr size_t kCount = 1000;  // no multiple of any block
  for (const bool metal : {false, true}) {
    const pathtrace::GBuffer hits = random_hits(kCount + 300, metal);
    for (const auto& [a, b] : {std::pair<size_t, size_t>(0, 1), {3, 300}}) {
      std::vector<uint8_t> bits(kCount, 2), emissions(kCount, 2);
      constexpr float kPixel = 0.004f;
      mark_differing_hits(hits, a, b, kCount, kPixel, 8, bits.data());
      mark_differing_emissions(hits, a, b, kCount, 4, emissions.data());
      int differ = 0, shine = 0;
      for (size_t i = 0; i < kCount; ++i) {
        const bool differs = hits_differ(hits, a + i, hits, b + i, kPixel),
                   shines = emissions_differ(hits.emission[a + i], hits.emission[b + i]);
        ASSERT_EQ(bits[i], differs ? 10 : 2) << i;
        ASSERT_EQ(emissions[i], shines ? 6 : 2) << i;
        differ += differs ? 1 : 0;
        shine += shines ? 1 : 0;
      }
      EXPECT_GT(differ, 100);
      EXPECT_LT(differ, 900) << "neither all nor none";
      EXPECT_GT(shine, 50);
    }
  }
}

TEST(HitDifference, OfBackgroundNothingButTheKindCounts) {
  pathtrace::GBuffer hits = random_hits(64, false);
  for (size_t i = 0; i < 64; ++i) {
    hits.mask[i] = 0;
    hits.instance[i] = -1;
  }
  std::vector<uint8_t> bits(63);
  mark_differing_hits(hits, 0, 1, 63, 0.004f, 1, bits.data());
  EXPECT_EQ(bits, std::vector<uint8_t>(63));
}

}  // namespace
}  // namespace lte::infer
