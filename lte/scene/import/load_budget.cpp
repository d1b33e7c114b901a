#include "lte/scene/import/load_budget.h"

#include <algorithm>
#include <array>

#include "lte/base/check.h"
#include "lte/base/text.h"
#include "lte/scene/import/limit_error.h"

namespace lte::scene {
namespace {

constexpr int64_t kFarTooMany = int64_t{1} << 60;

/// Saturates: a header may say anything.
int64_t product(int64_t a, int64_t b) {
  return b != 0 && a > kFarTooMany / b ? kFarTooMany : a * b;
}

std::string pixels_text(const DeclaredPicture& picture) {
  return concat(picture.where, ": ", picture.width, "x", picture.height, " pixels");
}

}  // namespace

std::string size_text(int64_t bytes) {
  constexpr std::array<const char*, 4> kUnits = {"kB", "MB", "GB", "TB"};
  if (bytes < 10'000) return concat(bytes, " bytes");
  double value = static_cast<double>(bytes);
  size_t unit = 0;
  for (value /= 1000; value >= 1000 && unit + 1 < kUnits.size(); value /= 1000) ++unit;
  return formatted("%.3g %s", value, kUnits[unit]);
}

void LoadBudget::add_pictures(const std::vector<DeclaredPicture>& pictures,
                              int64_t bytes_per_pixel) {
  int64_t total = picture_bytes_;
  const DeclaredPicture* first_over = nullptr;
  int64_t with_first = 0;
  for (const DeclaredPicture& picture : pictures) {
    const int64_t pixels = product(picture.width, picture.height);
    if (pixels > limits_.texture_pixels)
      throw OverLimit(concat(pixels_text(picture), " exceed the limit \"pixels\" of ",
                             limits_.texture_pixels, " for one picture"),
                      "pixels", pixels);
    total = std::min(kFarTooMany, total + product(pixels, bytes_per_pixel));
    if (first_over == nullptr && total > limits_.picture_bytes) {
      first_over = &picture;
      with_first = total;
    }
  }
  if (first_over != nullptr)
    throw OverLimit(
        concat(pixels_text(*first_over), " are too much: pictures would take ",
               size_text(with_first), " with it, ", size_text(total),
               " in all, and the limit \"pictures\" is ", size_text(limits_.picture_bytes)),
        "pictures", total);
  picture_bytes_ = total;
}

void LoadBudget::add_inflated(int64_t bytes, const std::string& where) {
  const int64_t total = inflated_ + std::min(bytes, kFarTooMany);
  if (total > limits_.inflated_bytes)
    throw OverLimit(
        concat(where, ": compressed data would take ", size_text(total),
               " with it, and the limit \"inflated\" is ", size_text(limits_.inflated_bytes)),
        "inflated", total);
  inflated_ = total;
}

}  // namespace lte::scene
