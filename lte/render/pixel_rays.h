// Camera rays of some pixels into a film, and light at what they meet.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/pathtrace/gbuffer.h"
#include "lte/render/progressive.h"

namespace lte::render {

/// What camera rays pixels get, and how their hits are lit.
struct Rays {
  enum class Lit { None, Unshared, All };  ///< Unshared: hits without a light_source() alone

  int count = 1;
  Lit lit = Lit::All;
  int rays = 1, light_samples = 1;  ///< of PointSampling
};

/// Some pixels in one pass.
class PixelRays {
 public:
  /// All that is given must outlive it.
  PixelRays(const TracedScene& scene, const scene::Camera& camera, const RenderSettings& settings,
            const Rays& rays, std::span<const size_t> pixels, Film* film);

  /// Traces the camera rays and sums up what they see.
  void see();
  /// Adds light at the hits: to the pixel whose center sees the same surface, where there is one.
  /// In pixels with metal, paths through the pixel stand for that.
  /// @param next_point  number of the next random stream
  void light(const Integrator& integrator, int64_t* next_point);

 private:
  /// A hit that is lit, and the pixel whose irradiance it adds to; Film::kNoPixel: its own
  /// radiance counts.
  struct LitHit {
    size_t hit, source;
  };
  /// Rays go through the pixels' centers.
  bool is_center() const { return film_.passes == 0; }
  const scene::Material& material_of(int32_t instance) const;
  bool reflects(size_t hit) const;
  Rgb albedo(size_t hit) const;
  void add_hit(size_t pixel, size_t hit);
  void list_hits(std::vector<LitHit>* lit, std::vector<size_t>* metal);
  size_t source_of(size_t pixel, size_t hit, EdgePixel* edge);
  std::vector<pathtrace::SampleNumber> sample_numbers(const std::vector<LitHit>& lit,
                                                      int samples) const;
  void trace_metal(const std::vector<size_t>& metal, LightSums* sums);

  const TracedScene& scene_;
  const scene::Camera& camera_;
  const RenderSettings& settings_;
  const Rays rays_;
  std::span<const size_t> pixels_;
  Film& film_;
  float pixel_size_;
  pathtrace::GBuffer hits_;
};

}  // namespace lte::render
