// Some rows of a picture between what their pixels see and what they show. Pictures are rendered
// band by band, so that their memory does not grow with their size by more than the layers take.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "infer/picture/antialias.h"
#include "infer/picture/frame.h"
#include "infer/picture/output.h"
#include "lte/gi/pixel_surfaces.h"
#include "lte/pathtrace/render.h"

namespace lte::infer {

/// Whether a surface counts as metal: below that share nobody would see it in a matt answer.
constexpr bool is_metal(float metallic) { return metallic > 0.05f; }

/// Albedo of a pixel whose radiance paths have found, at least, as light layers divide by it.
inline constexpr float kLeastTracedAlbedo = 1e-4f;

struct BandOptions {
  int antialias = 0;  ///< hits in a pixel at an edge; below 2: none but the centre's
  Metal metal = Metal::Diffuse;
  /// Means of irradiance do not weigh it by albedo: for a picture of irradiance itself.
  bool plain_means = false;
  /// The light of centres is there already (BandLight::centres): queries are those beyond them
  /// alone.
  bool centres_known = false;
  bool mean_normal = false;  ///< the frame has that layer too
};

/// Irradiance at the centres of the pixels of the rows that a band's hits are lent from.
struct CentreLayers {
  const image::Image *direct = nullptr, *indirect = nullptr, *total = nullptr;
};

/// Irradiance of a band's queries, an entry each; nothing where the output does not need it.
struct BandLight {
  std::optional<std::vector<Rgb>> direct, indirect, total;
  CentreLayers centres;  ///< of the same kinds, with BandOptions::centres_known
  std::vector<pathtrace::PixelRadiance> traced;  ///< an entry a traced pixel
  int64_t decoded = 0;                           ///< queries that the network has answered
};

class PictureBand {
 public:
  /// Traces primary hits and finds what has to be asked.
  /// @param hits       those of more rows, the neighbours' included, where they are there already;
  ///                   they must outlive the band
  /// @param first_row  that `hits` begin with
  PictureBand(const pathtrace::Bvh& bvh, const scene::Camera& camera, const PictureRows& rows,
              const BandOptions& options, const pathtrace::GBuffer* hits = nullptr,
              int first_row = 0);

  /// Those of pixel centres come first, tile by tile: background and black surfaces are never asked
  /// about. The order numbers the random streams of direct light, so another one is another
  /// picture.
  const QuerySet& queries() const { return queries_; }
  int64_t centre_queries() const { return centre_queries_; }
  /// Rows of lent hits before those of the band.
  int first_lent_row() const { return rows_.first - first_row_; }
  /// What the pixels of the band see. @param mask  per pixel, where irradiance is wanted
  gi::PixelSurfaces surfaces(std::span<const uint8_t> mask) const;
  /// The query of each pixel of the band, kNone if it asks nothing. Where the light of centres is
  /// known, a number that queries() does not have.
  std::span<const int32_t> query_of_pixel() const;
  /// The pixel in which each query beyond the centres' lies, and its depth.
  struct ExtraQuery {
    int pixel = 0;
    float depth = 0;
  };
  std::vector<ExtraQuery> extra_queries() const;
  /// The pixel, y * width + x of the picture, of each of these.
  const std::vector<int64_t>& centre_pixels() const { return centre_pixels_; }
  /// Pixels, y * width + x of the picture, that the path tracer is to render.
  const std::vector<int64_t>& traced_pixels() const { return traced_; }

  /// The layers of the band, without `color`. Light layers are there where `light` has them.
  Frame resolve(const BandLight& light) const;
  /// The same as color and depth alone, in the band's rows of a frame that has these images. Adds
  /// to its counts. For bands without traced pixels.
  /// @param output  one that shows light
  void show(const BandLight& light, Output output, Frame* frame) const;

 private:
  static constexpr int kTile = 8;

  /// Irradiance of one kind.
  struct Layer {
    std::span<const Rgb> queries;  ///< by place in queries_
    const image::Image* centres = nullptr;
  };
  static Layer layer_of(const std::optional<std::vector<Rgb>>& queries,
                        const image::Image* centres);
  Rgb irradiance(const Layer& layer, int32_t query) const;
  /// Means over the hits of an edge pixel.
  Rgb edge_irradiance(const Layer& layer, size_t entry, const Rgb& albedo) const;
  Rgb edge_albedo(size_t entry) const;
  Vec3 edge_normal(size_t entry) const;

  int pixels() const { return rows_.width * (rows_.last - rows_.first); }
  const pathtrace::GBuffer& hits() const { return lent_ != nullptr ? *lent_ : own_; }
  /// Of pixel `i` of the band among those that are seen, its neighbours included.
  size_t seen_index(int i) const {
    return static_cast<size_t>(i) + static_cast<size_t>(above_) * static_cast<size_t>(rows_.width);
  }
  /// The same in hits().
  size_t hit_index(int i) const { return first_seen_ + seen_index(i); }

  /// Calls use(pixel of the band) for all of them, in several threads.
  template <typename Use>
  void each_pixel(const Use& use) const;
  void darken_metal(pathtrace::GBuffer* hits) const;
  template <typename Use>
  void each_edge(const Use& use) const;
  void take_samples(const pathtrace::Bvh& bvh, const scene::Camera& camera, const EdgeView& view);
  void list_traced();
  bool asks(int pixel) const;
  void ask_centres();
  void number_centres();
  void count(const BandLight& light, Frame* frame) const;
  void count_metal(Frame* frame) const;
  image::Image light_layer(const Layer& layer, const image::Image& albedo) const;
  void put_traced(const BandLight& light, Frame* frame) const;

  const scene::Scene& scene_;
  PictureRows rows_;  ///< of the band
  float pixel_size_;
  BandOptions options_;
  int first_row_ = 0;  ///< of lent hits
  int above_ = 0;      ///< rows that are seen before those of the band: neighbours of its edges
  const pathtrace::GBuffer* lent_ = nullptr;  ///< the caller's hits, or null for those below
  pathtrace::GBuffer own_;
  size_t first_seen_ = 0;  ///< in hits()
  SubHits sub_;
  std::vector<uint8_t> is_traced_;  ///< by seen_index(); empty if none can be
  std::vector<int64_t> traced_;
  std::vector<int32_t> query_of_pixel_;  ///< by seen_index()
  QuerySet queries_;
  int32_t first_listed_ = 0;    ///< the number of the first of queries_
  int64_t centre_queries_ = 0;  ///< of queries_
  int64_t asking_centres_ = 0;  ///< whether they are listed or known
  std::vector<int64_t> centre_pixels_;
};

}  // namespace lte::infer
