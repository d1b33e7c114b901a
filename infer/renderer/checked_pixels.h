// The pixels of a picture whose answers are checked, and what was answered there.
#pragma once

#include <cstdint>
#include <vector>

#include "infer/picture/picture_band.h"
#include "infer/renderer/light_check.h"

namespace lte::infer {

/// One pixel at random in each square of so many: some 2^16 at most, however large the picture is.
class CheckedPixels {
 public:
  CheckedPixels(int width, int height, uint64_t seed);

  /// Takes the answers of a band.
  /// @param hits       of the centres, where their light is known before the band; else null
  /// @param first_row  that `hits` begin with
  void take(const PictureBand& band, const PictureRows& rows, const BandLight& light,
            const pathtrace::GBuffer* hits, int first_row);

  /// Puts the light that paths have corrected in the place of the answers of these rows.
  /// @param frame  those rows alone
  void correct(const PictureRows& rows, const Frame& frame);

  const AnsweredLight& answers() const { return answers_; }

 private:
  int width_, square_;
  uint64_t seed_;
  AnsweredLight answers_;
  std::vector<int64_t> pixel_;  ///< y * width + x of each answer
};

}  // namespace lte::infer
