// The C functions that take device memory, and models opened on a GPU, against the same on the CPU.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <thread>
#include <vector>

#include <ATen/ATen.h>
#include <c10/core/impl/VirtualGuardImpl.h>
#include <gtest/gtest.h>

#include "lte/base/random.h"
#include "lte/c_api.h"
#include "lte/nn/device.h"
#include "tests/c_api/support.h"
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
    config.radiance_lobes = 6;
    test::save_random_model(folder_ / "model.safetensors", config);
    for (const int32_t device : {LTE_DEVICE_CPU, 0}) {
      lte_model_options options = {};
      options.struct_size = sizeof options;
      options.device = device;
      ASSERT_EQ(lte_model_open((folder_ / "model.safetensors").c_str(), &options,
                               device == 0 ? &on_gpu_ : &on_cpu_),
                LTE_OK)
          << lte_last_error();
    }
    scene_.gloss.assign(2 * kPoints, 0);
    std::fill_n(scene_.gloss.begin(), kPoints, 0.5f);
    Rng rng(7);
    for (const Vec3& normal : queries_.normal) {
      for (int64_t i = 0; i < kEach; ++i) {
        const float x = rng.uniform(), y = rng.uniform();
        directions_.push_back(normalize(normal + 0.5f * Vec3{x, y, rng.uniform()}));
      }
    }
    const test::Embedding embedding(on_cpu_, scene_.in_c(/*light=*/true));
    right_ = test::decode(embedding.handle, queries_.in_c());
    right_radiance_.resize(directions_.size());
    const lte_queries queries = queries_.in_c();
    const lte_float3_view ways = test::view(directions_);
    ASSERT_EQ(lte_embedding_decode_radiance(embedding.handle, &queries, &ways, kEach,
                                            &right_radiance_.data()->x, 0),
              LTE_OK)
        << lte_last_error();
  }
  ~CApiCuda() override {
    lte_model_release(on_cpu_);
    lte_model_release(on_gpu_);
  }

  /// A copy of host memory on the GPU, which lives as long as the test.
  template <typename T>
  const T* uploaded(const T* data, size_t count) {
    const auto bytes = static_cast<int64_t>(count * sizeof(T));
    kept_.push_back(at::from_blob(const_cast<T*>(data), {bytes}, at::kByte).to(at::kCUDA));
    return static_cast<const T*>(kept_.back().const_data_ptr());
  }
  lte_float3_view uploaded(const std::vector<Vec3>& triples) {
    return {&uploaded(triples.data(), triples.size())->x, 0};
  }
  const float* uploaded(const std::vector<float>& values) {
    return uploaded(values.data(), values.size());
  }
  lte_scene_points device_scene() {
    lte_scene_points out = scene_.in_c(/*light=*/true);
    out.position = uploaded(scene_.position);
    out.normal = uploaded(scene_.normal);
    out.albedo = uploaded(scene_.albedo);
    out.emission = uploaded(scene_.emission);
    out.area = uploaded(scene_.area);
    out.direct = uploaded(scene_.direct);
    out.indirect = uploaded(scene_.indirect);
    out.direct_back = uploaded(scene_.direct_back);
    out.indirect_back = uploaded(scene_.indirect_back);
    out.indirect_error = uploaded(scene_.indirect_error);
    out.gloss = uploaded(scene_.gloss);
    return out;
  }
  lte_queries device_queries() {
    lte_queries out = queries_.in_c();
    out.position = uploaded(queries_.position);
    out.normal = uploaded(queries_.normal);
    out.albedo = uploaded(queries_.albedo);
    return out;
  }

  /// What device memory encodes to, on `stream`.
  lte_embedding* encode(void* stream) {
    const lte_scene_points points = device_scene();
    lte_embedding* embedding = nullptr;
    EXPECT_EQ(lte_model_encode_cuda(on_gpu_, &points, stream, &embedding), LTE_OK)
        << lte_last_error();
    return embedding;
  }
  /// [kQueries, stride]: answers in the first three columns, −1 in the others.
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
  static test::Rgbs triples(const at::Tensor& rows) {
    const at::Tensor host = rows.cpu().contiguous();
    const auto* data = reinterpret_cast<const Rgb*>(host.const_data_ptr<float>());
    return {data, data + host.numel() / 3};
  }

  test::TempDir folder_;
  lte_model *on_cpu_ = nullptr, *on_gpu_ = nullptr;
  test::BoxScene scene_{kPoints, 1};
  test::BoxQueries queries_{kQueries, 2};
  std::vector<Vec3> directions_;
  test::Rgbs right_, right_radiance_;
  std::vector<at::Tensor> kept_;
};

TEST_F(CApiCuda, HostMemoryOfAModelOnTheGpu) {
  const test::Embedding embedding(on_gpu_, scene_.in_c(/*light=*/true));
  EXPECT_LT(test::relative_difference(test::decode(embedding.handle, queries_.in_c()), right_),
            1e-4);
}

TEST_F(CApiCuda, DeviceMemoryOnTheDefaultStreamAndOnOthers) {
  const c10::Stream first = cuda().getNewStream({c10::kCUDA, 0}, 0);
  const c10::Stream second = cuda().getNewStream({c10::kCUDA, 0}, 0);
  const lte_queries queries = device_queries();
  for (void* encodes_on : {static_cast<void*>(nullptr), first.native_handle()}) {
    lte_embedding* embedding = encode(encodes_on);
    ASSERT_NE(embedding, nullptr);
    for (void* decodes_on : {static_cast<void*>(nullptr), second.native_handle()}) {
      const at::Tensor got = decode(embedding, queries, decodes_on);
      EXPECT_LT(test::relative_difference(triples(got), right_), 1e-4);
    }
    // Host memory reads the same embedding.
    EXPECT_LT(test::relative_difference(test::decode(embedding, queries_.in_c()), right_), 1e-4);
    lte_embedding_release(embedding);
  }
}

TEST_F(CApiCuda, AMaskAndAStrideInDeviceMemory) {
  std::vector<uint8_t> mask(kQueries, 1);
  test::Rgbs right = right_;
  std::fill_n(mask.begin() + 10, 20, uint8_t{0});
  std::fill_n(right.begin() + 10, 20, Rgb{});
  lte_queries queries = device_queries();
  queries.mask = uploaded(mask.data(), mask.size());
  lte_embedding* embedding = encode(nullptr);
  ASSERT_NE(embedding, nullptr);
  const at::Tensor got = decode(embedding, queries, nullptr, 5);
  EXPECT_LT(test::relative_difference(triples(got.slice(1, 0, 3)), right), 1e-4);
  EXPECT_TRUE(got.slice(1, 3).eq(-1).all().item<bool>()) << "what lies between the answers";
  lte_embedding_release(embedding);
}

TEST_F(CApiCuda, RadianceInDeviceMemory) {
  lte_embedding* embedding = encode(nullptr);
  ASSERT_NE(embedding, nullptr);
  const lte_queries queries = device_queries();
  const lte_float3_view ways = uploaded(directions_);
  at::Tensor out =
      at::full({kQueries, kEach, 3}, -1.0f, at::TensorOptions(at::kFloat).device(at::kCUDA));
  ASSERT_EQ(lte_embedding_decode_radiance_cuda(embedding, &queries, &ways, kEach, nullptr,
                                               out.data_ptr<float>(), 0),
            LTE_OK)
      << lte_last_error();
  EXPECT_LT(test::relative_difference(triples(out), right_radiance_), 1e-4);
  lte_embedding_release(embedding);
}

TEST_F(CApiCuda, BadValuesInDeviceMemoryAreNamed) {
  queries_.normal[7].y = 3;
  lte_embedding* embedding = encode(nullptr);
  ASSERT_NE(embedding, nullptr);
  const lte_queries queries = device_queries();
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
    EXPECT_LT(test::relative_difference(test::decode(loaded, queries_.in_c()), right_), 1e-4);
    lte_embedding_release(loaded);
  }
}

}  // namespace
}  // namespace lte
