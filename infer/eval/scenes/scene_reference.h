// What the methods of a scene are compared with.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "infer/eval/measure/reference_pair.h"
#include "infer/eval/scenes/scenes.h"

namespace lte::infer {

class SceneReference {
 public:
  /// @param pair   with irradiance
  /// @param mask   irradiance_mask()
  /// @param paths  of each of both
  /// @throws lte::Error if the pictures are black
  SceneReference(ReferencePair pair, std::vector<uint8_t> mask, int paths);

  MethodFigures compare(const ScenePictures& pictures) const;

  /// Whole picture and irradiance beside each other, exposed as the reference's: PNG.
  std::string png_of(const image::Image& whole, const image::Image& irradiance) const;
  std::string png() const { return png_of(whole_, irradiance_); }

 private:
  ReferencePair pair_;
  image::Image whole_, irradiance_;  ///< means of the pair
  std::vector<uint8_t> mask_;
  int paths_;
  float exposure_ = 1, irradiance_exposure_ = 1;
};

}  // namespace lte::infer
