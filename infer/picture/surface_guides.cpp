#include "infer/picture/surface_guides.h"

#include <algorithm>

#include "lte/base/parallel.h"

namespace lte::infer {
namespace {

/// A surface above this counts as metal.
constexpr float kMetallic = 0.05f;
constexpr int kTile = 8;
/// Pixels whose hits are there at once: a G-buffer takes more than its pictures.
constexpr int kPixelsAtOnce = 1 << 18;
constexpr int kRows = 16;  // that a thread takes at a time

SurfaceGuides empty_guides(int width, int height) {
  SurfaceGuides out;
  out.normal = out.position = out.albedo = image::Image(width, height, 3);
  out.mask.resize(static_cast<size_t>(width) * static_cast<size_t>(height));
  out.metal = out.mask;
  out.depth.resize(out.mask.size());
  return out;
}

/// Puts the hits of some rows, which begin at row `first`, into guides.
void put_hits(const pathtrace::GBuffer& hits, int first, SurfaceGuides* guides) {
  SurfaceGuides& out = *guides;
  parallel_for(hits.height, kRows, [&](int64_t begin, int64_t end) {
    for (int y = static_cast<int>(begin); y < end; ++y) {
      for (int x = 0; x < hits.width; ++x) {
        const size_t from =
            static_cast<size_t>(y) * static_cast<size_t>(hits.width) + static_cast<size_t>(x);
        const size_t to = out.index(x, first + y);
        if (!hits.mask[from]) continue;
        out.mask[to] = 1;
        out.metal[to] = !hits.metallic.empty() && hits.metallic[from] > kMetallic ? 1 : 0;
        out.depth[to] = hits.depth[from];
        out.normal.set_rgb(x, first + y, hits.normal[from]);
        out.position.set_rgb(x, first + y, hits.position[from]);
        out.albedo.set_rgb(x, first + y, hits.albedo[from]);
      }
    }
  });
}

}  // namespace

SurfaceGuides trace_guides(const pathtrace::Bvh& bvh, const scene::Camera& camera, int width,
                           int height) {
  pathtrace::check_view(camera, width, height);
  SurfaceGuides out = empty_guides(width, height);
  const int rows = std::max(1, kPixelsAtOnce / width);
  for (int first = 0; first < height; first += rows) {
    const int last = std::min(first + rows, height);
    put_hits(pathtrace::trace_gbuffer_rows(bvh, camera, width, height, first, last), first, &out);
  }
  return out;
}

SurfaceGuides guides_of(const pathtrace::GBuffer& hits) {
  SurfaceGuides out = empty_guides(hits.width, hits.height);
  put_hits(hits, 0, &out);
  return out;
}

SurfacePoints points_of(const SurfaceGuides& guides) {
  SurfacePoints out;
  for (int tile_y = 0; tile_y < guides.height(); tile_y += kTile) {
    for (int tile_x = 0; tile_x < guides.width(); tile_x += kTile) {
      for (int y = tile_y; y < std::min(tile_y + kTile, guides.height()); ++y) {
        for (int x = tile_x; x < std::min(tile_x + kTile, guides.width()); ++x) {
          if (!guides.mask[guides.index(x, y)]) continue;
          out.position.push_back(guides.position.rgb(x, y));
          out.normal.push_back(guides.normal.rgb(x, y));
          out.pixel.push_back(guides.index(x, y));
        }
      }
    }
  }
  return out;
}

}  // namespace lte::infer
