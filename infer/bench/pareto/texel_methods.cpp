// A path-traced, denoised light map for many views: what a user without the network would keep.
#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "infer/bench/pareto/lit_picture.h"
#include "infer/bench/pareto/method.h"
#include "infer/bench/pareto/texel_atlas.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/gi/surface_index.h"
#include "lte/image/denoise.h"
#include "lte/pathtrace/irradiance.h"

namespace lte::infer {
namespace {

// Texels that speak for a place: those within so many of their edges.
constexpr float kTexelRadius = 1.5f;
// Estimates keep two colors a texel and light group: blocks bound that memory.
constexpr int64_t kTexelBlock = int64_t{1} << 14;
constexpr int kTexelAlonePaths = 16;

DirectAndIndirect trace_irradiance(const MethodScene& scene, const std::vector<Vec3>& positions,
                                   const std::vector<Vec3>& normals, int paths, uint64_t seed) {
  pathtrace::IrradianceOptions options;
  options.rays = paths;
  options.max_depth = scene.max_depth;
  options.seed = seed;
  options.variance = false;
  DirectAndIndirect out;
  const auto count = static_cast<int64_t>(positions.size());
  for (int64_t begin = 0; begin < count; begin += kTexelBlock) {
    const auto b = static_cast<size_t>(begin),
               n = static_cast<size_t>(std::min(kTexelBlock, count - begin));
    const pathtrace::Irradiance part = pathtrace::estimate_irradiance(
        scene.renderer.bvh(), scene.renderer.lights(), std::span(positions).subspan(b, n),
        std::span(normals).subspan(b, n), options, begin);
    for (int64_t i = 0; i < static_cast<int64_t>(n); ++i) {
      out.direct.push_back(part.direct_sum(i));
      out.indirect.push_back(part.indirect_sum(i));
    }
  }
  return out;
}

/// The light map of a scene, of the front sides of its surfaces.
class LightMap {
 public:
  LightMap(const MethodScene& scene, int64_t texels, int paths, StageTimes* stages) {
    Timer timer;
    const auto lap = [&](const char* stage) {
      (*stages)[stage] += timer.seconds();
      timer.restart();
    };
    TexelAtlas atlas = make_texel_atlas(scene.renderer.bvh().scene(), texels);
    lap("atlas");
    DirectAndIndirect light =
        trace_irradiance(scene, atlas.position, atlas.normal, paths, hash_combine(scene.seed, 61));
    lap("paths");
    const image::Denoiser denoiser;
    direct_ = smooth(denoiser, atlas, light.direct);
    indirect_ = smooth(denoiser, atlas, light.indirect);
    lap("denoise");
    const std::vector<float> radii(atlas.position.size(), kTexelRadius * atlas.edge);
    index_ = gi::SurfaceIndex(atlas.position, atlas.normal, radii, 0.5f);
    lap("index");
  }

  bool lookup(const Vec3& position, const Vec3& normal, Rgb* direct, Rgb* indirect) const {
    Rgb direct_sum, indirect_sum;
    float weights = 0;
    index_.for_each(position, normal, [&](uint32_t i, float weight, const Vec3&) {
      direct_sum += direct_[i] * weight;
      indirect_sum += indirect_[i] * weight;
      weights += weight;
    });
    if (!(weights > 0)) return false;
    *direct = direct_sum * (1 / weights);
    *indirect = indirect_sum * (1 / weights);
    return true;
  }

 private:
  static std::vector<Rgb> smooth(const image::Denoiser& denoiser, const TexelAtlas& atlas,
                                 const std::vector<Rgb>& light) {
    const image::Image noisy = atlas.picture(light), normal = atlas.picture(atlas.normal),
                       position = atlas.picture(atlas.position);
    const image::Image clean = denoiser.denoise({&noisy, &normal, &position, nullptr, nullptr});
    std::vector<Rgb> out;
    for (const uint32_t at : atlas.place) {
      const float* p = clean.pixels.data() + size_t{3} * at;
      out.push_back({p[0], p[1], p[2]});
    }
    return out;
  }

  gi::SurfaceIndex index_;
  std::vector<Rgb> direct_, indirect_;
};

/// What the light map says at points; paths where it has no texel, as on the back of a surface.
DirectAndIndirect read_light_map(const LightMap& map, const MethodScene& scene,
                                 const QueryPoints& queries) {
  DirectAndIndirect out;
  out.direct.resize(queries.position.size());
  out.indirect.resize(queries.position.size());
  std::vector<uint8_t> known(queries.position.size());
  parallel_for(static_cast<int64_t>(known.size()), 4096, [&](int64_t begin, int64_t end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i)
      known[i] =
          map.lookup(queries.position[i], queries.normal[i], &out.direct[i], &out.indirect[i]);
  });
  std::vector<size_t> open;
  std::vector<Vec3> position, normal;
  for (size_t i = 0; i < known.size(); ++i) {
    if (known[i]) continue;
    open.push_back(i);
    position.push_back(queries.position[i]);
    normal.push_back(queries.normal[i]);
  }
  const DirectAndIndirect traced =
      trace_irradiance(scene, position, normal, kTexelAlonePaths, hash_combine(scene.seed, 62));
  for (size_t k = 0; k < open.size(); ++k) {
    out.direct[open[k]] = traced.direct[k];
    out.indirect[open[k]] = traced.indirect[k];
  }
  return out;
}

}  // namespace

Method light_map(int64_t texels, int paths) {
  const std::string count = std::to_string(texels), of_paths = std::to_string(paths);
  Method method{"texels-" + count + "-" + of_paths,
                "texels",
                of_paths + " paths at about " + count +
                    " texels on all surfaces, denoised, direct light too; a view reads them",
                {}};
  method.prepare = [texels, paths](const MethodScene& scene, StageTimes* stages) -> RenderView {
    const auto map = std::make_shared<const LightMap>(scene, texels, paths, stages);
    return [scene, map](const scene::Camera& camera, StageTimes* view) {
      const auto read = [&](const QueryPoints& queries) {
        const Timer timer;
        DirectAndIndirect light = read_light_map(*map, scene, queries);
        (*view)["light"] += timer.seconds();
        return light;
      };
      return compose_picture(scene, camera, read, view);
    };
  };
  return method;
}

}  // namespace lte::infer
