#include "lte/runtime/embedding.h"

#include <cmath>
#include <cstring>
#include <mutex>
#include <utility>

#include "lte/base/check.h"
#include "lte/nn/encoder/attention_record.h"
#include "lte/nn/model.h"
#include "lte/runtime/solved_light.h"
#include "lte/runtime/tensors.h"
#include "lte/runtime/torch_errors.h"
#include "lte/runtime/torch_parts.h"
#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"

namespace lte::runtime {
namespace {

/// Keeps the shrunk extent under the network's unit after rounding.
constexpr double kShrinkMargin = 1e-5;

/// The stream that operators of this thread run on.
c10::Stream current_stream(c10::Device device) {
  return c10::impl::VirtualGuardImpl(device.type()).getStream(device);
}

/// Where the network sees the scene. Positions that are not finite are left to encode(), which
/// names the row.
nn::Frame frame_of(const Network& network, const at::Tensor& position,
                   const EncodeOptions& options) {
  nn::Frame frame;
  if (options.origin) {
    const Vec3& o = *options.origin;
    frame.origin = at::tensor({o.x, o.y, o.z}, at::kFloat).to(position.device());
  }
  const at::Tensor low = frame.origin.defined() ? frame.origin : std::get<0>(position.min(0));
  const at::Tensor high = std::get<0>(position.max(0));
  const double extent = (high.to(at::kDouble) - low.to(at::kDouble)).max().item<double>();
  if (!std::isfinite(extent)) return frame;
  network.check_fits(extent, options.rescale);
  if (extent > network.config().scale) {
    frame.scale = extent * (1 + kShrinkMargin);
  } else if (options.rescale && extent > 0 && extent < network.least_extent()) {
    frame.scale = network.config().scale * (extent / network.least_extent());
  }
  return frame;
}

/// Those on the network's device; some may be undefined.
std::vector<at::Tensor> tensors_of(const nn::Embedding& embedding) {
  std::vector<at::Tensor> tensors = embedding.prior.tensors();
  tensors.insert(tensors.end(), {embedding.position, embedding.normal, embedding.features,
                                 embedding.origin, embedding.table, embedding.radiance_table});
  for (const at::Tensor& t : embedding.surfels.tensors()) tensors.push_back(t);
  return tensors;
}

/// The rows of [..., 3] on whatever device.
std::vector<Rgb> triples_of(const at::Tensor& values) {
  const at::Tensor host = values.to(at::kCPU, at::kFloat).contiguous();
  std::vector<Rgb> out(static_cast<size_t>(host.numel() / 3));
  std::memcpy(static_cast<void*>(out.data()), host.const_data_ptr<float>(), host.nbytes());
  return out;
}

MemoryNeed encoding_need(const Network& network, int64_t scene_points) {
  return {concat("encoding ", scene_points, " scene points"),
          encode_mb(network.config(), scene_points),
          "take fewer scene points",
          {Hint::FewerScenePoints}};
}

MemoryNeed decoding_need(const Network& network, int64_t queries, int64_t block) {
  return {concat("decoding ", queries, " queries"),
          decode_mb(network.config(), queries, block),
          "ask for fewer at once, or limit memory so that fewer are decoded at a time",
          {Hint::FewerQueries, Hint::MemoryLimit}};
}

EmbeddingInfo info_of(const nn::Embedding& embedding, int64_t scene_points) {
  EmbeddingInfo info;
  info.scene_points = scene_points;
  info.latents = embedding.position.size(0);
  for (const at::Tensor& t : tensors_of(embedding)) {
    if (t.defined()) info.bytes += static_cast<int64_t>(t.nbytes());
  }
  const at::Tensor origin = embedding.origin.to(at::kCPU, at::kDouble);
  for (size_t i = 0; i < 3; ++i) {
    info.origin[i] = origin[static_cast<int64_t>(i)].item<double>();
    info.emission[i] = embedding.emission_scale[static_cast<int64_t>(i)].item<double>();
  }
  info.scale = embedding.scale;
  return info;
}

/// Names rows as the caller has them, before they are put in order.
void check_rows(const nn::PointSet& points, const nn::ModelConfig& config) {
  if (solves_light_of(points, config))
    nn::check_surfaces(points);
  else
    nn::check_points(points, config);
}

/// The triples that `decode` answers, which takes as many queries at a time as memory allows.
template <typename Decode>
std::vector<Rgb> decode_on_host(const Network& network, const MemoryLimit& memory, int64_t queries,
                                const Decode& decode) {
  const int64_t block = memory.query_block(network.config(), queries, kQueryBlock);
  return explain_out_of_memory(decoding_need(network, queries, block), [&] {
    return own_errors([&] { return triples_of(decode(nn::DecodeOptions{true, block})); });
  });
}

}  // namespace

struct SceneEmbedding::State {
  State(const Network& net, const MemoryLimit& limit) : network(net), memory(limit) {}

  /// On a GPU: notes that what has been put on this stream makes the embedding.
  void mark_ready() {
    if (network.device().is_cpu()) return;
    const c10::Device device = torch_device(network.device());
    ready.emplace(device.type());
    ready->record(current_stream(device));
  }

  /// At gain 1, ready on the current stream.
  nn::Embedding parts() const {
    if (!ready) return embedding;
    const c10::Stream stream = current_stream(torch_device(network.device()));
    ready->block(stream);
    // The allocator must not give this memory to another stream while this one reads it.
    for (const at::Tensor& t : tensors_of(embedding)) {
      if (t.defined()) t.record_stream(stream);
    }
    return embedding;
  }

  /// The same under the gain of this moment.
  nn::Embedding snapshot() const {
    nn::Embedding now = parts();
    const std::lock_guard lock(mutex);
    const auto& [r, g, b] = gain;
    now.emission_scale = now.emission_scale * at::tensor({r, g, b}, at::kDouble);
    return now;
  }

  Network network;
  MemoryLimit memory;
  int64_t scene_points = 0;
  nn::Embedding embedding;                          ///< at gain 1
  std::unique_ptr<nn::EncoderAttention> attention;  ///< if it is recorded
  std::optional<c10::Event> ready;  ///< on a GPU: when the kernels that make it are through
  mutable std::mutex mutex;         ///< for gain
  std::array<double, 3> gain = {1, 1, 1};
};

SceneEmbedding::SceneEmbedding(std::unique_ptr<State> state) : state_(std::move(state)) {}
SceneEmbedding::SceneEmbedding(SceneEmbedding&&) noexcept = default;
SceneEmbedding& SceneEmbedding::operator=(SceneEmbedding&&) noexcept = default;
SceneEmbedding::~SceneEmbedding() = default;

SceneEmbedding::SceneEmbedding(const Network& network, const ScenePoints& points,
                               const EncodeOptions& options)
    : SceneEmbedding(explain_out_of_memory(encoding_need(network, points.size()), [&] {
        return own_errors([&] { return TorchParts::encode(network, borrow(points), options); });
      })) {}

SceneEmbedding TorchParts::encode(const Network& network, const nn::PointSet& points,
                                  const EncodeOptions& options) {
  const at::NoGradGuard no_grad;
  const c10::Device device = torch_device(network.device());
  const c10::DeviceGuard guard(device);
  check_rows(points, network.config());
  const nn::PointSet set =
      with_solved_light(nn::in_canonical_order(points).to(device), network.config());
  const nn::Frame frame = frame_of(network, set.position, options);
  auto state = std::make_unique<SceneEmbedding::State>(network, options.memory);
  state->scene_points = set.position.size(0);
  state->memory.check_encoding(network.config(), state->scene_points);
  if (options.record_attention) state->attention = std::make_unique<nn::EncoderAttention>();
  state->embedding = model(network)->encode(set, 0, frame, state->attention.get());
  state->mark_ready();
  return SceneEmbedding(std::move(state));
}

SceneEmbedding TorchParts::from(const Network& network, const nn::Embedding& parts,
                                int64_t scene_points, const MemoryLimit& memory) {
  auto state = std::make_unique<SceneEmbedding::State>(network, memory);
  state->scene_points = scene_points;
  state->embedding = parts;
  state->mark_ready();
  return SceneEmbedding(std::move(state));
}

const Network& SceneEmbedding::network() const { return state_->network; }

EmbeddingInfo SceneEmbedding::info() const {
  return own_errors([&] { return info_of(state_->snapshot(), state_->scene_points); });
}

double SceneEmbedding::mean_emission() const {
  const double mean = state_->snapshot().emission_scale.mean().item<double>();
  return mean > 0 ? mean : 1;
}

void SceneEmbedding::set_emission_gain(const std::array<double, 3>& gain) {
  const std::lock_guard lock(state_->mutex);
  state_->gain = gain;
}

nn::Embedding TorchParts::embedding(const SceneEmbedding& embedding) {
  return embedding.state_->parts();
}

const nn::EncoderAttention* TorchParts::attention(const SceneEmbedding& embedding) {
  return embedding.state_->attention.get();
}

at::Tensor TorchParts::decode(const SceneEmbedding& embedding, const nn::QuerySet& queries,
                              const nn::DecodeOptions& options) {
  const at::NoGradGuard no_grad;
  // For few queries the way to an operator takes as long as the operator.
  const at::AutoDispatchBelowADInplaceOrView straight;
  const c10::Device device = torch_device(embedding.network().device());
  const c10::DeviceGuard guard(device);
  return model(embedding.network())
      ->decode(embedding.state_->snapshot(), queries.to(device), options);
}

at::Tensor TorchParts::decode_radiance(const SceneEmbedding& embedding, const nn::QuerySet& queries,
                                       const at::Tensor& directions,
                                       const nn::DecodeOptions& options) {
  const at::NoGradGuard no_grad;
  const c10::Device device = torch_device(embedding.network().device());
  const c10::DeviceGuard guard(device);
  return model(embedding.network())
      ->decode_radiance(embedding.state_->snapshot(), queries.to(device), directions.to(device),
                        options);
}

std::vector<Rgb> SceneEmbedding::decode_radiance(const QueryPoints& queries,
                                                 std::span<const Vec3> directions) const {
  const nn::QuerySet set = borrow(queries);
  const int64_t Q = queries.size(), all = static_cast<int64_t>(directions.size());
  if (Q == 0 && all == 0) return {};
  LTE_CHECK(Q > 0 && all > 0 && all % Q == 0, "radiance: ", all, " directions of ", Q,
            " queries, expected as many of each");
  const at::Tensor ways = borrow(directions).view({Q, all / Q, 3});
  return decode_on_host(network(), state_->memory, Q, [&](const nn::DecodeOptions& options) {
    return TorchParts::decode_radiance(*this, set, ways, options);
  });
}

std::vector<Rgb> SceneEmbedding::decode(const QueryPoints& queries) const {
  const nn::QuerySet set = borrow(queries);
  if (queries.size() == 0) return {};
  return decode_on_host(
      network(), state_->memory, queries.size(),
      [&](const nn::DecodeOptions& options) { return TorchParts::decode(*this, set, options); });
}

std::vector<Rgb> SceneEmbedding::light_prior(const QueryPoints& queries) const {
  return own_errors([&]() -> std::vector<Rgb> {
    const at::NoGradGuard no_grad;
    const nn::Embedding parts = state_->parts();
    if (!parts.prior.defined() || queries.size() == 0) return {};
    const nn::QuerySet set = borrow(queries).to(parts.position.device());
    const at::Tensor position = (set.position - parts.origin).div(parts.scale);
    return triples_of(parts.prior.read(position, set.normal).irradiance *
                      parts.emission_scale.to(position.options()));
  });
}

}  // namespace lte::runtime
