#include "lte/render/picture.h"

#include <algorithm>
#include <utility>

#include "lte/base/parallel_each.h"
#include "lte/render/combine.h"
#include "lte/render/half_size.h"
#include "lte/render/lost_detail.h"

namespace lte::render {
namespace {

using image::Image;
using pathtrace::RadianceLayers;

constexpr int64_t kPixelsAtOnce = 1 << 14;
/// See edge_share().
constexpr float kEdgeBound = 1;
/// Least albedo of a pixel that sends out reflected light.
constexpr float kMinAlbedo = 1e-4f;

/// Albedo, normals, depth and emission as means over pixels, and counts.
Frame surfaces_of(const Film& film) {
  Frame out;
  out.albedo = film.mean(film.albedo);
  out.normal = film.normal;
  out.emission = film.mean(film.emission);
  out.depth = Image(film.width, film.height, 1);
  parallel_each(film.pixels(), kPixelsAtOnce, [&](size_t i) {
    const Vec3 sum = film.normal.rgb(i);
    const float size = length(sum);
    out.normal.set_rgb(i, size > 0 ? sum * (1 / size) : Vec3{});
    if (film.sees_surface(i))
      out.depth.pixels[i] = film.depth[i] / static_cast<float>(film.surface_hits[i]);
  });
  for (size_t i = 0; i < film.pixels(); ++i) {
    if (!film.sees_surface(i)) ++out.background;
    if (film.sees_metal(i)) ++out.metal_pixels;
    if (film.metal.empty() || !film.sees_surface(i)) continue;
    const auto hits = static_cast<double>(film.surface_hits[i]);
    out.metal += double{film.metal[i]} / hits;
    out.metal_by_default += double{film.default_metal[i]} / hits;
  }
  return out;
}

/// Of whole pixels.
DenoisingGuides guides_of(const Film& film, const Frame& frame, const image::Denoiser& denoiser) {
  DenoisingGuides out{frame.albedo, film.mean(film.normal), film.center_position};
  // Open Image Denoise sees how much of a pixel a surface covers; the other filter tells surfaces
  // apart by unit normals.
  if (!denoiser.is_oidn()) out.normal = frame.normal;
  parallel_each(film.pixels(), kPixelsAtOnce, [&](size_t i) {
    if (film.sees_metal(i)) out.albedo.set_rgb(i, {1, 1, 1});
  });
  return out;
}

Image sum(const Image& a, const Image& b) {
  Image out = a;
  parallel_each(out.pixels.size(), kPixelsAtOnce, [&](size_t k) { out.pixels[k] += b.pixels[k]; });
  return out;
}

bool any(const Image& image) {
  return std::ranges::any_of(image.pixels, [](float value) { return value != 0; });
}

/// Scales both layers so that their sum is `total`.
void share_out(const Image& total, RadianceLayers* layers) {
  const bool indirect_alone = !any(layers->direct), direct_alone = !any(layers->indirect);
  parallel_each(total.pixels.size(), kPixelsAtOnce, [&](size_t k) {
    float &direct = layers->direct.pixels[k], &indirect = layers->indirect.pixels[k];
    const float before = direct + indirect;
    const float share = indirect_alone ? 0 : direct_alone ? 1 : before > 0 ? direct / before : 0;
    direct = share * total.pixels[k];
    indirect = total.pixels[k] - direct;
  });
}

/// Takes noise out of the sum of both layers. Their shares in it are those of the layers denoised
/// by themselves, as the noisy ratio would put its noise into both.
/// @param guides  without light
void denoise(image::NoisyPicture guides, const PictureSettings& settings, RadianceLayers* light) {
  const auto without_noise = [&](const Image& noisy) {
    guides.light = &noisy;
    return settings.denoiser->denoise(guides, settings.quality);
  };
  const Image total = without_noise(sum(light->direct, light->indirect));
  if (settings.layers && any(light->direct) && any(light->indirect)) {
    light->direct = without_noise(light->direct);
    light->indirect = without_noise(light->indirect);
  }
  share_out(total, light);
}

/// Takes noise out of light at surfaces: of direct light, which has shadows, pixel by pixel unless
/// it is to be fast; of indirect light at half size. Metal's light is that of whole pixels.
void denoise_gathered(const Film& film, const PictureSettings& settings, RadianceLayers* light) {
  const bool metal = std::ranges::count(film.has_metal, 1) > 0;
  const auto whole = [&](const Image& noisy) {
    return settings.denoiser->denoise(
        {&noisy, &film.center_normal, &film.center_position, nullptr, nullptr}, settings.quality);
  };
  if (any(light->direct)) {
    light->direct =
        settings.quality == image::OidnQuality::Fast && !metal
            ? denoise_at_half_size(film, light->direct, *settings.denoiser, settings.quality)
            : whole(light->direct);
  }
  if (!any(light->indirect)) return;
  Image indirect =
      denoise_at_half_size(film, light->indirect, *settings.denoiser, settings.quality);
  if (metal) {
    const Image of_metal = whole(light->indirect);
    parallel_each(film.pixels(), kPixelsAtOnce, [&](size_t i) {
      if (film.sees_metal(i)) indirect.set_rgb(i, of_metal.rgb(i));
    });
  }
  light->indirect = std::move(indirect);
}

/// Of what hits at an edge found by themselves, one or two samples of light, the share that leaves
/// them at most kEdgeBound times as bright as the brightest surface around: nothing else takes
/// their noise away.
float edge_share(const Film& film, size_t pixel, const Image& centers, const Rgb& found,
                 const EdgePixel& edge) {
  float brightest = 0;
  for (size_t k = 0; k < kNearPixels.size(); ++k) {
    const size_t near = film.near_pixel(pixel, k);
    if (near != Film::kNoPixel && !film.sees_metal(near))
      brightest = std::max(brightest, luminance(centers.rgb(near)));
  }
  const float bound = kEdgeBound * brightest * luminance(edge.lit_albedo);
  const float bright = kPi * luminance(found);
  return bright > bound ? bound / bright : 1;
}

/// What pixels show of light at surfaces.
/// @param centers  Film::gathered
/// @param albedo   of pixels; null: irradiance is wanted
/// @param smooth   no noise is to be seen
RadianceLayers seen_light(const Film& film, const RadianceLayers& centers, const Image* albedo,
                          bool smooth) {
  RadianceLayers out = centers;
  const auto put = [&](size_t i, const Rgb& direct, const Rgb& indirect, float scale) {
    out.direct.set_rgb(i, direct * scale);
    out.indirect.set_rgb(i, indirect * scale);
  };
  parallel_each(film.pixels(), kPixelsAtOnce, [&](size_t i) {
    if (film.sees_metal(i)) return;
    const EdgePixel* const edge = film.edge(i);
    if (edge == nullptr) {
      const Rgb reflected = albedo == nullptr ? Rgb{kPi, kPi, kPi} : albedo->rgb(i);
      put(i, reflected * centers.direct.rgb(i), reflected * centers.indirect.rgb(i), 1 / kPi);
      return;
    }
    Rgb direct = edge->direct * kPi, indirect = edge->indirect * kPi;
    if (smooth) {
      direct = direct * edge_share(film, i, centers.direct, edge->direct, *edge);
      indirect = indirect * edge_share(film, i, centers.indirect, edge->indirect, *edge);
    }
    for (size_t k = 0; k < kNearPixels.size(); ++k) {
      if (!(max_component(edge->albedo[k]) > 0)) continue;
      size_t source = film.near_pixel(i, k);
      if (film.sees_metal(source)) source = i;  // since a later pass, and its light is radiance
      direct += edge->albedo[k] * centers.direct.rgb(source);
      indirect += edge->albedo[k] * centers.indirect.rgb(source);
    }
    put(i, direct, indirect, 1 / (kPi * static_cast<float>(std::max(1, edge->rays))));
  });
  return out;
}

/// What an integrator found.
/// @param noisy_indirect  takes indirect irradiance as it is before denoising
RadianceLayers gathered_light(const Film& film, const Frame& frame, const PictureSettings& settings,
                              Image* noisy_indirect) {
  RadianceLayers light = film.gathered.mean();
  *noisy_indirect = light.indirect;
  parallel_each(film.pixels(), kPixelsAtOnce, [&](size_t i) {
    if (film.sees_metal(i)) noisy_indirect->set_rgb(i, noisy_indirect->rgb(i) * kPi);
  });
  if (settings.denoiser != nullptr) {
    denoise_gathered(film, settings, &light);
    restore_lost_detail(film, &LightSums::direct, &light.direct);
    restore_lost_detail(film, &LightSums::indirect, &light.indirect);
  }
  return seen_light(film, light, settings.output == Output::Irradiance ? nullptr : &frame.albedo,
                    settings.denoiser != nullptr);
}

RadianceLayers path_light(const Film& film, const DenoisingGuides& guides,
                          const PictureSettings& settings) {
  RadianceLayers out = film.paths.mean();
  if (settings.denoiser != nullptr)
    denoise({nullptr, &guides.normal, &guides.position, &guides.albedo, nullptr}, settings, &out);
  return out;
}

void correct_by_paths(const Film& film, const DenoisingGuides& guides,
                      const image::Denoiser& denoiser, RadianceLayers* light) {
  std::array<Image, 2> halves;
  for (size_t h = 0; h < 2; ++h) {
    const RadianceLayers half = film.paths.mean_of(h);
    halves[h] = sum(half.direct, half.indirect);
  }
  share_out(combine(denoiser, guides, sum(light->direct, light->indirect), halves), light);
}

/// Camera rays and paths both see what shines.
void add_emission_of_paths(const Film& film, Image* emission) {
  parallel_each(film.pixels(), kPixelsAtOnce, [&](size_t i) {
    Rgb sum = film.emission.rgb(i);
    int32_t count = film.rays[i];
    for (const LightSums& half : film.paths.halves) {
      if (half.empty()) continue;
      sum += half.emission.rgb(i);
      count += half.samples[i];
    }
    if (count > 0) emission->set_rgb(i, sum * (1 / static_cast<float>(count)));
  });
}

/// Irradiance layers under which the frame's parts are its light.
void put_light(RadianceLayers light, const PictureSettings& settings, Frame* frame) {
  if (!settings.layers) light.indirect = sum(light.direct, light.indirect);
  frame->indirect = std::move(light.indirect);
  if (settings.layers) frame->direct = std::move(light.direct);
  if (settings.output == Output::Irradiance) return;
  parallel_each(frame->indirect.pixels.size(), kPixelsAtOnce, [&](size_t k) {
    float* const direct = settings.layers ? &frame->direct.pixels[k] : nullptr;
    float& indirect = frame->indirect.pixels[k];
    if (!(indirect + (direct ? *direct : 0) > 0)) return;
    float& albedo = frame->albedo.pixels[k];
    albedo = std::max(albedo, kMinAlbedo);
    indirect *= kPi / albedo;
    if (direct) *direct *= kPi / albedo;
  });
}

}  // namespace

Image compose(const Frame& frame, Output output) {
  if (output == Output::Albedo) return frame.albedo;
  if (output == Output::Normal) return frame.normal;
  if (output == Output::Depth) return frame.depth;
  if (output == Output::Irradiance) return frame.indirect;
  Image out(frame.albedo.width, frame.albedo.height, 3);
  if (output == Output::Full) out = frame.emission;
  const auto add = [&](const Image& irradiance) {
    if (irradiance.width == 0) return;
    parallel_each(out.pixels.size(), kPixelsAtOnce, [&](size_t k) {
      out.pixels[k] += frame.albedo.pixels[k] * irradiance.pixels[k] / kPi;
    });
  };
  if (output != Output::Gi) add(frame.direct);
  if (output != Output::Direct) add(frame.indirect);
  return out;
}

Frame make_picture(const Film& film, const PictureSettings& wanted) {
  PictureSettings settings = wanted;
  if (settings.output != Output::Full) settings.layers = true;  // which are those wanted
  Frame out = surfaces_of(film);
  const bool gathers = !film.gathered.empty(), traces = !film.paths.empty();
  if (gathers || traces) {
    DenoisingGuides guides;
    if (traces && settings.denoiser != nullptr) guides = guides_of(film, out, *settings.denoiser);
    RadianceLayers light = gathers ? gathered_light(film, out, settings, &out.gathered_indirect)
                                   : path_light(film, guides, settings);
    if (gathers && settings.denoiser != nullptr && film.path_passes > 1)
      correct_by_paths(film, guides, *settings.denoiser, &light);
    if (traces) add_emission_of_paths(film, &out.emission);
    put_light(std::move(light), settings, &out);
  }
  out.color = compose(out, settings.output);
  return out;
}

}  // namespace lte::render
