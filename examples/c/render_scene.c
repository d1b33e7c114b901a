/* Renders a scene file, first light that rays gather, then light of a network where one is given.
 *
 *   render_scene SCENE OUT.ppm [MODEL.safetensors] */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "lte/c_render.h"

enum { kWidth = 320, kHeight = 240 };

static int fail(const char* what) {
  fprintf(stderr, "render_scene: %s: %s\n", what, lte_last_error());
  return EXIT_FAILURE;
}

/* Encodes the scene by a model, for lte_integrator_options::embedding. */
static lte_status encode(const lte_scene* scene, const char* path, lte_embedding** embedding) {
  lte_scene_encode_options options = {sizeof options};
  lte_model* model = NULL;
  lte_status status = lte_model_open(path, NULL, &model);
  options.rescale = 1;
  if (status == LTE_OK) status = lte_scene_encode(scene, model, &options, embedding);
  lte_model_release(model); /* the embedding keeps what it needs */
  return status;
}

static int32_t show_progress(void* user, double share) {
  fprintf((FILE*)user, "\r%3.0f %%", 100 * share);
  return 0; /* go on */
}

static lte_status render(const lte_scene* scene, const lte_embedding* embedding, float* color) {
  lte_integrator_options options = {sizeof options};
  lte_render_options quality = {sizeof quality};
  lte_camera camera = {sizeof camera};
  lte_picture picture = {sizeof picture, kWidth, kHeight, NULL};
  lte_scene_info info = {sizeof info};
  lte_integrator* integrator = NULL;
  options.method = embedding != NULL ? LTE_METHOD_NETWORK : LTE_METHOD_GATHER;
  options.embedding = embedding;
  quality.passes = 4; /* a preview */
  quality.progress = show_progress;
  quality.user = stderr;
  picture.color = color;
  lte_status status = lte_scene_get_info(scene, &info);
  if (status == LTE_OK)
    status = lte_scene_get_camera(scene, info.cameras > 0 ? 0 : LTE_CAMERA_AUTO, &camera);
  if (status == LTE_OK) status = lte_integrator_create(scene, &options, &integrator);
  if (status == LTE_OK) status = lte_render(integrator, &camera, &quality, &picture);
  fputc('\n', stderr);
  lte_integrator_release(integrator);
  return status;
}

static int write_ppm(const char* path, const float* color) {
  FILE* file = fopen(path, "wb");
  if (file == NULL) return 0;
  int good = fprintf(file, "P6\n%d %d\n255\n", kWidth, kHeight) > 0;
  for (size_t i = 0; i < 3 * (size_t)kWidth * kHeight; ++i) {
    const int byte = (int)(255 * powf(fminf(color[i], 1), 1 / 2.2f) + 0.5f);
    good = fputc(byte, file) != EOF && good;
  }
  return fclose(file) == 0 && good;
}

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    fputs("usage: render_scene SCENE OUT.ppm [MODEL.safetensors]\n", stderr);
    return 2;
  }
  float* color = malloc(3 * sizeof *color * kWidth * kHeight);
  lte_scene* scene = NULL;
  lte_embedding* embedding = NULL;
  int code = EXIT_SUCCESS;
  if (color == NULL) {
    fputs("render_scene: no memory for the picture\n", stderr);
    code = EXIT_FAILURE;
  } else if (lte_scene_open(argv[1], NULL, &scene) != LTE_OK) {
    code = fail("the scene");
  } else if (argc == 4 && encode(scene, argv[3], &embedding) != LTE_OK) {
    code = fail("the network");
  } else if (render(scene, embedding, color) != LTE_OK) {
    code = fail("rendering");
  } else if (!write_ppm(argv[2], color)) {
    perror("render_scene: writing the picture");
    code = EXIT_FAILURE;
  }
  lte_embedding_release(embedding);
  lte_scene_release(scene);
  free(color);
  return code;
}
