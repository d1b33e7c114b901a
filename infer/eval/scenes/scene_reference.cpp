#include "infer/eval/scenes/scene_reference.h"

#include <algorithm>
#include <utility>

#include "infer/eval/report/picture_sheet.h"
#include "infer/picture/picture_score.h"
#include "lte/base/check.h"
#include "lte/image/png.h"
#include "lte/image/tonemap.h"

namespace lte::infer {

SceneReference::SceneReference(ReferencePair pair, std::vector<uint8_t> mask, int paths)
    : pair_(std::move(pair)),
      whole_(mean_of_pair(pair_[0].whole, pair_[1].whole)),
      irradiance_(mean_of_pair(pair_[0].irradiance, pair_[1].irradiance)),
      mask_(std::move(mask)),
      paths_(paths) {
  LTE_CHECK(std::any_of(whole_.pixels.begin(), whole_.pixels.end(),
                        [](float value) { return value > 0; }),
            "no light reaches what the camera sees");
  exposure_ = image::auto_exposure(whole_);
  irradiance_exposure_ = image::auto_exposure(irradiance_, 0.95F, 0.8F, mask_);
}

MethodFigures SceneReference::compare(const ScenePictures& pictures) const {
  const ReferencePicture &a = pair_[0], &b = pair_[1];
  MethodFigures out;
  out.irradiance = pair_error(pictures.irradiance, a.irradiance, b.irradiance, mask_, paths_);
  out.whole = pair_error(pictures.whole, a.whole, b.whole, {}, paths_);
  const PictureScore score = score_picture(pictures.whole, whole_);
  out.flip = score.flip;
  out.ssim = score.ssim;
  out.seconds = pictures.seconds;
  return out;
}

std::string SceneReference::png_of(const image::Image& whole,
                                   const image::Image& irradiance) const {
  const image::Image sheet = side_by_side(
      {image::tonemap(whole, exposure_), image::tonemap(irradiance, irradiance_exposure_)}, 1);
  const std::vector<unsigned char> bytes = image::encode_png(sheet);
  return {bytes.begin(), bytes.end()};
}

}  // namespace lte::infer
