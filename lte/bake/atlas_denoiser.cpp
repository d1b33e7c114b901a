#include "lte/bake/atlas_denoiser.h"

#include <utility>

#include "lte/bake/finish.h"

namespace lte::bake {

std::optional<AtlasDenoiser> AtlasDenoiser::find(const Atlas& atlas, const Texels& texels,
                                                 std::span<const uint8_t> dark) {
  std::optional<image::Oidn> oidn = image::Oidn::find();
  if (!oidn) return std::nullopt;
  return AtlasDenoiser(atlas, texels, dark, std::move(*oidn));
}

AtlasDenoiser::AtlasDenoiser(const Atlas& atlas, const Texels& texels,
                             std::span<const uint8_t> dark, image::Oidn oidn)
    : atlas_(atlas),
      texels_(texels),
      mask_(make_mask(atlas, texels, dark)),
      oidn_(std::move(oidn)) {}

std::vector<Rgb> AtlasDenoiser::operator()(const std::vector<Rgb>& light) const {
  image::Image picture(atlas_.width, atlas_.height, 3);
  picture.pixels = paint(atlas_, texels_, light, mask_);
  // Better quality takes twice the time and finds no better light.
  const image::Image clean = oidn_.denoise(picture, {}, image::OidnQuality::Fast);
  std::vector<Rgb> out(light.size());
  for (size_t i = 0; i < out.size(); ++i) {
    const float* at = &clean.pixels[size_t{3} * texels_.pixel[i]];
    out[i] = {at[0], at[1], at[2]};
  }
  return out;
}

}  // namespace lte::bake
