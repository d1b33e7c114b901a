#include "infer/picture/picture_band.h"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "infer/picture/compose.h"
#include "lte/base/parallel.h"
#include "lte/scene/metal.h"

namespace lte::infer {
namespace {

using image::Image;
using pathtrace::GBuffer;

void put(Image* image, int pixel, const Rgb& value) {
  float* p = image->pixels.data() + size_t{3} * static_cast<size_t>(pixel);
  p[0] = value.x;
  p[1] = value.y;
  p[2] = value.z;
}

/// Pixels that a thread takes at a time.
constexpr int64_t kPixelsOfThread = 1 << 12, kEdgesOfThread = 1 << 8;

Rgb get(const Image& image, int pixel) {
  const float* p = image.pixels.data() + size_t{3} * static_cast<size_t>(pixel);
  return {p[0], p[1], p[2]};
}

}  // namespace

PictureBand::PictureBand(const pathtrace::Bvh& bvh, const scene::Camera& camera,
                         const PictureRows& rows, const BandOptions& options,
                         const pathtrace::GBuffer* hits, int first_row)
    : scene_(bvh.scene()),
      rows_(rows),
      pixel_size_(pathtrace::pixel_size(camera, rows.height)),
      options_(options),
      first_row_(first_row) {
  PictureRows seen = rows;
  if (options.antialias > 1) {  // the neighbours of the band's own pixels
    seen.first = std::max(0, rows.first - 1);
    seen.last = std::min(rows.height, rows.last + 1);
  }
  above_ = rows.first - seen.first;
  if (hits == nullptr) {
    own_ =
        pathtrace::trace_gbuffer_rows(bvh, camera, rows.width, rows.height, seen.first, seen.last);
  } else if (options.metal == Metal::Black && !hits->metallic.empty()) {  // which is changed
    own_ = pathtrace::rows_of(*hits, seen.first - first_row, seen.last - first_row);
  } else {
    lent_ = hits;
    first_seen_ = static_cast<size_t>(seen.first - first_row) * static_cast<size_t>(rows.width);
  }
  const EdgeView view{this->hits(), seen, pixel_size_, first_seen_};
  query_of_pixel_.assign(static_cast<size_t>(view.width()) * static_cast<size_t>(view.height()),
                         scene::kNone);
  if (options.metal == Metal::Trace && !this->hits().metallic.empty())
    is_traced_.assign(query_of_pixel_.size(), 0);
  for (size_t i = 0; i < is_traced_.size(); ++i)
    is_traced_[i] = is_metal(this->hits().metallic[first_seen_ + i]) ? 1 : 0;
  if (options.antialias > 1) take_samples(bvh, camera, view);
  darken_metal(&own_);
  list_traced();
  if (options.centres_known) {
    number_centres();
  } else {
    ask_centres();
  }
  if (options.antialias > 1)
    assign_sources(view, {query_of_pixel_, first_listed_}, &queries_, &sub_);
}

template <typename Use>
void PictureBand::each_pixel(const Use& use) const {
  parallel_for(pixels(), kPixelsOfThread, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<int>(begin); i < end; ++i) use(i);
  });
}

/// Calls use(entry of sub_) for all of them, in several threads.
template <typename Use>
void PictureBand::each_edge(const Use& use) const {
  parallel_for(
      static_cast<int64_t>(sub_.pixel.size()), kEdgesOfThread, [&](int64_t begin, int64_t end) {
        for (auto entry = static_cast<size_t>(begin); entry < static_cast<size_t>(end); ++entry)
          use(entry);
      });
}

/// Leaves the matt share of metallic surfaces alone, where metal is to be black.
void PictureBand::darken_metal(GBuffer* hits) const {
  if (options_.metal != Metal::Black || hits->metallic.empty()) return;
  for (size_t i = 0; i < hits->albedo.size(); ++i) hits->albedo[i] *= 1 - hits->metallic[i];
}

/// Traces the sub-hits of edge pixels. Pixels that have metal in them go to the path tracer, which
/// is anti-aliased by itself.
void PictureBand::take_samples(const pathtrace::Bvh& bvh, const scene::Camera& camera,
                               const EdgeView& view) {
  std::vector<int32_t> edges = find_edges(view);
  const auto first = static_cast<int32_t>(seen_index(0)),
             last = static_cast<int32_t>(seen_index(pixels()));
  std::erase_if(edges, [&](int32_t pixel) {
    return pixel < first || pixel >= last ||
           (!is_traced_.empty() && is_traced_[static_cast<size_t>(pixel)]);
  });
  sub_ = trace_sub_hits(bvh, camera, view, std::move(edges), options_.antialias);
  darken_metal(&sub_.hits);
  if (is_traced_.empty()) return;
  for (size_t entry = 0; entry < sub_.pixel.size(); ++entry) {
    bool metal = false;
    sub_.each(entry, [&](size_t s) { metal = metal || is_metal(sub_.hits.metallic[s]); });
    if (!metal) continue;
    is_traced_[static_cast<size_t>(sub_.pixel[entry])] = 1;
    sub_.each(entry, [&](size_t s) { sub_.hits.mask[s] = 0; });
  }
}

void PictureBand::list_traced() {
  if (is_traced_.empty()) return;
  for (int i = 0; i < pixels(); ++i) {
    if (is_traced_[seen_index(i)]) traced_.push_back(int64_t{rows_.first} * rows_.width + i);
  }
}

bool PictureBand::asks(int pixel) const {
  const GBuffer& hits = this->hits();
  const size_t i = hit_index(pixel);
  return hits.mask[i] && max_component(hits.albedo[i]) > 0 &&
         (is_traced_.empty() || !is_traced_[seen_index(pixel)]);
}

/// Centres whose light is known: pixels are their numbers.
void PictureBand::number_centres() {
  first_listed_ = static_cast<int32_t>(query_of_pixel_.size());
  std::atomic<int64_t> asking = 0;
  parallel_for(pixels(), kPixelsOfThread, [&](int64_t begin, int64_t end) {
    int64_t some = 0;
    for (auto i = static_cast<int>(begin); i < end; ++i) {
      if (!asks(i)) continue;
      query_of_pixel_[seen_index(i)] = static_cast<int32_t>(seen_index(i));
      ++some;
    }
    asking += some;
  });
  asking_centres_ = asking;
}

void PictureBand::ask_centres() {
  const GBuffer& hits = this->hits();
  const int width = rows_.width, height = rows_.last - rows_.first;
  // Square tiles of pixels: their shadow rays meet the same nodes and triangles.
  const auto each_tile = [&](int64_t tile_row, const auto& use) {
    const int tile_y = static_cast<int>(tile_row) * kTile;
    for (int tile_x = 0; tile_x < width; tile_x += kTile) {
      for (int y = tile_y; y < std::min(tile_y + kTile, height); ++y) {
        for (int x = tile_x; x < std::min(tile_x + kTile, width); ++x) {
          if (asks(y * width + x)) use(y * width + x);
        }
      }
    }
  };
  const int64_t tile_rows = (height + kTile - 1) / kTile;
  std::vector<size_t> first(static_cast<size_t>(tile_rows) + 1);
  parallel_for(tile_rows, 1, [&](int64_t begin, int64_t) {
    size_t count = 0;
    each_tile(begin, [&](int) { ++count; });
    first[static_cast<size_t>(begin) + 1] = count;
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  queries_.resize(first.back());
  centre_pixels_.resize(first.back());
  parallel_for(tile_rows, 1, [&](int64_t begin, int64_t) {
    size_t query = first[static_cast<size_t>(begin)];
    each_tile(begin, [&](int pixel) {
      query_of_pixel_[seen_index(pixel)] = static_cast<int32_t>(query);
      queries_.put(query, hits, hit_index(pixel));
      centre_pixels_[query++] = int64_t{rows_.first} * width + pixel;
    });
  });
  centre_queries_ = asking_centres_ = queries_.size();
}

gi::PixelSurfaces PictureBand::surfaces(std::span<const uint8_t> mask) const {
  const GBuffer& hits = this->hits();
  const auto part = [&](const auto& values) {
    return std::span(values).subspan(hit_index(0), static_cast<size_t>(pixels()));
  };
  gi::PixelSurfaces out;
  out.width = rows_.width;
  out.height = rows_.last - rows_.first;
  out.position = part(hits.position);
  out.normal = part(hits.normal);
  out.depth = part(hits.depth);
  out.mask = mask;
  out.pixel_size = pixel_size_;
  return out;
}

std::span<const int32_t> PictureBand::query_of_pixel() const {
  return std::span(query_of_pixel_).subspan(seen_index(0), static_cast<size_t>(pixels()));
}

std::vector<PictureBand::ExtraQuery> PictureBand::extra_queries() const {
  std::vector<ExtraQuery> out;
  out.reserve(static_cast<size_t>(queries_.size() - centre_queries_));
  for (size_t entry = 0; entry < sub_.pixel.size(); ++entry) {
    const int pixel = sub_.pixel[entry] - static_cast<int32_t>(seen_index(0));
    sub_.each(entry, [&](size_t s) {
      // Queries were added in this order; what names one again shares it.
      if (sub_.source[s] == first_listed_ + centre_queries_ + static_cast<int64_t>(out.size()))
        out.push_back({pixel, sub_.hits.depth[s]});
    });
  }
  return out;
}

void PictureBand::count_metal(Frame* frame) const {
  const GBuffer& hits = this->hits();
  if (hits.metallic.empty()) return;
  for (int i = 0; i < pixels(); ++i) {
    const size_t at = hit_index(i);
    if (!hits.mask[at]) continue;
    const scene::Instance& instance = scene_.instances[static_cast<size_t>(hits.instance[at])];
    const int material = scene_.meshes[static_cast<size_t>(instance.mesh)].material;
    frame->metal += double{hits.metallic[at]};
    if (scene::is_default_metal(scene_.materials[static_cast<size_t>(material)]))
      frame->metal_by_default += double{hits.metallic[at]};
  }
}

PictureBand::Layer PictureBand::layer_of(const std::optional<std::vector<Rgb>>& queries,
                                         const Image* centres) {
  return queries ? Layer{*queries, centres} : Layer{};
}

Rgb PictureBand::irradiance(const Layer& layer, int32_t query) const {
  if (query >= first_listed_) return layer.queries[static_cast<size_t>(query - first_listed_)];
  return layer.centres->rgb(static_cast<int64_t>(first_lent_row() - above_) * rows_.width + query);
}

Rgb PictureBand::edge_albedo(size_t entry) const {
  Rgb sum;
  sub_.each(entry, [&](size_t s) { sum += sub_.hits.albedo[s]; });
  return sum * (1.0f / static_cast<float>(sub_.count(entry)));
}

Vec3 PictureBand::edge_normal(size_t entry) const {
  Vec3 sum;
  sub_.each(entry, [&](size_t s) { sum += sub_.hits.normal[s]; });
  return sum * (1.0f / static_cast<float>(sub_.count(entry)));
}

/// Weighted by albedo, unless the options say otherwise.
/// @param albedo  the mean of the pixel
Rgb PictureBand::edge_irradiance(const Layer& layer, size_t entry, const Rgb& albedo) const {
  Rgb plain, reflected;
  sub_.each(entry, [&](size_t s) {
    if (sub_.source[s] == scene::kNone) return;
    const Rgb found = irradiance(layer, sub_.source[s]);
    plain += found;
    reflected += sub_.hits.albedo[s] * found;
  });
  const float share = 1.0f / static_cast<float>(sub_.count(entry));
  Rgb mean = plain * share;
  for (int c = 0; c < 3 && !options_.plain_means; ++c) {
    if (albedo[c] > 0) mean[c] = reflected[c] * share / albedo[c];
  }
  return mean;
}

/// Puts the answers of queries into pixels.
image::Image PictureBand::light_layer(const Layer& layer, const Image& albedo) const {
  Image out(rows_.width, rows_.last - rows_.first, 3);
  each_pixel([&](int i) {
    const int32_t query = query_of_pixel_[seen_index(i)];
    if (query != scene::kNone) put(&out, i, irradiance(layer, query));
  });
  each_edge([&](size_t entry) {
    const int pixel = sub_.pixel[entry] - static_cast<int32_t>(seen_index(0));
    put(&out, pixel, edge_irradiance(layer, entry, get(albedo, pixel)));
  });
  return out;
}

/// Turns radiance of traced pixels into light layers.
void PictureBand::put_traced(const BandLight& light, Frame* frame) const {
  for (size_t k = 0; k < light.traced.size(); ++k) {
    const auto pixel = static_cast<int>(traced_[k] - int64_t{rows_.first} * rows_.width);
    const pathtrace::PixelRadiance& seen = light.traced[k];
    const Rgb albedo = max(get(frame->albedo, pixel),
                           {kLeastTracedAlbedo, kLeastTracedAlbedo, kLeastTracedAlbedo});
    const auto irradiance = [&](const Rgb& radiance) {
      return Rgb{radiance.x / albedo.x, radiance.y / albedo.y, radiance.z / albedo.z} * kPi;
    };
    put(&frame->albedo, pixel, albedo);
    put(&frame->emission, pixel, seen.emission);
    if (frame->direct.width > 0) put(&frame->direct, pixel, irradiance(seen.direct));
    if (frame->indirect.width > 0) put(&frame->indirect, pixel, irradiance(seen.indirect));
    if (frame->total.width > 0) put(&frame->total, pixel, irradiance(seen.direct + seen.indirect));
  }
}

Frame PictureBand::resolve(const BandLight& light) const {
  Frame frame;
  const int width = rows_.width, height = rows_.last - rows_.first;
  frame.albedo = frame.normal = frame.emission = Image(width, height, 3);
  frame.depth = Image(width, height, 1);
  const GBuffer& hits = this->hits();
  each_pixel([&](int i) {
    const size_t at = hit_index(i);
    put(&frame.albedo, i, hits.albedo[at]);
    put(&frame.normal, i, hits.normal[at]);
    put(&frame.emission, i, hits.emission[at]);
    if (hits.mask[at]) frame.depth.pixels[static_cast<size_t>(i)] = hits.depth[at];
  });
  if (options_.mean_normal) frame.mean_normal = frame.normal;
  each_edge([&](size_t entry) {
    const int pixel = sub_.pixel[entry] - static_cast<int32_t>(seen_index(0));
    if (options_.mean_normal) put(&frame.mean_normal, pixel, edge_normal(entry));
    put(&frame.albedo, pixel, edge_albedo(entry));
    put(&frame.emission, pixel, sub_.emission[entry]);
  });
  const auto layer = [&](const std::optional<std::vector<Rgb>>& queries, const Image* centres) {
    return queries ? light_layer(layer_of(queries, centres), frame.albedo) : Image();
  };
  frame.direct = layer(light.direct, light.centres.direct);
  frame.indirect = layer(light.indirect, light.centres.indirect);
  frame.total = layer(light.total, light.centres.total);
  put_traced(light, &frame);
  count(light, &frame);
  return frame;
}

void PictureBand::show(const BandLight& light, Output output, Frame* frame) const {
  const GBuffer& hits = this->hits();
  const Layer direct = layer_of(light.direct, light.centres.direct),
              indirect = layer_of(light.indirect, light.centres.indirect),
              total = layer_of(light.total, light.centres.total);
  const int first = rows_.first * rows_.width;
  each_pixel([&](int i) {
    const size_t at = hit_index(i);
    PixelLayers seen{hits.albedo[at], hits.emission[at], {}, {}, {}};
    const int32_t query = query_of_pixel_[seen_index(i)];
    if (query != scene::kNone) {
      if (light.direct) seen.direct = irradiance(direct, query);
      if (light.indirect) seen.indirect = irradiance(indirect, query);
      if (light.total) seen.total = irradiance(total, query);
    }
    put(&frame->color, first + i, color_of(seen, output));
    if (hits.mask[at])
      frame->depth.pixels[static_cast<size_t>(first) + static_cast<size_t>(i)] = hits.depth[at];
  });
  each_edge([&](size_t entry) {
    PixelLayers seen;
    seen.albedo = edge_albedo(entry);
    seen.emission = sub_.emission[entry];
    if (light.direct) seen.direct = edge_irradiance(direct, entry, seen.albedo);
    if (light.indirect) seen.indirect = edge_irradiance(indirect, entry, seen.albedo);
    if (light.total) seen.total = edge_irradiance(total, entry, seen.albedo);
    put(&frame->color, first + sub_.pixel[entry] - static_cast<int32_t>(seen_index(0)),
        color_of(seen, output));
  });
  count(light, frame);
}

void PictureBand::count(const BandLight& light, Frame* frame) const {
  const auto own = std::span(hits().mask).subspan(hit_index(0), static_cast<size_t>(pixels()));
  frame->background += std::count(own.begin(), own.end(), 0);
  frame->queries += asking_centres_ + queries_.size() - centre_queries_;
  frame->decoded += light.decoded;
  frame->edge_pixels += static_cast<int64_t>(sub_.pixel.size());
  frame->traced_pixels += static_cast<int64_t>(traced_.size());
  count_metal(frame);
}

}  // namespace lte::infer
