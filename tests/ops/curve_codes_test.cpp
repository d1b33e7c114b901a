#include "lte/ops/curve_codes.h"

#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "lte/ops/curve_codes_kernel.h"
#include "tests/ops/fixtures.h"
#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

using test::throws_saying;

constexpr Curve kCurves[] = {Curve::Z, Curve::ZTransposed, Curve::Hilbert,
                             Curve::HilbertTransposed};

/// All cells of a cube of 2^bits an axis.
at::Tensor all_cells(int64_t bits) {
  const at::Tensor line = at::arange(int64_t{1} << bits, at::kInt);
  return at::cartesian_prod({line, line, line}).contiguous();
}

at::Tensor cells_of(std::vector<int32_t> values) {
  return at::tensor(values, at::kInt).view({-1, 3});
}

class CurveCodes : public test::PerDevice {
 protected:
  /// Codes made on this device, on the CPU.
  at::Tensor codes_of(const at::Tensor& cells, Curve curve, int64_t bits = kCurveBits) const {
    const at::Tensor codes = curve_codes(put(cells), curve, bits);
    EXPECT_EQ(codes.device().type(), GetParam());
    return codes.cpu();
  }
};
LTE_FOR_EACH_DEVICE(CurveCodes);

TEST_P(CurveCodes, EqualPublishedValues) {
  // z and the transposed z by hand; Hilbert also agrees with the numpy-hilbert-curve package.
  const at::Tensor cells = cells_of(
      {1, 2, 3, 5, 3, 6, 100, 200, 300, 1023, 0, 511, 65535, 1, 32768, 12345, 54321, 33333});
  const std::vector<int64_t> expected[] = {
      {29, 350, 22710080, 632740717, 196027215923494, 116962831366215},
      {43, 238, 26839744, 325957339, 115605794006166, 195030304420935},
      {36, 304, 124266514, 939524096, 246290604621822, 87863660903127},
      {20, 390, 128460818, 441001106, 86704345504620, 244974063114181}};
  for (int c = 0; c < 4; ++c) {
    EXPECT_TRUE(at::equal(codes_of(cells, kCurves[c]), at::tensor(expected[c]))) << c;
  }
}

TEST_P(CurveCodes, ZInterleavesBitsOfTwentyOneBitCells) {
  const at::Tensor cells = test::integers(1 << 21, {1025, 3}, 3, at::kInt);
  const at::Tensor codes = codes_of(cells, Curve::Z, 21);
  for (int64_t i = 0; i < cells.size(0); ++i) {
    int64_t expected = 0;
    for (int bit = 20; bit >= 0; --bit) {
      for (int axis = 0; axis < 3; ++axis) {
        expected = expected * 2 + (cells[i][axis].item<int>() >> bit) % 2;
      }
    }
    ASSERT_EQ(codes[i].item<int64_t>(), expected) << "cell " << i;
  }
}

TEST_P(CurveCodes, VisitEveryCellOnce) {
  for (const int64_t bits : {1, 2, 3, 4}) {
    for (const Curve curve : kCurves) {
      const at::Tensor codes = codes_of(all_cells(bits), curve, bits);
      EXPECT_TRUE(at::equal(std::get<0>(codes.sort()), at::arange(codes.size(0))));
    }
  }
}

TEST_P(CurveCodes, HilbertStepsToAFaceNeighbour) {
  for (const int64_t bits : {1, 2, 4, 5}) {
    const at::Tensor cells = all_cells(bits);
    const at::Tensor path = cells.index_select(0, codes_of(cells, Curve::Hilbert, bits).argsort());
    const at::Tensor steps = path.diff(1, 0).abs().sum(1);
    EXPECT_TRUE(steps.eq(1).all().item<bool>()) << bits << " bits";
  }
}

TEST_P(CurveCodes, DroppingABitOfTheCellDropsThreeOfTheCode) {
  const at::Tensor cells = test::integers(1 << 16, {500, 3}, 5, at::kInt);
  for (const Curve curve : kCurves) {
    const at::Tensor coarse = codes_of(at::bitwise_right_shift(cells, 1).contiguous(), curve, 15);
    EXPECT_TRUE(at::equal(at::bitwise_right_shift(codes_of(cells, curve, 16), 3), coarse));
  }
}

TEST_P(CurveCodes, TransposedSwapsXAndY) {
  const at::Tensor cells = test::integers(1 << 16, {500, 3}, 6, at::kInt);
  const at::Tensor swapped = cells.index_select(1, at::tensor({1, 0, 2})).contiguous();
  EXPECT_TRUE(at::equal(codes_of(cells, Curve::ZTransposed), codes_of(swapped, Curve::Z)));
  EXPECT_TRUE(
      at::equal(codes_of(cells, Curve::HilbertTransposed), codes_of(swapped, Curve::Hilbert)));
}

TEST_P(CurveCodes, EqualTheScalarCodesInAnyNumber) {
  for (const int64_t N : {1, 3, 15, 16, 17, 100, 5000}) {
    for (const int64_t bits : {1, 2, 7, 16, 20, 21}) {
      const at::Tensor cells = test::integers(int64_t{1} << bits, {N, 3}, 71, at::kInt);
      const auto* cell = cells.const_data_ptr<int32_t>();
      for (const Curve curve : kCurves) {
        const at::Tensor codes = codes_of(cells, curve, bits);
        const auto* code = codes.const_data_ptr<int64_t>();
        for (int64_t i = 0; i < N; ++i) {
          ASSERT_EQ(code[i], curve_code(cell + 3 * i, curve, static_cast<int>(bits)))
              << "row " << i << " of " << N << ", " << bits << " bits";
        }
      }
    }
  }
}

TEST_P(CurveCodes, NoCellsGiveNoCodes) {
  EXPECT_EQ(codes_of(at::empty({0, 3}, at::kInt), Curve::Hilbert).size(0), 0);
}

TEST_P(CurveCodes, RefuseBadInput) {
  const auto refused = [](const at::Tensor& cells, Curve curve, int64_t bits, const char* words) {
    return throws_saying([&] { curve_codes(cells, curve, bits); }, words);
  };
  const at::Tensor good = put(at::zeros({4, 3}, at::kInt));
  EXPECT_TRUE(refused(good.narrow(1, 0, 2), Curve::Z, 16, "[N, 3]"));
  EXPECT_TRUE(refused(good.to(at::kLong), Curve::Z, 16, "Int"));
  EXPECT_TRUE(refused(put(at::zeros({3, 4}, at::kInt)).t(), Curve::Z, 16, "contiguous"));
  EXPECT_TRUE(refused(good, Curve::Z, 0, "bits"));
  EXPECT_TRUE(refused(good, Curve::Z, 22, "bits"));
  EXPECT_TRUE(refused(good, static_cast<Curve>(4), 16, "curve must be"));
}

// On a GPU a kernel asserts it.
TEST(CurveCodesOnTheCpu, RefuseCellsOutsideTheRange) {
  at::Tensor bad = at::zeros({4, 3}, at::kInt);
  bad[2][1] = 1 << 16;
  EXPECT_TRUE(throws_saying([&] { curve_codes(bad, Curve::Z); }, "row 2 of cells"));
  bad[1][0] = -1;
  EXPECT_TRUE(throws_saying([&] { curve_codes(bad, Curve::Hilbert); }, "row 1 of cells"));
}

}  // namespace
}  // namespace lte::ops
