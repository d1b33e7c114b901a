#include "infer/eval/report/contact_sheet.h"

#include <algorithm>
#include <cmath>

#include "infer/eval/report/picture_sheet.h"
#include "lte/image/png.h"
#include "lte/image/tonemap.h"

namespace lte::infer {
namespace {

using image::Image;

constexpr float kDifferenceRange = 0.25f;  // of white
constexpr int kSmallest = 192;             // pixels of a picture's width

/// |a − b| in luminance, times `factor`, in false color.
Image difference(const Image& a, const Image& b, float factor) {
  Image out(a.width, a.height, 1);
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x)
      *out.at(x, y) = factor * std::abs(luminance(a.rgb(x, y)) - luminance(b.rgb(x, y)));
  }
  return image::heat_map(out, kDifferenceRange);
}

}  // namespace

Image view_row(const ViewPicture& picture) {
  const data::View& view = picture.view;
  const auto exposure = static_cast<float>(white_exposure(picture.reference));
  const auto filled = [&](std::span<const Rgb> values) {
    return fill_mask(values, view.mask, view.width, view.height);
  };
  const Image reference = filled(picture.reference), neural = filled(picture.neural);
  std::vector<Image> columns = {image::tonemap(reference, exposure),
                                image::tonemap(neural, exposure)};
  if (picture.path_traced.empty()) {
    columns.push_back(difference(neural, reference, exposure));
  } else {
    const Image path_traced = filled(picture.path_traced);
    columns.push_back(image::tonemap(path_traced, exposure));
    columns.push_back(difference(neural, reference, exposure));
    columns.push_back(difference(path_traced, reference, exposure));
  }
  const int zoom = std::max(1, (kSmallest + view.width - 1) / view.width);
  return side_by_side(columns, zoom);
}

void ContactSheets::add(const ViewPicture& picture) {
  if (scenes_.empty() || scenes_.back() != picture.scene) {
    scenes_.push_back(picture.scene);
    rows_.clear();
  }
  rows_.push_back(view_row(picture));
  image::write_png(path(picture.scene), stacked(rows_));
}

}  // namespace lte::infer
