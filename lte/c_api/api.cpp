// The functions of lte/c_api.h: null checks, structs in and out, and nothing past the boundary.
#include "lte/c_api.h"
#include "lte/c_api/arguments.h"
#include "lte/c_api/error.h"
#include "lte/c_api/handles.h"
#include "lte/c_api/scene.h"
#include "lte/runtime/device.h"

using lte::c_api::apply_threads;
using lte::c_api::guarded;
using lte::c_api::read_struct;
using lte::c_api::require;
using lte::c_api::write_struct;
using lte::runtime::Device;
using lte::runtime::StreamScope;

namespace {

lte_embedding* encode(const lte_model* model, const lte_scene_points* points, Device memory) {
  apply_threads();
  return new lte_embedding{lte::c_api::encode(
      model->network,
      read_struct(points, "lte_scene_points", offsetof(lte_scene_points, direct_back)), memory)};
}

void decode(const lte_embedding* embedding, const lte_queries* queries, Device memory,
            float* irradiance, int64_t stride) {
  apply_threads();
  lte::c_api::decode(embedding->scene, read_struct(queries, "lte_queries"), memory, irradiance,
                     stride);
}

void decode_radiance(const lte_embedding* embedding, const lte_queries* queries,
                     const lte::c_api::Directions& directions, Device memory, float* radiance,
                     int64_t stride) {
  apply_threads();
  lte::c_api::decode_radiance(embedding->scene, read_struct(queries, "lte_queries"), directions,
                              memory, radiance, stride);
}

lte_model_info info_of(const lte::runtime::Network& network) {
  const lte::runtime::ModelConfig& config = network.config();
  lte_model_info info = {};
  info.channels = config.channels;
  info.parameters = network.parameters();
  info.query_neighbours = config.query_neighbours;
  info.scene_points = network.metadata().scene_points;
  info.scene_points_pruned = network.metadata().scene_points_pruned;
  info.scale = config.scale;
  info.device = network.device().is_cpu() ? LTE_DEVICE_CPU : network.device().gpu;
  info.light_input = config.reads_estimates() ? LTE_LIGHT_TRACED : LTE_LIGHT_EMISSION;
  info.suns = network.metadata().suns;
  info.light_sides = info.light_variance = config.reads_estimates();
  info.needs_area = lte::c_api::needs_area(config);
  info.gloss = config.predicts_radiance();
  info.predicts_radiance = config.predicts_radiance();
  if (config.reads_estimates()) {
    info.light_paths = network.metadata().light_paths;
    info.light_depth = network.metadata().light_depth;
  }
  return info;
}

}  // namespace

uint32_t lte_abi_version(void) { return LTE_C_API_VERSION; }
const char* lte_version_string(void) { return LTE_VERSION; }
int32_t lte_built_with_cuda(void) { return LTE_WITH_CUDA; }
const char* lte_last_error(void) { return lte::c_api::last_error(); }

lte_status lte_set_threads(int32_t threads) {
  return guarded([&] { lte::c_api::set_threads(threads); });
}

int32_t lte_threads(void) {
  int32_t threads = 0;
  guarded([&] {
    apply_threads();
    threads = lte::runtime::torch_threads();
  });
  return threads;
}

lte_status lte_model_open(const char* path, const lte_model_options* options, lte_model** model) {
  if (model != nullptr) *model = nullptr;
  return guarded(
      [&] {
        require(model != nullptr, "model is null");
        require(path != nullptr, "path is null");
        const int32_t device =
            options == nullptr ? LTE_DEVICE_CPU : read_struct(options, "lte_model_options").device;
        apply_threads();
        *model =
            new lte_model{lte::runtime::Network(path, {.device = lte::c_api::device_of(device)})};
      },
      LTE_ERROR_FILE);
}

lte_status lte_model_get_info(const lte_model* model, lte_model_info* info) {
  return guarded([&] {
    require(model != nullptr, "model is null");
    write_struct(info_of(model->network), info, "lte_model_info", offsetof(lte_model_info, suns));
  });
}

void lte_model_release(lte_model* model) { delete model; }

lte_status lte_model_encode(const lte_model* model, const lte_scene_points* points,
                            lte_embedding** embedding) {
  if (embedding != nullptr) *embedding = nullptr;
  return guarded([&] {
    require(embedding != nullptr, "embedding is null");
    require(model != nullptr, "model is null");
    *embedding = encode(model, points, Device{});
  });
}

lte_status lte_model_encode_cuda(const lte_model* model, const lte_scene_points* points,
                                 void* stream, lte_embedding** embedding) {
  if (embedding != nullptr) *embedding = nullptr;
  return guarded([&] {
    require(embedding != nullptr, "embedding is null");
    require(model != nullptr, "model is null");
    const Device device = model->network.device();
    const StreamScope scope(device, stream);
    *embedding = encode(model, points, device);
  });
}

lte_status lte_embedding_get_info(const lte_embedding* embedding, lte_embedding_info* info) {
  return guarded([&] {
    require(embedding != nullptr, "embedding is null");
    write_struct(lte::c_api::info_of(embedding->scene), info, "lte_embedding_info");
  });
}

lte_status lte_embedding_set_emission_gain(lte_embedding* embedding, const float* rgb) {
  return guarded([&] {
    require(embedding != nullptr, "embedding is null");
    lte::c_api::set_gain(&embedding->scene, rgb);
  });
}

lte_status lte_embedding_save(const lte_embedding* embedding, const char* path, const char* scene) {
  return guarded(
      [&] {
        require(embedding != nullptr, "embedding is null");
        require(path != nullptr, "path is null");
        lte::c_api::save(embedding->scene, path, scene);
      },
      LTE_ERROR_FILE);
}

lte_status lte_embedding_load(const lte_model* model, const char* path, const char* scene,
                              lte_embedding** embedding) {
  if (embedding != nullptr) *embedding = nullptr;
  return guarded(
      [&] {
        require(embedding != nullptr, "embedding is null");
        require(model != nullptr, "model is null");
        require(path != nullptr, "path is null");
        apply_threads();
        *embedding = new lte_embedding{lte::c_api::load(model->network, path, scene)};
      },
      LTE_ERROR_FILE);
}

void lte_embedding_release(lte_embedding* embedding) { delete embedding; }

lte_status lte_embedding_decode(const lte_embedding* embedding, const lte_queries* queries,
                                float* irradiance, int64_t irradiance_stride) {
  return guarded([&] {
    require(embedding != nullptr, "embedding is null");
    decode(embedding, queries, Device{}, irradiance, irradiance_stride);
  });
}

lte_status lte_embedding_decode_cuda(const lte_embedding* embedding, const lte_queries* queries,
                                     void* stream, float* irradiance, int64_t irradiance_stride) {
  return guarded([&] {
    require(embedding != nullptr, "embedding is null");
    const Device device = embedding->scene.network().device();
    const StreamScope scope(device, stream);
    decode(embedding, queries, device, irradiance, irradiance_stride);
  });
}

lte_status lte_embedding_decode_radiance(const lte_embedding* embedding, const lte_queries* queries,
                                         const lte_float3_view* directions,
                                         int64_t directions_a_query, float* radiance,
                                         int64_t radiance_stride) {
  return guarded([&] {
    require(embedding != nullptr, "embedding is null");
    decode_radiance(embedding, queries, {directions, directions_a_query}, Device{}, radiance,
                    radiance_stride);
  });
}

lte_status lte_embedding_decode_radiance_cuda(const lte_embedding* embedding,
                                              const lte_queries* queries,
                                              const lte_float3_view* directions,
                                              int64_t directions_a_query, void* stream,
                                              float* radiance, int64_t radiance_stride) {
  return guarded([&] {
    require(embedding != nullptr, "embedding is null");
    const Device device = embedding->scene.network().device();
    const StreamScope scope(device, stream);
    decode_radiance(embedding, queries, {directions, directions_a_query}, device, radiance,
                    radiance_stride);
  });
}
