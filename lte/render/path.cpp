// Path tracing (Kajiya, "The rendering equation", 1986) with light samples at every hit, weighed
// against the paths' own rays by the balance heuristic (Veach and Guibas 1995).
//
// It is unbiased but for paths of more than max_depth hits, which count as dark, and it is the
// reference of every error figure. Russian roulette ends paths from the third hit on.
//
// It fails by noise: light that few paths find (a lamp behind a slit, caustics of metal) stands in
// single bright pixels, and halving the noise takes four times the paths.
#include "lte/render/gathered_points.h"
#include "lte/render/integrator.h"

namespace lte::render {
namespace {

class Path : public Integrator {
 public:
  Path(const TracedScene& scene, int max_depth)
      : scene_(scene), max_depth_(max_depth), no_records_(scene.bvh, {}, {}) {}

  Method method() const override { return Method::Path; }
  void prepare() override {}

  PointIrradiance irradiance(const SurfacePoints& points,
                             const PointSampling& sampling) const override {
    return gather_points(scene_, no_records_, points, sampling, max_depth_);
  }

 private:
  TracedScene scene_;
  int max_depth_;
  gi::IrradianceCache no_records_;
};

}  // namespace

std::unique_ptr<Integrator> make_path(const TracedScene& scene, int max_depth) {
  return std::make_unique<Path>(scene, max_depth);
}

}  // namespace lte::render
