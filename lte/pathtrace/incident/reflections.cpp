#include "lte/pathtrace/incident/reflections.h"

#include <cmath>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/pathtrace/embree_scene.h"
#include "lte/pathtrace/gbuffer.h"
#include "lte/pathtrace/materials/glossy_bsdf.h"
#include "lte/pathtrace/materials/lambert.h"

namespace lte::pathtrace {
namespace {

constexpr int64_t kPixelBlock = 64;

/// The i-th of n points of Hammersley's set, shifted on the torus.
Vec2 shifted_point(int i, int n, const Vec2& shift) {
  uint32_t bits = static_cast<uint32_t>(i);
  float mirrored = 0;
  for (float digit = 0.5f; bits != 0; bits >>= 1, digit *= 0.5f)
    if ((bits & 1) != 0) mirrored += digit;
  const auto wrap = [](float x) { return std::min(x - std::floor(x), 1 - 0x1p-24f); };
  const float along = (static_cast<float>(i) + 0.5f) / static_cast<float>(n);
  return {wrap(along + shift.x), wrap(mirrored + shift.y)};
}

/// What one place in a pixel meets.
struct Place {
  scene::Surface surface;
  Vec3 normal;  ///< of the visible side
  Vec3 outgoing;
  bool met = false;
};

class Drawer {
 public:
  Drawer(const Bvh& bvh, const scene::Camera& camera, int width, int height,
         const ReflectionOptions& options)
      : bvh_(bvh),
        camera_(camera),
        width_(static_cast<float>(width)),
        height_(static_cast<float>(height)),
        pixel_size_(pixel_size(camera, height)),
        columns_(width),
        options_(options) {}

  /// Appends the draws of pixel number `number` of the list.
  void draw(int64_t pixel, int32_t number, Reflections* out) const {
    Rng rng(options_.seed, hash_combine(0x7265666c, static_cast<uint64_t>(pixel)));
    const Vec2 place_shift{rng.uniform(), rng.uniform()}, shift{rng.uniform(), rng.uniform()};
    const int total = options_.points * options_.directions;
    for (int p = 0; p < options_.points; ++p) {
      const Vec2 inside = shifted_point(p, options_.points, place_shift);
      const Place place = look({static_cast<float>(pixel % columns_) + inside.x,
                                static_cast<float>(pixel / columns_) + inside.y});
      if (!place.met) continue;
      out->pixel.push_back(number);
      out->position.push_back(place.surface.position);
      out->normal.push_back(place.normal);
      out->albedo.push_back(place.surface.albedo);
      for (int d = 0; d < options_.directions; ++d) {
        // Directions of one place are as far apart in the set as those of different places.
        const ScatteringSample sample =
            scatter(place, shifted_point(d * options_.points + p, total, shift));
        const bool came = sample.pdf > 0 && dot(sample.direction, place.normal) > 0;
        out->direction.push_back(came ? sample.direction : place.normal);
        out->weight.push_back(came ? sample.weight : Rgb{});
      }
    }
  }

 private:
  Place look(const Vec2& point) const {
    const Vec3 direction = camera_.direction(point.x / width_, point.y / height_, width_ / height_);
    const Hit hit = bvh_.intersect({camera_.origin, direction});
    Place place;
    if (!hit.valid()) return place;
    place.surface = scene::evaluate_surface(bvh_.scene(), hit.instance, hit.triangle, hit.u, hit.v,
                                            hit.t * pixel_size_);
    place.outgoing = -normalize(direction);
    place.normal = dot(hit.normal, place.outgoing) >= 0 ? hit.normal : -hit.normal;
    place.met = max_component(place.surface.albedo) > 0;
    return place;
  }

  static ScatteringSample scatter(const Place& place, const Vec2& u) {
    const scene::Gloss& gloss = place.surface.gloss;
    if (gloss.metallic > 0)
      return GlossyBsdf(place.surface.albedo, gloss.metallic, gloss.roughness, place.normal,
                        place.outgoing)
          .sample(u);
    ScatteringSample sample;
    sample.direction = sample_lambert(place.normal, u, &sample.pdf);
    sample.weight = place.surface.albedo;
    return sample;
  }

  const Bvh& bvh_;
  const scene::Camera& camera_;
  float width_, height_, pixel_size_;
  int64_t columns_;
  const ReflectionOptions& options_;
};

template <typename T>
void append(const std::vector<T>& from, std::vector<T>* to) {
  to->insert(to->end(), from.begin(), from.end());
}

}  // namespace

Reflections draw_reflections(const Bvh& bvh, const scene::Camera& camera, int width, int height,
                             std::span<const int64_t> pixels, const ReflectionOptions& options) {
  check_view(camera, width, height);
  LTE_CHECK(options.points >= 1 && options.directions >= 1,
            "reflections: points and directions must be positive, got ", options.points, " and ",
            options.directions);
  const Drawer drawer(bvh, camera, width, height, options);
  const auto count = static_cast<int64_t>(pixels.size());
  std::vector<Reflections> blocks(static_cast<size_t>((count + kPixelBlock - 1) / kPixelBlock));
  parallel_for(static_cast<int64_t>(blocks.size()), 1, [&](int64_t begin, int64_t end) {
    for (int64_t block = begin; block < end; ++block) {
      const int64_t last = std::min(count, (block + 1) * kPixelBlock);
      for (int64_t i = block * kPixelBlock; i < last; ++i)
        drawer.draw(pixels[static_cast<size_t>(i)], static_cast<int32_t>(i),
                    &blocks[static_cast<size_t>(block)]);
    }
  });
  Reflections out;
  for (const Reflections& block : blocks) {
    append(block.pixel, &out.pixel);
    append(block.position, &out.position);
    append(block.normal, &out.normal);
    append(block.albedo, &out.albedo);
    append(block.direction, &out.direction);
    append(block.weight, &out.weight);
  }
  return out;
}

}  // namespace lte::pathtrace
