#include "lte/bake/bake.h"

#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "lte/bake/seams.h"
#include "lte/bake/unique_name.h"
#include "lte/base/check.h"
#include "lte/base/version.h"
#include "lte/scene/metal.h"

namespace lte::bake {
namespace {

int64_t metal_instances(const scene::Scene& scene) {
  int64_t count = 0;
  for (const scene::Instance& instance : scene.instances) {
    const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
    count += scene.materials[static_cast<size_t>(mesh.material)].metallic > 0 ? 1 : 0;
  }
  return count;
}

}  // namespace

Layout make_layout(const scene::Scene& scene, const AtlasOptions& options) {
  Layout out{make_atlas(scene, options), {}};
  out.texels = find_texels(out.atlas);
  return out;
}

Lightmap make_lightmap(const pathtrace::Bvh& bvh, Layout layout, std::vector<BakedLayer> layers,
                       Provenance provenance, double* seam_p99) {
  LTE_CHECK(!layers.empty(), "a light map needs a layer");
  TexelLight all = layers.front().light;
  for (const BakedLayer& layer : layers) {
    LTE_CHECK(layer.light.back == all.back, "layers of a light map are of different sides");
    for (size_t i = 0; i < all.dark.size(); ++i)
      all.dark[i] = all.dark[i] != 0 && layer.light.dark[i] != 0 ? 1 : 0;
  }
  Lightmap out;
  out.width = layout.atlas.width;
  out.height = layout.atlas.height;
  out.mask = make_mask(bvh, layout.atlas, layout.texels, all);
  const std::vector<SeamPlace> seams = find_seams(layout.atlas, out.mask);
  std::set<std::string> names;
  for (const BakedLayer& layer : layers) {
    std::vector<float> picture =
        paint(layout.atlas, layout.texels, layer.light.irradiance, out.mask);
    join_seams(seams, out.mask, &picture);
    out.layers.push_back({unique_name(layer.name, &names), std::move(picture)});
  }
  if (seam_p99 != nullptr) *seam_p99 = seam_difference(seams, out.total(), 0.99);
  out.provenance = std::move(provenance);
  out.provenance.version = version();
  out.provenance.denoiser = all.denoiser;
  out.provenance.texels_per_metre = layout.atlas.texels_per_metre;
  out.provenance.two_sided_texels = all.two_sided;
  out.provenance.metal_instances = metal_instances(layout.atlas.scene);
  out.placements = std::move(layout.atlas.placements);
  out.scene = std::move(layout.atlas.scene);
  return out;
}

}  // namespace lte::bake
