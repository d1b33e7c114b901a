// Maps of radiance that guide paths, predicted or traced, each for itself or shared by neighbours.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "experiments/guiding/guide.h"
#include "experiments/guiding/guide_field.h"
#include "experiments/guiding/shared_places.h"
#include "lte/base/text.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/runtime/embedding.h"
#include "lte/scene/sampler.h"

namespace lte::experiments {

/// Points that maps are made at.
struct MapPlaces {
  std::span<const Vec3> position, normal;
  std::span<const Rgb> albedo;

  size_t size() const { return position.size(); }
};

/// The same, as it grows.
struct PlaceList {
  std::vector<Vec3> position, normal;
  std::vector<Rgb> albedo;

  void push_back(const Vec3& the_position, const Vec3& the_normal, const Rgb& the_albedo) {
    position.push_back(the_position);
    normal.push_back(the_normal);
    albedo.push_back(the_albedo);
  }
  MapPlaces view() const { return {position, normal, albedo}; }
};

/// Points that stand for what is near them.
class JoinedPlaces {
 public:
  explicit JoinedPlaces(double radius_m) : grid_(static_cast<float>(radius_m), kMinCosine) {}

  /// @return  the place of a point, which may be the point itself
  size_t join(const Vec3& position, const Vec3& normal, const Rgb& albedo) {
    const auto place = static_cast<size_t>(grid_.join(position, normal));
    if (place == albedo_.size()) albedo_.push_back(albedo);
    return place;
  }
  const SharedPlaces& grid() const { return grid_; }
  MapPlaces view() const { return {grid_.position(), grid_.normal(), albedo_}; }

 private:
  /// Cosine between the normals of points that share a map.
  static constexpr float kMinCosine = 0.9f;

  SharedPlaces grid_;
  std::vector<Rgb> albedo_;
};

/// Points all over the surfaces of a scene, as query points are drawn.
scene::SurfaceSamples points_all_over(const scene::Scene& scene, int64_t count);

/// Paths a cell of maps that are traced.
inline constexpr int kTracedPaths = 4;

/// What a row is called.
inline std::string guide_name(const std::string& what, int bins, const std::string& maps) {
  return concat(what, ", ", bins, " x ", bins, ", ", maps);
}

/// bins × bins cells at each of some places, and how long making them took.
class GuideMaps {
 public:
  /// By the network's radiance decoder, from the middles of the cells.
  static GuideMaps predicted(const runtime::SceneEmbedding& embedding, const MapPlaces& places,
                             int bins);
  /// By paths, so many a cell: direct light and indirect.
  static GuideMaps traced(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                          const MapPlaces& places, int bins, int paths);

  size_t size() const { return normal_.size(); }
  DirectionMap at(size_t place) const;
  double seconds() const { return seconds_; }  ///< of the processor

 private:
  GuideMaps(const MapPlaces& places, int bins);

  int bins_;
  double seconds_ = 0;
  std::vector<Vec3> normal_;
  std::vector<Rgb> radiance_;  ///< [places, cells]
};

/// Guides by maps that several surfaces share: one table for all that is diffuse around a place,
/// and one of its own for each view of metal.
class SharedGuides {
 public:
  /// @param maps  of the places; must outlive this
  explicit SharedGuides(const GuideMaps& maps);

  Guide guide(size_t place, const Vec3& normal, const Reflector& reflector) const;
  double seconds() const { return seconds_; }  ///< of the processor, of all places' tables

  /// The same tables where paths meet diffuse surfaces, so many times.
  GuideField field(const JoinedPlaces& places, int hits) const {
    return {places.grid(), tables_, GuideOptions{}.material_share, hits};
  }

 private:
  const GuideMaps& maps_;
  std::vector<std::shared_ptr<const GuideTable>> tables_;
  double seconds_ = 0;
};

}  // namespace lte::experiments
