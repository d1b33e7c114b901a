#include "lte/render/picture.h"

#include <algorithm>
#include <utility>

#include "lte/base/parallel.h"
#include "lte/render/combine.h"

namespace lte::render {
namespace {

using image::Image;
using pathtrace::RadianceLayers;

constexpr int64_t kPixelsAtOnce = 1 << 14;
/// Least albedo of a pixel that sends out reflected light.
constexpr float kMinAlbedo = 1e-4f;

template <typename Use>
void for_pixels(size_t count, const Use& use) {
  parallel_for(static_cast<int64_t>(count), kPixelsAtOnce, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) use(i);
  });
}

Rgb quotient(const Rgb& a, const Rgb& b) {
  return {b.x > 0 ? a.x / b.x : 0, b.y > 0 ? a.y / b.y : 0, b.z > 0 ? a.z / b.z : 0};
}

/// Albedo, normals, depth and emission as means over pixels, and counts.
Frame surfaces_of(const Film& film) {
  Frame out;
  out.albedo = film.mean(film.albedo);
  out.normal = film.normal;
  out.emission = film.mean(film.emission);
  out.depth = Image(film.width, film.height, 1);
  for_pixels(film.pixels(), [&](size_t i) {
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

DenoisingGuides guides_of(const Film& film, const Frame& frame, const image::Denoiser& denoiser) {
  DenoisingGuides out{frame.albedo, film.mean(film.normal), film.position};
  // Open Image Denoise sees how much of a pixel a surface covers; the other filter tells surfaces
  // apart by unit normals.
  if (!denoiser.is_oidn()) out.normal = frame.normal;
  for_pixels(film.pixels(), [&](size_t i) {
    if (film.sees_surface(i))
      out.position.set_rgb(i, out.position.rgb(i) * (1 / static_cast<float>(film.surface_hits[i])));
    if (film.sees_metal(i)) out.albedo.set_rgb(i, {1, 1, 1});
  });
  return out;
}

Image sum(const Image& a, const Image& b) {
  Image out = a;
  for_pixels(out.pixels.size(), [&](size_t k) { out.pixels[k] += b.pixels[k]; });
  return out;
}

/// Scales both layers so that their sum is `total`.
void share_out(const Image& total, RadianceLayers* layers) {
  for_pixels(total.pixels.size(), [&](size_t k) {
    float &direct = layers->direct.pixels[k], &indirect = layers->indirect.pixels[k];
    const float before = direct + indirect;
    if (before > 0) {
      direct *= total.pixels[k] / before;
      indirect *= total.pixels[k] / before;
    } else {
      indirect = total.pixels[k];
    }
  });
}

/// What an integrator found. Its light is that of points, whose texture it has: divided by it and
/// multiplied by the pixel's albedo it is the pixel's.
/// @param noisy_indirect  takes indirect irradiance as it is before denoising
RadianceLayers gathered_light(const Film& film, const Frame& frame, const DenoisingGuides* guides,
                              const PictureSettings& settings, Image* noisy_indirect) {
  RadianceLayers out = film.gathered.mean();
  const Image points = film.gathered_albedo;
  std::vector<float> samples(film.pixels());
  for (const LightSums& half : film.gathered.halves) {
    for (size_t i = 0; i < half.samples.size(); ++i)
      samples[i] += static_cast<float>(half.samples[i]);
  }
  const auto of_points = [&](size_t i) {
    return film.sees_metal(i) ? Rgb{1, 1, 1} : points.rgb(i) * (1 / std::max(1.0f, samples[i]));
  };
  const bool irradiance = settings.output == Output::Irradiance;
  const auto of_pixel = [&](size_t i) {
    return irradiance || film.sees_metal(i) ? Rgb{1, 1, 1} : frame.albedo.rgb(i);
  };
  for_pixels(film.pixels(), [&](size_t i) {
    const Rgb scale =
        irradiance ? quotient({kPi, kPi, kPi}, of_points(i)) : quotient({1, 1, 1}, of_points(i));
    out.direct.set_rgb(i, out.direct.rgb(i) * scale);
    out.indirect.set_rgb(i, out.indirect.rgb(i) * scale);
  });
  *noisy_indirect = out.indirect;
  if (!irradiance) {
    for_pixels(noisy_indirect->pixels.size(), [&](size_t k) { noisy_indirect->pixels[k] *= kPi; });
  }
  if (guides != nullptr) {
    const Image noisy = sum(out.direct, out.indirect);
    share_out(settings.denoiser->denoise(
                  {&noisy, &guides->normal, &guides->position, nullptr, nullptr}, settings.quality),
              &out);
  }
  for_pixels(film.pixels(), [&](size_t i) {
    out.direct.set_rgb(i, out.direct.rgb(i) * of_pixel(i));
    out.indirect.set_rgb(i, out.indirect.rgb(i) * of_pixel(i));
  });
  return out;
}

RadianceLayers path_light(const Film& film, const DenoisingGuides* guides,
                          const PictureSettings& settings) {
  RadianceLayers out = film.paths.mean();
  if (guides == nullptr) return out;
  const Image noisy = sum(out.direct, out.indirect);
  share_out(
      settings.denoiser->denoise(
          {&noisy, &guides->normal, &guides->position, &guides->albedo, nullptr}, settings.quality),
      &out);
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
  for_pixels(film.pixels(), [&](size_t i) {
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
void put_light(RadianceLayers light, Frame* frame) {
  for_pixels(light.direct.pixels.size(), [&](size_t k) {
    float &direct = light.direct.pixels[k], &indirect = light.indirect.pixels[k];
    if (!(direct + indirect > 0)) return;
    float& albedo = frame->albedo.pixels[k];
    albedo = std::max(albedo, kMinAlbedo);
    direct *= kPi / albedo;
    indirect *= kPi / albedo;
  });
  frame->direct = std::move(light.direct);
  frame->indirect = std::move(light.indirect);
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
    for_pixels(out.pixels.size(), [&](size_t k) {
      out.pixels[k] += frame.albedo.pixels[k] * irradiance.pixels[k] / kPi;
    });
  };
  if (output != Output::Gi) add(frame.direct);
  if (output != Output::Direct) add(frame.indirect);
  return out;
}

Frame make_picture(const Film& film, const PictureSettings& settings) {
  Frame out = surfaces_of(film);
  const bool gathers = !film.gathered.empty(), traces = !film.paths.empty();
  if (gathers || traces) {
    DenoisingGuides guides;
    const DenoisingGuides* denoised = nullptr;
    if (settings.denoiser != nullptr) {
      guides = guides_of(film, out, *settings.denoiser);
      denoised = &guides;
    }
    RadianceLayers light =
        gathers ? gathered_light(film, out, denoised, settings, &out.gathered_indirect)
                : path_light(film, denoised, settings);
    if (gathers && traces && denoised != nullptr && film.path_passes > 1) {
      correct_by_paths(film, guides, *settings.denoiser, &light);
      out.gathered_indirect = {};
    }
    if (traces) add_emission_of_paths(film, &out.emission);
    if (settings.output == Output::Irradiance) {
      out.direct = std::move(light.direct);
      out.indirect = std::move(light.indirect);
    } else {
      put_light(std::move(light), &out);
    }
  }
  out.color = compose(out, settings.output);
  return out;
}

}  // namespace lte::render
