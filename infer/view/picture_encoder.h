// Pictures on their way to a page: JPEG by libjpeg-turbo.
#pragma once

#include <string>

#include "infer/view/display_layers.h"

namespace lte::infer::view {

/// A moving, which the next picture replaces at once, or one that may stay on the screen.
enum class JpegQuality { Moving, Still };

/// The bytes of a JPEG file. A moving has quality 80 and halved chroma, a still 92 and full chroma.
/// @throws lte::Error where the library fails.
std::string encode_jpeg(const DisplayPicture& picture, JpegQuality quality);

}  // namespace lte::infer::view
