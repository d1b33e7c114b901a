// The C functions that take device memory, and models opened on a GPU, against the same on the CPU.
#include <filesystem>
#include <functional>
#include <thread>
#include <vector>

#include <ATen/ATen.h>
#include <c10/core/impl/VirtualGuardImpl.h>
#include <gtest/gtest.h>

#include "lte/c_api.h"
#include "lte/nn/device.h"
#include "lte/nn/model_file.h"
#include "tests/c_api/support.h"
#include "tests/nn/support.h"
#include "tests/ops/per_device.h"
#include "tests/support/temp_dir.h"

namespace lte {
namespace {

constexpr int64_t kPoints = 300, kQueries = 90, kEach = 4;

c10::impl::VirtualGuardImpl cuda() { return c10::impl::VirtualGuardImpl(c10::kCUDA); }

class CApiCuda : public testing::Test {
 protected:
  void SetUp() override {
    const std::string obstacle = nn::cuda_obstacle();
    if (!obstacle.empty()) {
      ASSERT_FALSE(ops::test::requires_cuda()) << "LTE_REQUIRE_CUDA=1, and " << obstacle;
      GTEST_SKIP() << obstacle;
    }
    nn::ModelConfig config = test::tiny_geometric_config();
    config.light_input = nn::LightInput::Traced;
    config.light_sides = nn::LightSides::Apart;
    config.gloss = true;
    config.radiance_lobes = 6;
    config.radiance_base = nn::RadianceBase::Points;
    nn::LightTransportModel model(config);
    test::randomize(*model, 5);
    nn::save_model(folder_ / "model.safetensors", model);
    for (const int32_t device : {LTE_DEVICE_CPU, 0}) {
      lte_model_options options = {};
      options.struct_size = sizeof options;
      options.device = device;
      ASSERT_EQ(lte_model_open((folder_ / "model.safetensors").c_str(), &options,
                               device == 0 ? &on_gpu_ : &on_cpu_),
                LTE_OK)
          << lte_last_error();
    }
    points_.gloss = at::zeros({kPoints, 2});
    points_.gloss.narrow(0, 0, kPoints / 2).fill_(0.5);
    at::manual_seed(7);
    const at::Tensor way = queries_.normal.unsqueeze(1) + 0.5 * at::rand({kQueries, kEach, 3});
    directions_ = way.div(way.norm(2, {2}, true)).contiguous();
    device_points_ = points_.to(at::kCUDA);
    device_queries_ = queries_.to(at::kCUDA);
    device_directions_ = directions_.to(at::kCUDA);
    const test::Embedding embedding(on_cpu_, scene(points_));
    right_ = test::decode(embedding.handle, test::c_queries(queries_));
    right_radiance_ = at::zeros({kQueries, kEach, 3});
    const lte_queries queries = test::c_queries(queries_);
    const lte_float3_view ways = test::view(directions_);
    ASSERT_EQ(lte_embedding_decode_radiance(embedding.handle, &queries, &ways, kEach,
                                            right_radiance_.data_ptr<float>(), 0),
              LTE_OK)
        << lte_last_error();
  }
  ~CApiCuda() override {
    lte_model_release(on_cpu_);
    lte_model_release(on_gpu_);
  }

  static lte_scene_points scene(const nn::PointSet& points) {
    lte_scene_points scene = test::c_points(points, /*light=*/true);
    scene.gloss = points.gloss.const_data_ptr<float>();
    return scene;
  }

  /// What device memory encodes to, on `stream`.
  lte_embedding* encode(void* stream) const {
    const lte_scene_points points = scene(device_points_);
    lte_embedding* embedding = nullptr;
    EXPECT_EQ(lte_model_encode_cuda(on_gpu_, &points, stream, &embedding), LTE_OK)
        << lte_last_error();
    return embedding;
  }
  at::Tensor decode(const lte_embedding* embedding, const lte_queries& queries, void* stream,
                    int64_t stride = 3) const {
    at::Tensor out =
        at::full({kQueries, stride}, -1.0f, at::TensorOptions(at::kFloat).device(at::kCUDA));
    cuda().synchronizeDevice(0);
    EXPECT_EQ(lte_embedding_decode_cuda(embedding, &queries, stream, out.data_ptr<float>(),
                                        stride * static_cast<int64_t>(sizeof(float))),
              LTE_OK)
        << lte_last_error();
    cuda().synchronizeDevice(0);
    return out.cpu();
  }

  test::TempDir folder_;
  lte_model *on_cpu_ = nullptr, *on_gpu_ = nullptr;
  nn::PointSet points_ = test::box_scene(kPoints, 1), device_points_;
  nn::QuerySet queries_ = test::box_queries(kQueries, 2), device_queries_;
  at::Tensor directions_, device_directions_, right_, right_radiance_;
};

TEST_F(CApiCuda, HostMemoryOfAModelOnTheGpu) {
  const test::Embedding embedding(on_gpu_, scene(points_));
  const at::Tensor got = test::decode(embedding.handle, test::c_queries(queries_));
  EXPECT_LT(test::relative_difference(got, right_), 1e-4);
}

TEST_F(CApiCuda, DeviceMemoryOnTheDefaultStreamAndOnOthers) {
  const c10::Stream first = cuda().getNewStream({c10::kCUDA, 0}, 0);
  const c10::Stream second = cuda().getNewStream({c10::kCUDA, 0}, 0);
  const lte_queries queries = test::c_queries(device_queries_);
  for (void* encodes_on : {static_cast<void*>(nullptr), first.native_handle()}) {
    lte_embedding* embedding = encode(encodes_on);
    ASSERT_NE(embedding, nullptr);
    for (void* decodes_on : {static_cast<void*>(nullptr), second.native_handle()}) {
      const at::Tensor got = decode(embedding, queries, decodes_on);
      EXPECT_LT(test::relative_difference(got, right_), 1e-4);
    }
    // Host memory reads the same embedding.
    EXPECT_LT(test::relative_difference(test::decode(embedding, test::c_queries(queries_)), right_),
              1e-4);
    lte_embedding_release(embedding);
  }
}

TEST_F(CApiCuda, AMaskAndAStrideInDeviceMemory) {
  at::Tensor mask = at::ones({kQueries}, at::kByte);
  mask.narrow(0, 10, 20).fill_(0);
  const at::Tensor device_mask = mask.to(at::kCUDA);
  lte_queries queries = test::c_queries(device_queries_);
  queries.mask = device_mask.const_data_ptr<uint8_t>();
  lte_embedding* embedding = encode(nullptr);
  ASSERT_NE(embedding, nullptr);
  const at::Tensor got = decode(embedding, queries, nullptr, 5);
  EXPECT_LT(test::relative_difference(got.slice(1, 0, 3), right_ * mask.unsqueeze(1)), 1e-4);
  EXPECT_TRUE(got.slice(1, 3).eq(-1).all().item<bool>()) << "what lies between the answers";
  lte_embedding_release(embedding);
}

TEST_F(CApiCuda, RadianceInDeviceMemory) {
  lte_embedding* embedding = encode(nullptr);
  ASSERT_NE(embedding, nullptr);
  const lte_queries queries = test::c_queries(device_queries_);
  const lte_float3_view ways = test::view(device_directions_);
  at::Tensor out =
      at::full({kQueries, kEach, 3}, -1.0f, at::TensorOptions(at::kFloat).device(at::kCUDA));
  ASSERT_EQ(lte_embedding_decode_radiance_cuda(embedding, &queries, &ways, kEach, nullptr,
                                               out.data_ptr<float>(), 0),
            LTE_OK)
      << lte_last_error();
  EXPECT_LT(test::relative_difference(out.cpu(), right_radiance_), 1e-4);
  lte_embedding_release(embedding);
}

TEST_F(CApiCuda, BadValuesInDeviceMemoryAreNamed) {
  device_queries_.normal[7][1] = 3;
  lte_embedding* embedding = encode(nullptr);
  ASSERT_NE(embedding, nullptr);
  const lte_queries queries = test::c_queries(device_queries_);
  at::Tensor out = at::zeros({kQueries, 3}, at::TensorOptions(at::kFloat).device(at::kCUDA));
  EXPECT_EQ(lte_embedding_decode_cuda(embedding, &queries, nullptr, out.data_ptr<float>(), 0),
            LTE_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(std::string(lte_last_error()).find("row 7"), std::string::npos) << lte_last_error();
  lte_embedding_release(embedding);
}

TEST_F(CApiCuda, AnEmbeddingIsSavedAndLoadedOnEitherDevice) {
  lte_embedding* embedding = encode(nullptr);
  ASSERT_NE(embedding, nullptr);
  const auto file = folder_ / "scene.embedding";
  ASSERT_EQ(lte_embedding_save(embedding, file.c_str(), "box"), LTE_OK) << lte_last_error();
  lte_embedding_release(embedding);
  for (const lte_model* model : {on_cpu_, on_gpu_}) {
    lte_embedding* loaded = nullptr;
    ASSERT_EQ(lte_embedding_load(model, file.c_str(), "box", &loaded), LTE_OK) << lte_last_error();
    EXPECT_LT(test::relative_difference(test::decode(loaded, test::c_queries(queries_)), right_),
              1e-4);
    lte_embedding_release(loaded);
  }
}

}  // namespace
}  // namespace lte
