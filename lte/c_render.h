/* Pictures and light of scene files, in C: the progressive renderer of lte/render.
 *
 *   lte_scene* scene;
 *   lte_integrator* integrator;
 *   lte_camera camera = {sizeof camera};
 *   lte_picture picture = {sizeof picture, 640, 480};
 *   picture.color = color; // 640 * 480 * 3 floats
 *   lte_scene_open("room.glb", NULL, &scene);
 *   lte_scene_get_camera(scene, 0, &camera);
 *   lte_integrator_create(scene, NULL, &integrator);
 * and for each view
 *   lte_render(integrator, &camera, NULL, &picture);
 *
 * lte/c_api.h has the rules of units, errors, ownership, threads and growth. An integrator keeps
 * its scene alive. A library that was built with LTE_SCENE=OFF has none of these functions. All is
 * computed on the CPU, but a network may be on a GPU. */
#ifndef LTE_C_RENDER_H_
#define LTE_C_RENDER_H_

#include "lte/c_api.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A scene of triangles that rays are traced in. */
typedef struct lte_scene lte_scene;
/** A way to compute irradiance in a scene. */
typedef struct lte_integrator lte_integrator;

/* ---- Scenes ---- */

typedef struct lte_scene_options {
  size_t struct_size;
  int32_t z_up;     /**< 1: the file's z axis points up, as in many OBJ, PLY and PBRT files; the
                         scene is turned to y up, (x, y, z) to (x, z, -y) */
  int32_t reserved; /**< 0 */
} lte_scene_options;

/** Reads a scene: glTF, OBJ, PLY or PBRT (docs/scene-formats.md). Nothing outside its folder is
 *  read, whatever it names.
 *  @param path     UTF-8
 *  @param options  NULL: y is up
 *  @param scene    receives the handle
 *  @note A file that is missing, damaged or of another format is LTE_ERROR_FILE. */
LTE_API lte_status lte_scene_open(const char* path, const lte_scene_options* options,
                                  lte_scene** scene);

typedef struct lte_scene_info {
  size_t struct_size;
  int64_t triangles; /**< instanced */
  int64_t cameras;
  int64_t lights;      /**< luminaires: emissive instances, punctual lights, the environment */
  float bounds_min[3]; /**< world, metres */
  float bounds_max[3];
} lte_scene_info;

/** Describes a scene.
 *  @param info  its struct_size is set, the rest is filled in */
LTE_API lte_status lte_scene_get_info(const lte_scene* scene, lte_scene_info* info);

/** A perspective camera; pixel (0, 0) is the top left. */
typedef struct lte_camera {
  size_t struct_size;
  float origin[3], target[3], up[3]; /**< world */
  float vfov;                        /**< vertical field of view, degrees */
  int32_t mirrored;                  /**< 1: left and right change places */
  int32_t reserved;                  /**< 0 */
} lte_camera;

/** A camera that is made for the scene: from inside a room, else from outside. */
#define LTE_CAMERA_AUTO (-1)

/** Returns a camera of the scene.
 *  @param number  from 0, or LTE_CAMERA_AUTO
 *  @param camera  its struct_size is set, the rest is filled in */
LTE_API lte_status lte_scene_get_camera(const lte_scene* scene, int64_t number, lte_camera* camera);

typedef struct lte_scene_encode_options {
  size_t struct_size;
  int64_t scene_points; /**< 0: as many as the scene needs */
  uint64_t seed;
  int32_t rescale;  /**< lte_scene_points::rescale */
  int32_t reserved; /**< 0 */
} lte_scene_encode_options;

/** Draws a scene's points, computes the light on them that the model reads, and encodes them: what
 *  a caller of lte_model_encode() does by itself.
 *  @param options  NULL: zeros */
LTE_API lte_status lte_scene_encode(const lte_scene* scene, const lte_model* model,
                                    const lte_scene_encode_options* options,
                                    lte_embedding** embedding);

/** Ends a handle; NULL is fine. */
LTE_API void lte_scene_release(lte_scene* scene);

/* ---- Integrators ---- */

typedef enum lte_method {
  LTE_METHOD_GATHER = 0,  /**< rays read path-traced light in an irradiance cache on surfaces */
  LTE_METHOD_NETWORK = 1, /**< the same rays read light that a network knows there */
  LTE_METHOD_PATH = 2     /**< path tracing alone: unbiased, noisy */
} lte_method;

typedef struct lte_integrator_options {
  size_t struct_size;
  int32_t method;                 /**< lte_method */
  int32_t max_depth;              /**< surface hits of a path of light after the point whose light
                                       is computed; 0: 5 */
  const lte_embedding* embedding; /**< of this scene, for LTE_METHOD_NETWORK alone; read before
                                       lte_integrator_create() returns, not kept */
  int64_t records;                /**< of the irradiance cache; 0: 4,096 */
  int32_t record_paths;           /**< paths of each record; 0: 16 */
  int32_t reserved;               /**< 0 */
  uint64_t seed;
} lte_integrator_options;

/** Makes an integrator and its irradiance cache, which takes some tenths of a second. It serves any
 *  number of pictures and points.
 *  @param options  NULL: zeros, which is LTE_METHOD_GATHER */
LTE_API lte_status lte_integrator_create(const lte_scene* scene,
                                         const lte_integrator_options* options,
                                         lte_integrator** integrator);

/** Computes irradiance at points of surfaces, W/m^2, not divided by pi.
 *  @param points    position, normal (unit, of the side that is lit) and mask are read; albedo is
 *                   not, and may be NULL
 *  @param samples   rays of indirect light, and as many samples of direct light, of each point; 1
 *                   to 65,536
 *  @param direct    [N, 3] float32, of light that no surface has reflected; NULL: not wanted
 *  @param indirect  [N, 3] float32, of all other light; NULL: not wanted
 *  @param stride    as irradiance_stride of lte_embedding_decode(), of both
 *  @note The result does not depend on the number of threads. Point k of those that the mask keeps
 *        draws from random stream (seed, k). */
LTE_API lte_status lte_integrator_irradiance(const lte_integrator* integrator,
                                             const lte_queries* points, int32_t samples,
                                             uint64_t seed, float* direct, float* indirect,
                                             int64_t stride);

/** Ends a handle; NULL is fine. */
LTE_API void lte_integrator_release(lte_integrator* integrator);

/* ---- Pictures ---- */

/** A picture, and what it shows. Each array has width * height entries without gaps, row after row
 *  from the top; NULL: not wanted. In every pixel
 *    color = emission + albedo / pi * (direct + indirect). */
typedef struct lte_picture {
  size_t struct_size;
  int32_t width, height; /**< 1 to 32,768, and 2^28 pixels at most */
  float* color;          /**< 3 floats each: radiance, the environment included */
  float* albedo;         /**< 3 floats each */
  float* normal;         /**< 3 floats each: unit, world; 0 in the background */
  float* depth;          /**< 1 float each: metres along the camera's axis; 0 in the background */
  float* emission;       /**< 3 floats each: radiance */
  float* direct;         /**< 3 floats each: irradiance, W/m^2 */
  float* indirect;       /**< 3 floats each: irradiance by all later bounces */
} lte_picture;

typedef struct lte_render_options {
  size_t struct_size;
  int32_t passes;     /**< each gives every pixel its samples once more, with LTE_METHOD_PATH four
                           paths; 0: 16, or with `seconds` as many as there is time for. From the
                           ninth on, paths correct the other methods. The fewer, the quicker they
                           are denoised: 1 is a draft, 4 a preview */
  int32_t keep_noise; /**< 1: no denoising, and no correction by paths */
  double seconds;     /**< no pass begins that would end later; denoising comes on top. 0: no limit.
                           The first pass is made in any case */
  uint64_t seed;
  /** Called now and then by the thread that renders, with the share of the work that is done; a
   *  return value other than 0 ends the call with LTE_STOPPED. NULL: not called. */
  int32_t (*progress)(void* user, double share);
  void* user;       /**< handed to `progress` */
  int32_t reserved; /**< 0 */
  int32_t unused;   /**< 0 */
} lte_render_options;

/** Renders a picture into the caller's arrays.
 *  @param options  NULL: zeros
 *  @param picture  read; its arrays are written
 *  @note Equal inputs without `seconds` give the same bits, whatever the number of threads.
 *  @note Works in some 1,000 bytes a pixel. */
LTE_API lte_status lte_render(const lte_integrator* integrator, const lte_camera* camera,
                              const lte_render_options* options, const lte_picture* picture);

#ifdef __cplusplus
}
#endif

#endif /* LTE_C_RENDER_H_ */
