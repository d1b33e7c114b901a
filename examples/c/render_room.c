/* Renders a room with direct light in closed form and the network's indirect light.
 *
 *   render_room MODEL.safetensors OUT.ppm [OUT.pfm [WIDTH HEIGHT]]
 *
 * MODEL may be any that lte_train writes; what it reads of light is computed. The PFM gets the
 * network's irradiance, W/m^2. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lte/c_api.h"

#include "room.h"

static int fail(const char* what) {
  fprintf(stderr, "render_room: %s: %s\n", what, lte_last_error());
  return EXIT_FAILURE;
}

static lte_float3_view view(const float* first, size_t stride) {
  lte_float3_view out;
  out.data = first;
  out.stride = (int64_t)stride;
  return out;
}

enum { kPaths = 32 }; /* a scene point; as many as in the training of the shipped models */

typedef struct Light {
  float direct[3], indirect[3], behind[3];
} Light;

/* The light at the points; `light` and `error` have as many entries and twice as many. Nothing
 * comes to the walls from behind. */
static void add_light(const Surfel* points, Light* light, float* error, lte_scene_points* scene) {
  for (int64_t i = 0; i < scene->count; ++i) {
    const Light none = {{0}, {0}, {0}};
    light[i] = none;
    error[2 * i] = room_light(&points[i], kPaths, (uint32_t)i, light[i].direct, light[i].indirect);
    error[2 * i + 1] = 0;
  }
  scene->direct = view(light->direct, sizeof *light);
  scene->direct_back = view(light->behind, sizeof *light);
  scene->indirect = view(light->indirect, sizeof *light);
  scene->indirect_back = view(light->behind, sizeof *light);
  scene->indirect_error = error;
}

/* Samples the room's surfaces, as many as the model wants, and encodes them. */
static lte_status encode_room(const lte_model* model, lte_embedding** embedding) {
  lte_model_info info = {sizeof info};
  lte_status status = lte_model_get_info(model, &info);
  if (status != LTE_OK) return status;
  const size_t count = (size_t)info.scene_points;
  Surfel* points = malloc(count * sizeof *points);
  Light* light = malloc(count * sizeof *light);
  float* error = malloc(2 * count * sizeof *error);
  float* area = malloc(count * sizeof *area);
  if (points == NULL || light == NULL || error == NULL || area == NULL) {
    free(area);
    free(error);
    free(light);
    free(points);
    return LTE_ERROR_OUT_OF_MEMORY;
  }
  const float area_of_each = room_sample(points, count, 1);
  for (size_t i = 0; i < count; ++i) area[i] = area_of_each;
  lte_scene_points scene = {sizeof scene};
  scene.count = info.scene_points;
  scene.position = view(points->position, sizeof *points);
  scene.normal = view(points->normal, sizeof *points);
  scene.albedo = view(points->albedo, sizeof *points);
  scene.emission = view(points->emission, sizeof *points);
  scene.area = area;
  if (info.light_input == LTE_LIGHT_TRACED) add_light(points, light, error, &scene);
  status = lte_model_encode(model, &scene, embedding);
  free(area);
  free(error);
  free(light);
  free(points); /* the embedding keeps nothing of them */
  return status;
}

/* The G-buffer goes to the network as it lies in memory. */
static lte_status decode_pixels(const lte_embedding* embedding, const Pixel* pixels, size_t count,
                                float* irradiance) {
  lte_queries queries = {sizeof queries};
  queries.count = (int64_t)count;
  queries.position = view(pixels->hit.position, sizeof *pixels);
  queries.normal = view(pixels->hit.normal, sizeof *pixels);
  queries.albedo = view(pixels->hit.albedo, sizeof *pixels);
  queries.mask = &pixels->reflects;
  queries.mask_stride = sizeof *pixels;
  return lte_embedding_decode(embedding, &queries, irradiance, 0);
}

static int write_pfm(const char* path, const float* rgb, int width, int height) {
  FILE* file = fopen(path, "wb");
  if (file == NULL) return 0;
  int good = fprintf(file, "PF\n%d %d\n-1.0\n", width, height) > 0;
  const size_t row = 3 * (size_t)width;
  for (int y = height - 1; y >= 0; --y) { /* from the bottom */
    good = fwrite(rgb + (size_t)y * row, sizeof *rgb, row, file) == row && good;
  }
  return fclose(file) == 0 && good;
}

static int write_ppm(const char* path, const Pixel* pixels, const float* irradiance, int width,
                     int height) {
  FILE* file = fopen(path, "wb");
  if (file == NULL) return 0;
  int good = fprintf(file, "P6\n%d %d\n255\n", width, height) > 0;
  for (size_t i = 0; i < (size_t)width * (size_t)height; ++i) {
    const Surfel* hit = &pixels[i].hit;
    float direct[3] = {0, 0, 0};
    if (pixels[i].reflects) room_direct(hit, direct);
    unsigned char bytes[3];
    for (int c = 0; c < 3; ++c) {
      const float all = irradiance[3 * i + (size_t)c] + direct[c];
      const float radiance = hit->emission[c] + hit->albedo[c] * all / 3.14159265f;
      bytes[c] = (unsigned char)(255 * powf(fminf(radiance, 1), 1 / 2.2f) + 0.5f);
    }
    good = fwrite(bytes, 1, 3, file) == 3 && good;
  }
  return fclose(file) == 0 && good;
}

static int render(const lte_model* model, const char* ppm, const char* pfm, int width, int height) {
  lte_embedding* embedding = NULL;
  if (encode_room(model, &embedding) != LTE_OK) return fail("encoding");
  const size_t count = (size_t)width * (size_t)height;
  Pixel* pixels = malloc(count * sizeof *pixels);
  float* irradiance = malloc(3 * count * sizeof *irradiance);
  lte_model_info info = {sizeof info};
  int code = EXIT_SUCCESS;
  if (pixels == NULL || irradiance == NULL) {
    fputs("render_room: no memory for the picture\n", stderr);
    code = EXIT_FAILURE;
  } else {
    room_gbuffer(pixels, width, height);
    if (lte_model_get_info(model, &info) != LTE_OK ||
        decode_pixels(embedding, pixels, count, irradiance) != LTE_OK) {
      code = fail("decoding");
    } else if ((pfm != NULL && !write_pfm(pfm, irradiance, width, height)) ||
               !write_ppm(ppm, pixels, irradiance, width, height)) {
      perror("render_room: writing the picture");
      code = EXIT_FAILURE;
    }
  }
  free(irradiance);
  free(pixels);
  lte_embedding_release(embedding);
  return code;
}

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4 && argc != 6) {
    fputs("usage: render_room MODEL.safetensors OUT.ppm [OUT.pfm [WIDTH HEIGHT]]\n", stderr);
    return 2;
  }
  const int width = argc == 6 ? atoi(argv[4]) : 320, height = argc == 6 ? atoi(argv[5]) : 240;
  if (width < 1 || width > 16384 || height < 1 || height > 16384) {
    fputs("render_room: width and height must be 1 to 16384\n", stderr);
    return 2;
  }
  lte_model* model = NULL;
  if (lte_model_open(argv[1], NULL, &model) != LTE_OK) return fail("the model");
  const int code = render(model, argv[2], argc > 3 ? argv[3] : NULL, width, height);
  lte_model_release(model);
  return code;
}
