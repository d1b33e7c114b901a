#include "room.h"

#include <math.h>
#include <string.h>

typedef struct Rectangle {
  float corner[3], edge1[3], edge2[3]; /* normal: edge1 x edge2 */
  float albedo[3], emission[3];
} Rectangle;

enum { kLamp = 6, kRectangles = 7 };
static const float kLampHeight = 2.49f;
static const Rectangle kRoom[kRectangles] = {
    {{0, 0, 0}, {0, 0, 5}, {4, 0, 0}, {0.55f, 0.45f, 0.35f}, {0, 0, 0}},       /* floor */
    {{0, 2.5f, 0}, {4, 0, 0}, {0, 0, 5}, {0.8f, 0.8f, 0.8f}, {0, 0, 0}},       /* ceiling */
    {{0, 0, 0}, {0, 2.5f, 0}, {0, 0, 5}, {0.65f, 0.1f, 0.1f}, {0, 0, 0}},      /* left */
    {{4, 0, 0}, {0, 0, 5}, {0, 2.5f, 0}, {0.1f, 0.5f, 0.15f}, {0, 0, 0}},      /* right */
    {{0, 0, 0}, {4, 0, 0}, {0, 2.5f, 0}, {0.75f, 0.75f, 0.75f}, {0, 0, 0}},    /* back */
    {{0, 0, 5}, {0, 2.5f, 0}, {4, 0, 0}, {0.75f, 0.75f, 0.75f}, {0, 0, 0}},    /* front */
    {{1.4f, 2.49f, 1.8f}, {1.2f, 0, 0}, {0, 0, 1.4f}, {0, 0, 0}, {12, 11, 9}}, /* lamp */
};

static float dot(const float a[3], const float b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const float a[3], const float b[3], float out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static float normalize(float v[3]) {
  const float length = sqrtf(dot(v, v));
  for (int i = 0; i < 3; ++i) v[i] /= length;
  return length;
}

/* The point of `r` at (u, v) in [0, 1]^2. */
static void surfel_at(const Rectangle* r, float u, float v, Surfel* out) {
  for (int i = 0; i < 3; ++i) out->position[i] = r->corner[i] + u * r->edge1[i] + v * r->edge2[i];
  cross(r->edge1, r->edge2, out->normal);
  normalize(out->normal);
  memcpy(out->albedo, r->albedo, sizeof out->albedo);
  memcpy(out->emission, r->emission, sizeof out->emission);
}

/* PCG: the same numbers everywhere. */
static float uniform(uint32_t* state) {
  *state = *state * 747796405u + 2891336453u;
  uint32_t word = ((*state >> ((*state >> 28) + 4)) ^ *state) * 277803737u;
  word = (word >> 22) ^ word;
  return (float)(word >> 8) / 16777216.0f;
}

void room_sample(Surfel* points, size_t count, uint32_t seed) {
  float until[kRectangles], total = 0;
  for (int r = 0; r < kRectangles; ++r) {
    float area[3];
    cross(kRoom[r].edge1, kRoom[r].edge2, area);
    total += sqrtf(dot(area, area));
    until[r] = total;
  }
  for (size_t i = 0; i < count; ++i) {
    /* Evenly spread over the areas, so that the lamp has its share at any count. */
    const float at = total * ((float)i + 0.5f) / (float)count;
    int r = 0;
    while (r < kRectangles - 1 && until[r] < at) ++r;
    const float u = uniform(&seed), v = uniform(&seed);
    surfel_at(&kRoom[r], u, v, &points[i]);
  }
}

/* Distance along the ray to the front of `r`, negative if it misses. */
static float intersect(const Rectangle* r, const float from[3], const float direction[3], float* u,
                       float* v) {
  float normal[3], to[3];
  cross(r->edge1, r->edge2, normal);
  const float slope = dot(normal, direction);
  if (slope >= 0) return -1;
  for (int i = 0; i < 3; ++i) to[i] = r->corner[i] - from[i];
  const float t = dot(to, normal) / slope;
  float in[3];
  for (int i = 0; i < 3; ++i) in[i] = t * direction[i] - to[i];
  *u = dot(in, r->edge1) / dot(r->edge1, r->edge1);
  *v = dot(in, r->edge2) / dot(r->edge2, r->edge2);
  return *u >= 0 && *u <= 1 && *v >= 0 && *v <= 1 ? t : -1;
}

static void first_hit(const float from[3], const float direction[3], Pixel* pixel) {
  float nearest = INFINITY;
  /* A ray along an edge of the room may miss every wall: then it sees the floor's corner. */
  surfel_at(&kRoom[0], 0, 0, &pixel->hit);
  pixel->reflects = 1;
  for (int r = 0; r < kRectangles; ++r) {
    float u, v;
    const float t = intersect(&kRoom[r], from, direction, &u, &v);
    if (t <= 0 || t >= nearest) continue;
    nearest = t;
    surfel_at(&kRoom[r], u, v, &pixel->hit);
    pixel->reflects = r != kLamp;
  }
}

void room_gbuffer(Pixel* pixels, int width, int height) {
  const float eye[3] = {2, 1.3f, 4.9f}, half = 0.75f; /* tangent of half the field of view */
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float across = (2 * (float)x + 1 - (float)width) / (float)height;
      const float up = ((float)height - 2 * (float)y - 1) / (float)height;
      const float direction[3] = {half * across, half * up, -1};
      first_hit(eye, direction, &pixels[(size_t)y * (size_t)width + (size_t)x]);
    }
  }
}

void room_direct(const Surfel* at, float irradiance[3]) {
  const Rectangle* lamp = &kRoom[kLamp];
  float corner[4][3], sum = 0;
  for (int k = 0; k < 4; ++k) {
    const float u = k == 1 || k == 2, v = k >= 2;
    for (int i = 0; i < 3; ++i) {
      corner[k][i] = lamp->corner[i] + u * lamp->edge1[i] + v * lamp->edge2[i] - at->position[i];
    }
    normalize(corner[k]);
  }
  for (int k = 0; k < 4; ++k) {
    float axis[3];
    cross(corner[k], corner[(k + 1) % 4], axis);
    const float sine = normalize(axis);
    sum += atan2f(sine, dot(corner[k], corner[(k + 1) % 4])) * dot(axis, at->normal);
  }
  /* The lamp shines downwards, and no wall hides any of it from another. */
  const float factor = at->position[1] < kLampHeight ? fabsf(sum) / 2 : 0;
  for (int i = 0; i < 3; ++i) irradiance[i] = factor * lamp->emission[i];
}
