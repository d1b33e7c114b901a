/* The network for renderers, in C: scene points in, a light transport embedding, irradiance at any
 * surface point out, and of some models radiance from any direction. lte/c_render.h renders scene
 * files. docs/embedding-in-a-renderer.md shows how to use both.
 *
 *   lte_model* model;
 *   lte_embedding* embedding;
 *   lte_model_open("model.safetensors", NULL, &model);
 *   lte_model_encode(model, &scene_points, &embedding);
 * and every frame, with a G-buffer as queries,
 *   lte_embedding_decode(embedding, &queries, irradiance, 0);
 *
 * Units: metres; emission is radiance in W sr^-1 m^-2, irradiance in W/m^2 and not divided by pi;
 * colors are linear Rec.709. World space is the caller's; nothing depends on which axis is up.
 *
 * Errors: a function that can fail returns an lte_status, and LTE_OK alone is 0. lte_last_error()
 * says what went wrong. Nothing throws, exits or prints. The outputs of a failed call are
 * undefined, but for handles, which are then NULL.
 *
 * Ownership: what a function reads is never written, and borrowed until it returns; functions that
 * take a stream borrow it until the stream has passed. A handle belongs to the caller and ends with
 * its release function. An embedding keeps its model alive, so the order of releases is free.
 *
 * Threads: every function may run in any thread, also at the same time on the same handles, except
 * that a release must be the last call that names its handle. A call uses lte_threads() threads.
 *
 * Growth: structs begin with their size, which the caller sets. Fields are only ever added, at the
 * end, and mean nothing new when they are 0. So write
 *   lte_queries queries = {sizeof(lte_queries)};
 * and the program keeps running with later libraries of the same LTE_C_API_VERSION.
 */
#ifndef LTE_C_API_H_
#define LTE_C_API_H_

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define LTE_API __attribute__((visibility("default")))
#else
#define LTE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Version of the binary interface; the shared library's name ends with it. */
#define LTE_C_API_VERSION 1

typedef enum lte_status {
  LTE_OK = 0,
  LTE_ERROR_INVALID_ARGUMENT = 1, /**< null, wrong size, not finite, out of range */
  LTE_ERROR_FILE = 2,             /**< missing, no model, newer format, damaged */
  LTE_ERROR_SCENE_TOO_LARGE = 3,  /**< wider than the model's scale, and `rescale` is 0 */
  LTE_ERROR_NO_CUDA = 4,          /**< built without CUDA, or there is no such GPU */
  LTE_ERROR_CUDA = 5,             /**< CUDA says so; the GPU's state may be lost */
  LTE_ERROR_OUT_OF_MEMORY = 6,
  LTE_ERROR_INTERNAL = 7, /**< a fault of this library */
  LTE_STOPPED = 8         /**< the caller's progress function has ended the call (lte/c_render.h) */
} lte_status;

/** A loaded network. */
typedef struct lte_model lte_model;
/** The light transport embedding of one scene. */
typedef struct lte_embedding lte_embedding;

/* ---- The library ---- */

/** Returns LTE_C_API_VERSION of the library in use. */
LTE_API uint32_t lte_abi_version(void);

/** Returns "0.1.0" or the like; the text is static. */
LTE_API const char* lte_version_string(void);

/** Returns 1 if the library was built with CUDA, whether or not there is a GPU. */
LTE_API int32_t lte_built_with_cuda(void);

/** Returns one line about the last call of this thread that failed, "" if none has. It holds at
 *  most 1,023 bytes and stays valid until the next failure in this thread. */
LTE_API const char* lte_last_error(void);

/** Sets the CPU threads of every later call, whichever thread makes it.
 *  @param threads  1 to four times the processors of the machine, or 64 where that is less; refused
 *                  too where the system does not give so many threads now */
LTE_API lte_status lte_set_threads(int32_t threads);

/** Returns the CPU threads of a call from this thread: LibTorch's default, all cores, before
 *  lte_set_threads(). */
LTE_API int32_t lte_threads(void);

/* ---- Models ---- */

#define LTE_DEVICE_CPU (-1)

typedef struct lte_model_options {
  size_t struct_size;
  int32_t device;   /**< LTE_DEVICE_CPU, or the number of a CUDA device */
  int32_t reserved; /**< 0 */
} lte_model_options;

/** Loads a network.
 *  @param path     UTF-8; a model's .safetensors, as lte_train writes
 *  @param options  NULL: on the CPU
 *  @param model    receives the handle
 *  @note A model of 42 M parameters takes 170 MB. */
LTE_API lte_status lte_model_open(const char* path, const lte_model_options* options,
                                  lte_model** model);

/** The light on scene points that is input of the network, beside their emission. */
typedef enum lte_light_input {
  LTE_LIGHT_EMISSION = 0, /**< none */
  LTE_LIGHT_TRACED = 2    /**< lte_scene_points::direct and indirect, those of the back, and
                               indirect_error */
} lte_light_input;

typedef struct lte_model_info {
  size_t struct_size;
  int64_t channels; /**< D, the network's width */
  int64_t parameters;
  int64_t query_neighbours;    /**< latents that a query reads */
  int64_t scene_points;        /**< how many the model was trained with: what it wants */
  int32_t scene_points_pruned; /**< 1: all of them were points that light can reach */
  int32_t unused;              /**< 0 */
  double scale;                /**< s, metres: the widest scene that it knows */
  int32_t device;              /**< as in lte_model_options */
  int32_t light_input;         /**< lte_light_input */
  int32_t suns;                /**< 1: training saw directional lights; 0: answers about them are
                                    those of a network that never met one */
  int32_t reserved;            /**< 0 */
  int32_t light_sides;         /**< 1 with LTE_LIGHT_TRACED: it reads direct_back, indirect_back */
  int32_t light_variance;      /**< 1 with LTE_LIGHT_TRACED: it reads indirect_error */
  int32_t light_paths;         /**< paths a side behind the estimates of the training, with
                                    LTE_LIGHT_TRACED */
  int32_t light_depth;         /**< surface hits of those paths */
  int32_t needs_area;          /**< 1: it works on the points' own areas, so that
                                    lte_scene_points::area must be given, in m^2 */
  int32_t gloss;               /**< 1: it reads lte_scene_points::gloss */
  int32_t predicts_radiance;   /**< 1: lte_embedding_decode_radiance() answers */
} lte_model_info;

/** Describes a model.
 *  @param info  its struct_size is set, the rest is filled in */
LTE_API lte_status lte_model_get_info(const lte_model* model, lte_model_info* info);

/** Ends a handle; NULL is fine. */
LTE_API void lte_model_release(lte_model* model);

/* ---- Scenes ---- */

/** `count` triples of float32, triple i at (const char*)data + i * stride. */
typedef struct lte_float3_view {
  const float* data;
  int64_t stride; /**< bytes, a multiple of 4, at least 12; 0: 12, without gaps */
} lte_float3_view;

/** Samples of a scene's surfaces, and of lights that are none. All arrays have `count` entries and
 *  hold finite values. Lights that are no surface are black emissive points, with direct and
 *  indirect 0, and need `area`:
 *  - A point light of power W is two points in its place, normals up and down, each of area a,
 *    that of any other point, and emission W / (2 pi a). A spot light is one whose normal is its
 *    direction, of emission W / (pi a): the width of its cone is not among the data of points.
 *  - A sun (directional light) of irradiance E on what faces it stands on the sphere around the
 *    bounds of the surfaces (centre c, radius r, half their diagonal): position c - r d and normal
 *    d, where d is the unit direction in which its light travels. It takes the solid angle
 *    w = 4 pi / (0.05 count), so emission is E / w and area w r^2.
 *  - The environment is 0.05 count such points, spread evenly over that sphere, whose emission is
 *    its mean radiance over the solid angle w of each. */
typedef struct lte_scene_points {
  size_t struct_size;
  int64_t count;            /**< M, at least 1; lte_model_info::scene_points is best */
  lte_float3_view position; /**< world, metres */
  lte_float3_view normal;   /**< unit, of the side that is lit, whatever the mesh's winding */
  lte_float3_view albedo;   /**< in [0, 16], usually [0, 1] */
  lte_float3_view emission; /**< radiance towards the normal, not negative; a surface that emits
                                 from both sides has points on either, back to back */
  /** Irradiance at the points, W/m^2, not negative, 0 on luminaires. It is the sum over both sides
   *  of the surface; the inner side of a closed body is dark. Estimates may be noisy but not
   *  biased: those of the training came from 32 paths a side. lte_model_info::light_input says
   *  which are needed; data of the others may be NULL. */
  lte_float3_view direct;   /**< from luminaires straight */
  lte_float3_view indirect; /**< after one bounce or more */
  const float* area;   /**< m^2 that each point stands for, without gaps; NULL: all the same, as
                            when they were drawn uniformly by area. Refused as NULL where
                            lte_model_info::needs_area is 1; else a common factor is free */
  const float* origin; /**< 3 floats, always host memory: the least corner of the scene, no more
                            than any position. NULL: that of the points. Give it so that the
                            embedding of an edited scene changes no more than the edit asks for */
  int32_t rescale;     /**< 1: for the network alone a scene wider than the model's scale is
                            shrunk, and one narrower than a quarter of it enlarged; exact for light
                            that comes from surfaces */
  int32_t reserved;    /**< 0 */
  /** The share of direct and indirect that falls on the side that the normal leaves behind; with
   *  LTE_LIGHT_TRACED, else data may be NULL. */
  lte_float3_view direct_back;
  lte_float3_view indirect_back;
  /** Two floats a point, without gaps: the standard error of the indirect irradiance that falls on
   *  the front, and on the back, over its value, of the mean over the channels, in [0, 1] and 0
   *  where there is no light. With LTE_LIGHT_TRACED; else it may be NULL. */
  const float* indirect_error;
  /** Two floats a point, without gaps, in [0, 1]: how metallic it is, and how rough (the square is
   *  GGX's alpha). Of metal, albedo is the reflectance at normal incidence. Read where
   *  lte_model_info::gloss is 1. NULL: nothing is metal, as for programs older than the field. */
  const float* gloss;
} lte_scene_points;

/** Runs the encoder. */
LTE_API lte_status lte_model_encode(const lte_model* model, const lte_scene_points* points,
                                    lte_embedding** embedding);

typedef struct lte_embedding_info {
  size_t struct_size;
  int64_t scene_points; /**< M that were encoded */
  int64_t latents;      /**< m, about M / 4 */
  int64_t bytes;        /**< of memory that the embedding holds */
  double origin[3];     /**< least corner, world */
  double scale;         /**< metres that the network takes for its unit; other than the model's if
                             the scene was rescaled */
  double radiance[3];   /**< mean emission by channel, gain included; irradiance is scaled by it */
} lte_embedding_info;

/** Describes an embedding.
 *  @param info  its struct_size is set, the rest is filled in */
LTE_API lte_status lte_embedding_get_info(const lte_embedding* embedding, lte_embedding_info* info);

/** Dims or tints all light of the scene: exact, as light is linear, and free.
 *  @param rgb  3 finite floats, not negative: the gain over the emission that was encoded, not over
 *              an earlier gain
 *  @note Calls of lte_embedding_decode() that have begun keep the earlier gain. */
LTE_API lte_status lte_embedding_set_emission_gain(lte_embedding* embedding, const float* rgb);

/** Writes an embedding to a file, which appears whole or not at all. An emission gain is no part of
 *  it: gain 1 is saved.
 *  @param path   UTF-8; by habit .safetensors
 *  @param scene  what the scene is called or hashed to, at most 1,000 bytes of printable
 *                ASCII, for lte_embedding_load() to compare; NULL: nothing
 *  @note A file that cannot be written is LTE_ERROR_FILE. */
LTE_API lte_status lte_embedding_save(const lte_embedding* embedding, const char* path,
                                      const char* scene);

/** Reads an embedding that lte_embedding_save() has written, in the place of lte_model_encode().
 *  @param model  of the same weights as the one that encoded it, on whatever device; its answers
 *                are then the same bits
 *  @param scene  as it was saved
 *  @note LTE_ERROR_FILE is a file that is missing, damaged, of a newer format, of another model or
 *        of another scene; lte_last_error() tells which. */
LTE_API lte_status lte_embedding_load(const lte_model* model, const char* path, const char* scene,
                                      lte_embedding** embedding);

/** Ends a handle; NULL is fine. */
LTE_API void lte_embedding_release(lte_embedding* embedding);

/* ---- Queries ---- */

/** The caller vouches for finite values, normals with components in [-1, 1] and albedos in [0, 16].
 *  Nothing is checked then, but that CPU decoding still refuses positions that are not finite. With
 *  CUDA the host waits for nothing. */
#define LTE_QUERIES_TRUSTED 1u

/** Surface points to ask about; a G-buffer, for example. Arrays may lie interleaved. */
typedef struct lte_queries {
  size_t struct_size;
  int64_t count;            /**< N, 0 or more */
  lte_float3_view position; /**< world, metres */
  lte_float3_view normal;   /**< unit, towards the side asked about */
  lte_float3_view albedo;   /**< in [0, 16], usually [0, 1] */
  const uint8_t* mask;      /**< where it is 0 (background) nothing is read nor decoded, and the
                                 answer is 0; NULL: everywhere */
  int64_t mask_stride;      /**< bytes; 0: 1 */
  uint32_t flags;           /**< 0 or LTE_QUERIES_TRUSTED */
  int32_t reserved;         /**< 0 */
} lte_queries;

/** Computes irradiance at every query, of light after one bounce or more: the renderer adds direct
 *  light.
 *
 *  @param irradiance         [N, 3] float32, W/m^2; overlaps none of the queries' arrays
 *  @param irradiance_stride  bytes from one triple to the next, a multiple of 4, at least 12; 0: 12
 *  @note A query's answer depends neither on the other queries nor on the number of threads.
 *  @note Works in blocks that take some 50 MB, on a GPU 200 MB, however many queries there are.
 *        Besides, the answer and the checks take 24 bytes a query. Queries go to a GPU as a whole,
 *        if that is where the model is. */
LTE_API lte_status lte_embedding_decode(const lte_embedding* embedding, const lte_queries* queries,
                                        float* irradiance, int64_t irradiance_stride);

/** Computes incident radiance at every query from directions of its own, of light after one bounce
 *  or more: a lamp is seen in metal but not at once. Needs lte_model_info::predicts_radiance.
 *
 *  @param directions          [N, D] triples, the first query's, then the second's and so on: unit,
 *                             world, away from the surface, to where the light comes from. Lengths
 *                             may be off by 0.01, and cosines to the normal as low as -0.01.
 *  @param directions_a_query  D, at least 1. Further ones are cheap: what a query knows of its
 *                             surroundings is gathered once.
 *  @param radiance            [N, D, 3] float32, W sr^-1 m^-2; overlaps none of the other arrays
 *  @param radiance_stride     as irradiance_stride of lte_embedding_decode()
 *  @note Where the mask is 0 no direction is read, and the answers are 0. LTE_QUERIES_TRUSTED
 *        vouches for the directions too.
 *  @note An answer depends on the other queries and directions by rounding alone.
 *  @note Works in blocks that take some 200 MB; besides, the checks take 30 bytes a direction. */
LTE_API lte_status lte_embedding_decode_radiance(const lte_embedding* embedding,
                                                 const lte_queries* queries,
                                                 const lte_float3_view* directions,
                                                 int64_t directions_a_query, float* radiance,
                                                 int64_t radiance_stride);

/* ---- CUDA ----
 * The same with arrays in device memory (or managed, or pinned and mapped) of the GPU on which the
 * model was opened, on the caller's stream. In a library built without CUDA they return
 * LTE_ERROR_NO_CUDA. tests/c_api holds them against the CPU where there is a GPU. */

/** lte_model_encode() with all arrays but origin in device memory.
 *  @param stream  a cudaStream_t of the model's device; NULL is the default stream
 *  @note The host waits in between, as neighbourhoods are made on it. The last kernels may still
 *        run when the function returns; any stream may decode, as it waits for them by itself. */
LTE_API lte_status lte_model_encode_cuda(const lte_model* model, const lte_scene_points* points,
                                         void* stream, lte_embedding** embedding);

/** lte_embedding_decode() with position, normal, albedo, mask and irradiance in device memory.
 *  @note Enqueues and returns. The host waits for the check without LTE_QUERIES_TRUSTED, and for
 *        the number of queries with a mask. */
LTE_API lte_status lte_embedding_decode_cuda(const lte_embedding* embedding,
                                             const lte_queries* queries, void* stream,
                                             float* irradiance, int64_t irradiance_stride);

/** lte_embedding_decode_radiance() with all arrays in device memory.
 *  @note The host waits as in lte_embedding_decode_cuda(). */
LTE_API lte_status lte_embedding_decode_radiance_cuda(const lte_embedding* embedding,
                                                      const lte_queries* queries,
                                                      const lte_float3_view* directions,
                                                      int64_t directions_a_query, void* stream,
                                                      float* radiance, int64_t radiance_stride);

#ifdef __cplusplus
}
#endif

#endif /* LTE_C_API_H_ */
