#include "infer/view/picture_encoder.h"

#include <memory>

#include <turbojpeg.h>

#include "lte/base/check.h"

namespace lte::infer::view {

std::string encode_jpeg(const DisplayPicture& picture, JpegQuality quality) {
  const std::unique_ptr<void, decltype(&tjDestroy)> encoder(tjInitCompress(), tjDestroy);
  LTE_CHECK(encoder != nullptr, "libjpeg-turbo: ", tjGetErrorStr());
  const bool moving = quality == JpegQuality::Moving;
  const int chroma = moving ? TJSAMP_420 : TJSAMP_444;
  std::string out(tjBufSize(picture.width, picture.height, chroma), '\0');
  auto* bytes = reinterpret_cast<unsigned char*>(out.data());
  auto size = static_cast<unsigned long>(out.size());
  const int failed = tjCompress2(encoder.get(), picture.bytes.data(), picture.width, 0,
                                 picture.height, TJPF_RGB, &bytes, &size, chroma, moving ? 80 : 92,
                                 TJFLAG_NOREALLOC | (moving ? TJFLAG_FASTDCT : 0));
  LTE_CHECK(failed == 0, "libjpeg-turbo: ", tjGetErrorStr2(encoder.get()));
  out.resize(size);
  return out;
}

}  // namespace lte::infer::view
