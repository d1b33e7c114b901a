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

float room_sample(Surfel* points, size_t count, uint32_t seed) {
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
  return total / (float)count;
}

/* Distance along the ray to `r`, negative if it misses. Walls are seen from their front alone. */
static float intersect(const Rectangle* r, const float from[3], const float direction[3], float* u,
                       float* v) {
  float normal[3], to[3];
  cross(r->edge1, r->edge2, normal);
  const float slope = dot(normal, direction);
  if (slope == 0 || (slope > 0 && r != &kRoom[kLamp])) return -1;
  for (int i = 0; i < 3; ++i) to[i] = r->corner[i] - from[i];
  const float t = dot(to, normal) / slope;
  float in[3];
  for (int i = 0; i < 3; ++i) in[i] = t * direction[i] - to[i];
  *u = dot(in, r->edge1) / dot(r->edge1, r->edge1);
  *v = dot(in, r->edge2) / dot(r->edge2, r->edge2);
  return *u >= 0 && *u <= 1 && *v >= 0 && *v <= 1 ? t : -1;
}

/* What a ray meets first: a rectangle's number, or -1 along an edge where it may miss all. */
static int first_hit(const float from[3], const float direction[3], Surfel* hit) {
  float nearest = INFINITY;
  int found = -1;
  for (int r = 0; r < kRectangles; ++r) {
    float u, v;
    const float t = intersect(&kRoom[r], from, direction, &u, &v);
    if (t <= 0 || t >= nearest) continue;
    nearest = t;
    found = r;
    surfel_at(&kRoom[r], u, v, hit);
  }
  return found;
}

void room_gbuffer(Pixel* pixels, int width, int height) {
  const float eye[3] = {2, 1.3f, 4.9f}, half = 0.75f; /* tangent of half the field of view */
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float across = (2 * (float)x + 1 - (float)width) / (float)height;
      const float up = ((float)height - 2 * (float)y - 1) / (float)height;
      const float direction[3] = {half * across, half * up, -1};
      Pixel* pixel = &pixels[(size_t)y * (size_t)width + (size_t)x];
      const int hit = first_hit(eye, direction, &pixel->hit);
      if (hit < 0) surfel_at(&kRoom[0], 0, 0, &pixel->hit); /* the floor's corner */
      pixel->reflects = hit != kLamp;
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

/* A direction around `normal`, drawn in proportion to the cosine of the angle between them. */
static void cosine_direction(const float normal[3], uint32_t* seed, float out[3]) {
  const float radius = sqrtf(uniform(seed)), angle = 6.2831853f * uniform(seed);
  const float helper[3] = {fabsf(normal[0]) < 0.5f, fabsf(normal[0]) >= 0.5f, 0};
  float x[3], y[3];
  cross(helper, normal, x);
  normalize(x);
  cross(normal, x, y);
  const float a = radius * cosf(angle), b = radius * sinf(angle);
  const float c = sqrtf(fmaxf(0, 1 - radius * radius));
  for (int i = 0; i < 3; ++i) out[i] = a * x[i] + b * y[i] + c * normal[i];
}

/* The standard error of a mean over it, of `count` values by their sum and that of squares. */
static float relative_error(float sum, float squares, int count) {
  if (sum <= 0 || count < 2) return 0;
  const float mean = sum / (float)count;
  const float variance = fmaxf(0, squares / (float)count - mean * mean) / (float)(count - 1);
  return fminf(1, sqrtf(variance) / mean);
}

float room_light(const Surfel* at, int paths, uint32_t seed, float direct[3], float indirect[3]) {
  enum { kBounces = 4 }; /* with the direct light of the last, paths of five surfaces */
  for (int c = 0; c < 3; ++c) direct[c] = indirect[c] = 0;
  if (at->emission[0] > 0) return 0; /* on the lamp, as lte_scene_points wants it */
  room_direct(at, direct);
  float sum = 0, squares = 0; /* of what the paths bring, all channels together */
  for (int p = 0; p < paths; ++p) {
    Surfel here = *at;
    float weight[3] = {1, 1, 1}, brought = 0;
    for (int bounce = 0; bounce < kBounces; ++bounce) {
      float direction[3], lit[3];
      cosine_direction(here.normal, &seed, direction);
      Surfel next;
      const int hit = first_hit(here.position, direction, &next);
      if (hit < 0 || hit == kLamp) break; /* the lamp's own light is direct */
      here = next;
      room_direct(&here, lit);
      for (int c = 0; c < 3; ++c) {
        weight[c] *= here.albedo[c];
        indirect[c] += weight[c] * lit[c] / (float)paths;
        brought += weight[c] * lit[c];
      }
    }
    sum += brought;
    squares += brought * brought;
  }
  return relative_error(sum, squares, paths);
}
