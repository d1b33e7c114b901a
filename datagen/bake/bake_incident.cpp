#include "datagen/bake/bake_incident.h"

#include <algorithm>
#include <span>

#include "lte/pathtrace/incident/hemisphere_bins.h"
#include "lte/pathtrace/incident/incident.h"
#include "lte/scene/surface.h"

namespace lte::datagen {
namespace {

constexpr int64_t kIncidentBlock = 32;  // points in full precision at a time

/// Sets directions and densities of the cells, which are the same at every point.
void describe_cells(data::IncidentField* field) {
  const int bins = field->bins;
  for (int row = 0; row < bins; ++row) {
    for (int column = 0; column < bins; ++column) {
      field->direction.push_back(pathtrace::bin_centre(bins, row, column));
      field->pdf.push_back(static_cast<float>(
          1 / (double{1} * bins * bins * pathtrace::bin_solid_angle(bins, row, column))));
    }
  }
}

float largest_of(const pathtrace::IncidentRadiance& radiance, int64_t point) {
  float largest = 0;
  for (const auto* values : {&radiance.direct, &radiance.indirect}) {
    for (int64_t g = 0; g < radiance.groups; ++g) {
      const auto first = values->begin() + (g * radiance.points + point) * radiance.cells();
      for (auto value = first; value != first + radiance.cells(); ++value)
        largest = std::max(largest, max_component(*value));
    }
  }
  return largest;
}

/// Stores radiance as half floats, each point scaled so that its largest value fits.
void pack(const pathtrace::IncidentRadiance& radiance, int64_t first, data::IncidentField* field) {
  const int64_t P = field->points(), cells = radiance.cells();
  for (int64_t i = 0; i < radiance.points; ++i) {
    const float scale = data::half_scale(largest_of(radiance, i));
    field->scale[static_cast<size_t>(first + i)] = scale;
    for (const auto& [from, to] : {std::pair{&radiance.direct, &field->direct},
                                   std::pair{&radiance.indirect, &field->indirect}}) {
      for (int64_t g = 0; g < radiance.groups; ++g) {
        const Rgb* in = from->data() + (g * radiance.points + i) * cells;
        Half* out = to->data() + (g * P + first + i) * cells * 3;
        for (int64_t k = 0; k < 3 * cells; ++k)
          out[k] = to_half(in[k / 3][static_cast<int>(k % 3)] / scale);
      }
    }
  }
}

}  // namespace

int64_t incident_paths(const IncidentBakeOptions& options) {
  return options.points * options.bins * options.bins * options.samples;
}

data::IncidentField bake_incident(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                  const scene::SurfaceSamples& points,
                                  const IncidentBakeOptions& options, int max_depth, uint64_t seed,
                                  const std::function<void(int64_t paths)>& done) {
  data::IncidentField field;
  field.bins = static_cast<int>(options.bins);
  field.samples = options.samples;
  field.position = points.position;
  field.normal = points.normal;
  field.albedo = points.albedo;
  for (const Vec3& normal : field.normal) field.tangent.push_back(pathtrace::bin_tangent(normal));
  for (const scene::Gloss& gloss : points.gloss) {
    field.metallic.push_back(gloss.metallic);
    field.roughness.push_back(gloss.roughness);
  }
  describe_cells(&field);
  const int64_t P = field.points(), per_point = options.bins * options.bins * options.samples;
  field.scale.resize(static_cast<size_t>(P));
  field.direct.resize(static_cast<size_t>(lights.groups() * P * options.bins * options.bins * 3));
  field.indirect.resize(field.direct.size());
  pathtrace::IncidentOptions incident;
  incident.bins = field.bins;
  incident.samples = static_cast<int>(options.samples);
  incident.max_depth = max_depth;
  incident.seed = seed;
  for (int64_t first = 0; first < P; first += kIncidentBlock) {
    const auto at = static_cast<size_t>(first);
    const auto size = static_cast<size_t>(std::min(kIncidentBlock, P - first));
    pack(pathtrace::estimate_incident(bvh, lights, std::span(field.position).subspan(at, size),
                                      std::span(field.normal).subspan(at, size), incident, first),
         first, &field);
    done(static_cast<int64_t>(size) * per_point);
  }
  return field;
}

}  // namespace lte::datagen
