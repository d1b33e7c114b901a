// How far a picture is from its reference.
#pragma once

#include "lte/image/image.h"

namespace lte::infer {

/// NaN where there is nothing to compare.
struct PictureScore {
  double mse = 0;     ///< of radiance
  double relmse = 0;  ///< of radiance over the reference's mean: (a − b)² / (b² + 0.01)
  double flip = 0;    ///< of pictures displayed at the reference's exposure, mean over pixels
  double ssim = 0;    ///< likewise
  double mean = 0;    ///< of radiance over the reference's mean
};

/// What the noise of a reference adds to errors against it, mean squared and relative.
struct ReferenceNoise {
  double mse = 0, relmse = 0;
};

/// `score` without what the reference's noise adds to it.
PictureScore without(const ReferenceNoise& noise, PictureScore score);

/// PictureScore::relmse. NaN for a reference that is dark all over.
double relative_mse(const image::Image& picture, const image::Image& reference);

/// @param picture  may be empty
/// @throws lte::Error if the sizes differ, or a side is under 11 pixels.
PictureScore score_picture(const image::Image& picture, const image::Image& reference);

/// The mean of each figure.
class ScoreMean {
 public:
  void add(const PictureScore& score);
  PictureScore mean() const;

 private:
  PictureScore sum_;
  int count_ = 0;
};

}  // namespace lte::infer
