// The light of a light map at the vertices of its scene, whose triangles are cut where light bends.
//
// A vertex has the value with which linear interpolation over the triangles around it is nearest to
// the light inside them (Kavan et al., "Least squares vertex baking", 2011): what lies beyond an
// edge does not count. Triangles that meet smoothly share vertices; where they do not, each side
// has its own.
//
// Layers share the triangles, and each is fitted as if it were alone. Triangles are cut where a
// layer bends or their sum does: errors of layers can cancel in the sum, and show when a lamp is
// dimmed. With gains g light is then off by at most `bend` times the sum of g (layer + a tenth of
// its mean), which is the light that is seen and a tenth of its mean.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lte/bake/lightmap.h"

namespace lte::bake {

struct VertexOptions {
  /// Triangles are halved until each layer and their sum is nowhere off linear interpolation by
  /// more than this share of its light there (at least a tenth of its mean), or they have the size
  /// of texels.
  double bend = 0.1;
  int64_t max_triangles = 1'000'000;  ///< of all instances; those of the scene at least
};

struct VertexLayer {
  std::string name;                          ///< Layer::name
  std::vector<std::vector<Rgb>> irradiance;  ///< [meshes][vertices] E, W/m²
  double off_p95 = 0;  ///< as `bend`: what 95 % of the surface is below, noise included
};

struct VertexLight {
  std::vector<scene::Mesh> meshes;  ///< as those of Lightmap::scene; no uvs[1]
  std::vector<VertexLayer> layers;  ///< as Lightmap::layers
  int64_t triangles_before = 0, triangles = 0;
  double off_p95 = 0;    ///< of the sum over layers
  bool limited = false;  ///< max_triangles left some halves out

  /// Sum over the layers, E at the vertices of a mesh.
  std::vector<Rgb> total(size_t mesh) const;
};

VertexLight vertex_light(const Lightmap& map, const VertexOptions& options);

}  // namespace lte::bake
