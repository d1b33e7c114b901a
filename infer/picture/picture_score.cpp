#include "infer/picture/picture_score.h"

#include <limits>

#include "lte/image/flip.h"
#include "lte/image/metrics.h"
#include "lte/image/tonemap.h"

namespace lte::infer {
namespace {

image::Image times(const image::Image& image, float factor) {
  image::Image out = image;
  for (float& value : out.pixels) value *= factor;
  return out;
}

double mean_of(const image::Image& image) {
  double sum = 0;
  for (const float value : image.pixels) sum += double{value};
  return sum / static_cast<double>(image.pixels.size());
}

}  // namespace

PictureScore without(const ReferenceNoise& noise, PictureScore score) {
  score.mse -= noise.mse;
  score.relmse -= noise.relmse;
  return score;
}

double relative_mse(const image::Image& picture, const image::Image& reference) {
  const double mean = mean_of(reference);
  if (!(mean > 0)) return std::numeric_limits<double>::quiet_NaN();
  const auto unit = static_cast<float>(1 / mean);
  return image::relative_mse(times(picture, unit).pixels, times(reference, unit).pixels, 1e-2);
}

PictureScore score_picture(const image::Image& picture, const image::Image& reference) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  if (picture.width == 0) return {nan, nan, nan, nan, nan};
  PictureScore out;
  out.mse = image::mse(picture.pixels, reference.pixels);
  out.relmse = relative_mse(picture, reference);
  const double mean = mean_of(reference);
  out.mean = mean > 0 ? mean_of(picture) / mean : nan;
  const float exposure = image::auto_exposure(reference);
  out.flip =
      image::masked_mean(image::flip(times(picture, exposure), times(reference, exposure)), {});
  out.ssim = image::ssim(image::tonemap(picture, exposure), image::tonemap(reference, exposure));
  return out;
}

void ScoreMean::add(const PictureScore& score) {
  sum_.mse += score.mse;
  sum_.relmse += score.relmse;
  sum_.flip += score.flip;
  sum_.ssim += score.ssim;
  sum_.mean += score.mean;
  ++count_;
}

PictureScore ScoreMean::mean() const {
  const double n = count_;
  return {sum_.mse / n, sum_.relmse / n, sum_.flip / n, sum_.ssim / n, sum_.mean / n};
}

}  // namespace lte::infer
