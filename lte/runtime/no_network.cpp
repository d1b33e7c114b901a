// The door of builds without LibTorch: every way to a network ends here, in the same line.
#include <exception>

#include "lte/base/parallel.h"
#include "lte/runtime/attention.h"
#include "lte/runtime/device.h"
#include "lte/runtime/device_memory.h"
#include "lte/runtime/embedding.h"
#include "lte/runtime/embedding_file.h"
#include "lte/runtime/network.h"
#include "lte/runtime/points.h"

namespace lte::runtime {

void require_networks() {
  throw Error(
      "this build of lte has no network, as it was made without LibTorch: light that is gathered "
      "or path-traced needs none, and a build with LTE_TORCH=ON has one");
}

namespace {

/// For functions that answer: no value is ever made.
template <typename T>
T none() {
  require_networks();
  std::terminate();
}

}  // namespace

// No object of these classes exists, as none can be constructed.
struct Network::State {};
struct SceneEmbedding::State {};
struct SceneAttention::Parts {};
struct StreamScope::Guard {};

Network::Network(const std::filesystem::path&, const NetworkOptions&) { require_networks(); }
const ModelConfig& Network::config() const { return none<const ModelConfig&>(); }
const ModelMetadata& Network::metadata() const { return none<const ModelMetadata&>(); }
Device Network::device() const { return none<Device>(); }
Precision Network::precision() const { return none<Precision>(); }
std::string Network::fingerprint() const { return none<std::string>(); }
int64_t Network::parameters() const { return none<int64_t>(); }
LightRequest Network::light_request() const { return none<LightRequest>(); }
void Network::check_fits(double, bool) const { require_networks(); }

SceneEmbedding::SceneEmbedding(const Network&, const ScenePoints&, const EncodeOptions&) {
  require_networks();
}
SceneEmbedding::SceneEmbedding(SceneEmbedding&&) noexcept = default;
SceneEmbedding& SceneEmbedding::operator=(SceneEmbedding&&) noexcept = default;
SceneEmbedding::~SceneEmbedding() = default;
const Network& SceneEmbedding::network() const { return none<const Network&>(); }
EmbeddingInfo SceneEmbedding::info() const { return none<EmbeddingInfo>(); }
double SceneEmbedding::mean_emission() const { return none<double>(); }
void SceneEmbedding::set_emission_gain(const std::array<double, 3>&) { require_networks(); }
std::vector<Rgb> SceneEmbedding::decode(const QueryPoints&) const {
  return none<std::vector<Rgb>>();
}
std::vector<Rgb> SceneEmbedding::light_prior(const QueryPoints&) const {
  return none<std::vector<Rgb>>();
}
std::vector<Rgb> SceneEmbedding::decode_radiance(const QueryPoints&, std::span<const Vec3>) const {
  return none<std::vector<Rgb>>();
}

void save_embedding(const std::filesystem::path&, const SceneEmbedding&, const EmbeddingKey&) {
  require_networks();
}
SceneEmbedding load_embedding(const std::filesystem::path&, const Network&, const EmbeddingKey&,
                              const MemoryLimit&) {
  return none<SceneEmbedding>();
}

SceneAttention::SceneAttention(std::shared_ptr<const SceneEmbedding>) { require_networks(); }
SceneAttention::SceneAttention(SceneAttention&&) noexcept = default;
SceneAttention& SceneAttention::operator=(SceneAttention&&) noexcept = default;
SceneAttention::~SceneAttention() = default;
std::span<const Vec3> SceneAttention::positions() const { return none<std::span<const Vec3>>(); }
std::span<const Vec3> SceneAttention::normals() const { return none<std::span<const Vec3>>(); }
int64_t SceneAttention::latent_at(const Vec3&, const Vec3&) const { return none<int64_t>(); }
const std::vector<AttentionBlock>& SceneAttention::blocks() const {
  return none<const std::vector<AttentionBlock>&>();
}
size_t SceneAttention::decoder_layers() const { return none<size_t>(); }
double SceneAttention::entropy(size_t) const { return none<double>(); }
LatentsRead SceneAttention::read(const Vec3&, const Vec3&, const Rgb&) const {
  return none<LatentsRead>();
}
std::vector<float> SceneAttention::attention(size_t, int64_t, int64_t) const {
  return none<std::vector<float>>();
}
std::vector<float> SceneAttention::interpolate(std::span<const float>, std::span<const Vec3>,
                                               std::span<const Vec3>) const {
  return none<std::vector<float>>();
}

SceneEmbedding encode(const Network&, const ScenePointsIn&, const EncodeOptions&) {
  return none<SceneEmbedding>();
}
void decode(const SceneEmbedding&, const QueriesIn&, const TriplesOut&) { require_networks(); }
void decode_radiance(const SceneEmbedding&, const QueriesIn&, const TriplesIn&, int64_t,
                     const TriplesOut&) {
  require_networks();
}
StreamScope::StreamScope(Device, void*) {}
StreamScope::~StreamScope() = default;

double mean_emission(const ScenePoints&) { return none<double>(); }

Device cuda_device(int) { return none<Device>(); }
Device choose_device(const std::string&, const std::string&) { return none<Device>(); }
void warn_of_slow_bf16(const std::string&, Device) { require_networks(); }
// LibTorch's own pool is not there.
void set_torch_threads(int) {}
int torch_threads() { return num_threads(); }

}  // namespace lte::runtime
