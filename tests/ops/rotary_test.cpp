#include "lte/ops/rotary.h"

#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "tests/ops/fixtures.h"
#include "tests/ops/per_device.h"

namespace lte::ops {
namespace {

constexpr int64_t kPoints = 70, kHeads = 3, kPairs = 5, kChannels = kHeads * 2 * kPairs;

class RotateHeads : public test::PerDevice {};
LTE_FOR_EACH_DEVICE(RotateHeads);

at::Tensor some_angles() { return test::uniform({kPoints, kPairs}, 51, at::kDouble) * 20 - 10; }

/// By complex numbers, in double: a pair (a, b) is a + ib and turns by e^(i angle).
at::Tensor reference(const at::Tensor& qkv, const at::Tensor& angle) {
  const at::Tensor parts = qkv.to(at::kDouble).reshape({kPoints, 3, kHeads, 2, kPairs});
  const at::Tensor z = at::complex(parts.select(3, 0), parts.select(3, 1));
  const at::Tensor turn = at::polar(at::ones_like(angle), angle).view({kPoints, 1, 1, kPairs});
  const at::Tensor w = at::cat({z.narrow(1, 0, 2) * turn, z.narrow(1, 2, 1)}, 1);
  return at::stack({at::real(w), at::imag(w)}, 3).reshape({kPoints, 3 * kChannels});
}

TEST_P(RotateHeads, TurnsPairsAsComplexNumbersAndGradientsBack) {
  const at::Tensor angle = some_angles(), cosine = put(angle.cos().to(at::kFloat)),
                   sine = put(angle.sin().to(at::kFloat));
  for (const at::ScalarType dtype : {at::kFloat, at::kDouble}) {
    const at::Tensor qkv =
        put(test::normal({kPoints, 3 * kChannels}, 52).to(dtype)).requires_grad_();
    const at::Tensor got = rotate_heads(qkv, cosine, sine, kHeads);
    EXPECT_LT(test::relative_error(got.detach().cpu(), reference(qkv.detach().cpu(), angle)), 1e-6);
    // The gradient of a dot product with w is w, turned the other way.
    const at::Tensor weight = test::normal({kPoints, 3 * kChannels}, 53);
    got.backward(put(weight.to(dtype)));
    EXPECT_LT(test::relative_error(qkv.grad().cpu(), reference(weight, -angle)), 1e-6);
  }
}

TEST_P(RotateHeads, ProductsDependOnDifferencesOfAnglesAlone) {
  const at::Tensor q = test::normal({1, 3 * kChannels}, 54).expand({kPoints, -1}).to(at::kFloat);
  const at::Tensor step = some_angles().narrow(0, 0, 1);
  const at::Tensor angle = step * at::arange(kPoints).view({-1, 1});
  const at::Tensor out = rotate_heads(put(q.contiguous()), put(angle.cos().to(at::kFloat)),
                                      put(angle.sin().to(at::kFloat)), kHeads)
                             .cpu();
  const at::Tensor query = out.narrow(1, 0, kChannels), key = out.narrow(1, kChannels, kChannels);
  const at::Tensor first = query[0].dot(key[7]), later = query[50].dot(key[57]);
  EXPECT_NEAR(first.item<float>(), later.item<float>(), 1e-3F);
  EXPECT_GT((query[0].dot(key[8]) - first).abs().item<float>(), 1e-2F);
}

TEST_P(RotateHeads, RefusesBadInput) {
  const auto refused = [&](at::IntArrayRef qkv, at::IntArrayRef angles, int64_t heads,
                           const char* words) {
    return test::throws_saying(
        [&] {
          const at::Tensor angle = put(at::zeros(angles));
          rotate_heads(put(at::zeros(qkv)), angle, angle, heads);
        },
        words);
  };
  EXPECT_TRUE(refused({4, 20}, {4, 2}, 2, "qkv must be [n, 3C]"));
  EXPECT_TRUE(refused({4, 24}, {4, 3}, 2, "cosine must be"));
  EXPECT_TRUE(refused({4, 24}, {3, 2}, 2, "cosine must be"));
}

}  // namespace
}  // namespace lte::ops
