#include "experiments/guiding/guide_maps.h"

#include <algorithm>

#include "lte/base/timer.h"
#include "lte/pathtrace/incident/hemisphere_bins.h"
#include "lte/pathtrace/incident/incident.h"

namespace lte::experiments {
namespace {

/// Places whose directions are asked for at a time.
constexpr size_t kTogether = 256;

}  // namespace

scene::SurfaceSamples points_all_over(const scene::Scene &scene, int64_t count) {
  scene::SamplerOptions options;
  options.seed = 5;
  options.filter_footprint = false;
  options.punctual_lights = false;
  options.environment_share = 0;
  return scene::sample_surface(scene, count, options);
}

GuideMaps::GuideMaps(const MapPlaces &places, int bins)
    : bins_(bins), normal_(places.normal.begin(), places.normal.end()) {}

GuideMaps GuideMaps::predicted(const runtime::SceneEmbedding &embedding, const MapPlaces &places,
                               int bins) {
  GuideMaps out(places, bins);
  const double start = processor_seconds();
  for (size_t first = 0; first < places.size(); first += kTogether) {
    const size_t count = std::min(kTogether, places.size() - first);
    const auto normals = places.normal.subspan(first, count);
    std::vector<Vec3> directions;
    for (const Vec3 &normal : normals) {
      const std::vector<Vec3> cells = pathtrace::bin_centres(bins, normal);
      directions.insert(directions.end(), cells.begin(), cells.end());
    }
    const std::vector<Rgb> some = embedding.decode_radiance(
        {places.position.subspan(first, count), normals, places.albedo.subspan(first, count)},
        directions);
    out.radiance_.insert(out.radiance_.end(), some.begin(), some.end());
  }
  out.seconds_ = processor_seconds() - start;
  return out;
}

GuideMaps GuideMaps::traced(const pathtrace::Bvh &bvh, const pathtrace::Lights &lights,
                            const MapPlaces &places, int bins, int paths) {
  GuideMaps out(places, bins);
  const double start = processor_seconds();
  pathtrace::IncidentOptions options;
  options.bins = bins;
  options.samples = paths;
  options.seed = 11;
  const pathtrace::IncidentRadiance traced =
      pathtrace::estimate_incident(bvh, lights, places.position, places.normal, options);
  const size_t cells = places.size() * static_cast<size_t>(traced.cells());
  out.radiance_.resize(cells);
  for (size_t i = 0; i < traced.indirect.size(); ++i)
    out.radiance_[i % cells] += traced.indirect[i];
  out.seconds_ = processor_seconds() - start;
  return out;
}

DirectionMap GuideMaps::at(size_t place) const {
  const auto cells = static_cast<size_t>(bins_) * static_cast<size_t>(bins_);
  return {std::span(radiance_).subspan(place * cells, cells), bins_, normal_[place]};
}

SharedGuides::SharedGuides(const GuideMaps &maps) : maps_(maps) {
  const double start = processor_seconds();
  for (size_t i = 0; i < maps.size(); ++i)
    tables_.push_back(std::make_shared<const GuideTable>(maps.at(i), GuideOptions{}.even_share));
  seconds_ = processor_seconds() - start;
}

Guide SharedGuides::guide(size_t place, const Vec3 &normal, const Reflector &reflector) const {
  if (reflector.gloss.metallic > 0) return {maps_.at(place), normal, reflector};
  return {tables_[place], normal, reflector};
}

}  // namespace lte::experiments
