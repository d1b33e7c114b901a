/* An empty room, 4 x 2.5 x 5 m, under one rectangular lamp: surfaces to sample, a G-buffer, direct
 * light in closed form, and a few paths of indirect light. What a renderer has anyway; nothing here
 * knows of lte. */
#ifndef LTE_EXAMPLES_C_ROOM_H_
#define LTE_EXAMPLES_C_ROOM_H_

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A surface sample: world metres, unit normal, radiance in W sr^-1 m^-2. */
typedef struct Surfel {
  float position[3], normal[3], albedo[3], emission[3];
} Surfel;

/** What a camera ray hits. */
typedef struct Pixel {
  Surfel hit;
  uint8_t reflects; /* 0 on the lamp, whose own light is all there is to see */
} Pixel;

/** Draws `count` points uniformly by area; the same ones for the same seed. Returns the area that
 *  each stands for, m^2. */
float room_sample(Surfel* points, size_t count, uint32_t seed);

/** Looks from the front of the room to the back, rows from the top. */
void room_gbuffer(Pixel* pixels, int width, int height);

/** Irradiance that comes straight from the lamp, W/m^2 (Lambert's formula for a polygon). */
void room_direct(const Surfel* at, float irradiance[3]);

/** Light at a surface sample, W/m^2: direct light as above, and indirect light by path tracing,
 *  which is noisy but not biased; 0 and 0 on the lamp.
 *  Returns the standard error of the indirect light over its value, of the mean over the channels,
 *  as the paths' spread tells it, at most 1. */
float room_light(const Surfel* at, int paths, uint32_t seed, float direct[3], float indirect[3]);

#ifdef __cplusplus
}
#endif

#endif /* LTE_EXAMPLES_C_ROOM_H_ */
