// A picture of a scene by lte/render: rays over an irradiance cache, sixteen passes, no noise.
//
//   render_picture room.glb picture.png
#include <cstdio>

#include "lte/image/png.h"
#include "lte/image/tonemap.h"
#include "lte/render/picture.h"
#include "lte/render/progressive.h"
#include "lte/scene/load.h"

int main(int argc, char** argv) try {
  if (argc != 3) return std::fprintf(stderr, "render_picture SCENE PICTURE.png\n"), 2;
  const lte::scene::Scene scene = lte::scene::load_scene(argv[1]);
  const lte::pathtrace::Bvh bvh(scene);
  const lte::pathtrace::Lights lights(scene);
  const auto integrator = lte::render::make_gather({bvh, lights}, lte::render::CacheSettings{});
  integrator->prepare();
  lte::render::Film film(640, 480);
  lte::render::Until until;
  until.passes = 16;
  lte::render::render({bvh, lights}, *integrator, scene.cameras.at(0), {}, until, &film);
  const lte::image::Denoiser denoiser;
  const auto picture = lte::render::make_picture(film, {lte::render::Output::Full, &denoiser});
  const float exposure = lte::image::auto_exposure(picture.color);
  lte::image::write_png(argv[2], lte::image::display(picture.color, exposure));
  return 0;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "render_picture: %s\n", error.what()), 1;
}
