#include "tests/nn/support.h"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "lte/base/random.h"
#include "lte/tensor/functions.h"

namespace lte::test {
namespace {

/// Thousands of operations on a few dozen rows: starting threads for each would take longer than
/// the work.
class OneThread : public ::testing::Environment {
  void SetUp() override { at::set_num_threads(1); }
};
const ::testing::Environment* const kOneThread =
    ::testing::AddGlobalTestEnvironment(new OneThread);  // owned by GoogleTest

}  // namespace

namespace {

/// @param row  writes the numbers of one, `width` of them
at::Tensor rows_of(int64_t rows, int64_t width, const std::function<void(int64_t, float*)>& row) {
  std::vector<float> numbers(static_cast<size_t>(rows * width));
  for (int64_t i = 0; i < rows; ++i) row(i, numbers.data() + i * width);
  return at::from_blob(numbers.data(), {rows, width}, at::kFloat).clone();
}

void random_surface(int64_t rows, Rng* rng, at::Tensor* position, at::Tensor* normal,
                    at::Tensor* albedo) {
  constexpr float kSize[] = {64, 48, 80};  // sixteenths of a metre
  std::vector<float> normals(static_cast<size_t>(3 * rows), 0);
  *position = rows_of(rows, 3, [&](int64_t i, float* at) {
    for (int c = 0; c < 3; ++c) at[c] = std::round(rng->uniform() * kSize[c]) / 16;
    const uint64_t axis = rng->below(3);
    const bool high = rng->below(2) == 1;
    at[axis] = high ? kSize[axis] / 16 : 0;
    normals[static_cast<size_t>(3 * i) + axis] = high ? -1 : 1;
  });
  *normal = at::from_blob(normals.data(), {rows, 3}, at::kFloat).clone();
  *albedo = rows_of(rows, 3, [&](int64_t, float* color) {
    for (int c = 0; c < 3; ++c) color[c] = rng->uniform();
  });
}

}  // namespace

nn::PointSet box_scene(int64_t M, uint64_t seed) {
  nn::PointSet points;
  Rng rng(seed);
  random_surface(M, &rng, &points.position, &points.normal, &points.albedo);
  // Of points that shine, or of the others.
  const auto light = [&](bool shines, float low, float high) {
    return rows_of(M, 3, [&](int64_t i, float* value) {
      for (int c = 0; c < 3; ++c) value[c] = (i % 10 == 0) == shines ? rng.uniform(low, high) : 0;
    });
  };
  points.emission = light(true, 5, 15);
  points.area =
      rows_of(M, 1, [&](int64_t, float* area) { *area = rng.uniform(0.01f, 0.02f); }).view({M});
  points.direct = light(false, 0, 8);
  points.indirect = light(false, 0, 3);
  // Every third point is on a sheet; the others are on closed bodies.
  const at::Tensor share =
      rows_of(M, 1, [](int64_t i, float* of) { *of = i % 3 == 0 ? 0.375f : 0; });
  points.direct_back = points.direct * share;
  points.indirect_back = points.indirect * share;
  points.indirect_error = rows_of(M, 2, [](int64_t i, float* error) {
    for (int64_t k = 0; k < 2; ++k) error[k] = static_cast<float>((2 * i + k) % 7) / 8;
  });
  return points;
}

nn::QuerySet box_queries(int64_t Q, uint64_t seed) {
  nn::QuerySet queries;
  Rng rng(seed);
  random_surface(Q, &rng, &queries.position, &queries.normal, &queries.albedo);
  return queries;
}

nn::PointSet as_double(nn::PointSet points) {
  for (at::Tensor* t : points.tensors()) {
    if (t->defined()) *t = t->to(at::kDouble);
  }
  return points;
}

nn::QuerySet as_double(nn::QuerySet queries) {
  for (at::Tensor* t : {&queries.position, &queries.normal, &queries.albedo}) {
    *t = t->to(at::kDouble);
  }
  return queries;
}

double relative_difference(const at::Tensor& a, const at::Tensor& b) {
  const auto norm = [](const at::Tensor& t) { return std::sqrt((t * t).sum().item<double>()); };
  const at::Tensor reference = b.to(at::kDouble);
  return norm(a.to(at::kDouble) - reference) / (norm(reference) + 1e-30);
}

bool same(const at::Tensor& a, const at::Tensor& b) {
  return a.scalar_type() == b.scalar_type() && a.sizes() == b.sizes() &&
         std::memcmp(a.contiguous().const_data_ptr(), b.contiguous().const_data_ptr(),
                     a.nbytes()) == 0;
}

void expect_error(const std::function<void()>& body, const std::vector<std::string>& parts) {
  try {
    body();
  } catch (const std::exception& error) {
    const std::string message = error.what();
    for (const std::string& part : parts) {
      EXPECT_NE(message.find(part), std::string::npos) << "no \"" << part << "\" in: " << message;
    }
    return;
  }
  ADD_FAILURE() << "nothing was thrown; expected \"" << (parts.empty() ? "" : parts[0]) << '"';
}

}  // namespace lte::test
