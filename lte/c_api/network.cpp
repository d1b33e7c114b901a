#include "lte/c_api/network.h"

#include <cmath>
#include <limits>
#include <vector>

#include <ATen/ATen.h>
#include <c10/core/impl/VirtualGuardImpl.h>

#include "lte/c_api/arguments.h"
#include "lte/nn/device.h"
#include "lte/nn/model_file.h"

namespace lte::c_api {
namespace {

/// Keeps the shrunk extent under the network's unit after rounding.
constexpr double kShrinkMargin = 1e-5;

at::Device device_of(int32_t number) {
  if (number == LTE_DEVICE_CPU) return at::kCPU;
  require(number >= 0, "device is ", number, ", expected LTE_DEVICE_CPU or a CUDA device's number");
  const std::string obstacle = nn::cuda_obstacle();
  if (!obstacle.empty())
    throw ApiError(LTE_ERROR_NO_CUDA, concat("device ", number, ": ", obstacle));
  const int32_t count = c10::impl::VirtualGuardImpl(at::kCUDA).deviceCount();
  if (number >= count) {
    throw ApiError(LTE_ERROR_NO_CUDA, concat("device ", number, ": there are only ", count));
  }
  return {at::kCUDA, static_cast<c10::DeviceIndex>(number)};
}

/// The stream that operators of this thread run on.
c10::Stream current_stream(at::Device device) {
  return c10::impl::VirtualGuardImpl(device.type()).getStream(device);
}

nn::PointSet borrow_points(const lte_scene_points& p, at::Device memory) {
  const int64_t M = p.count;
  require(M >= 1, "scene points: count is ", M, ", expected at least 1");
  require(M < std::numeric_limits<int32_t>::max(), "scene points: count is ", M,
          ", more than 2^31 - 2");
  nn::PointSet points;
  points.position = borrow_triples(p.position, M, memory, "scene points: position");
  points.normal = borrow_triples(p.normal, M, memory, "scene points: normal");
  points.albedo = borrow_triples(p.albedo, M, memory, "scene points: albedo");
  points.emission = borrow_triples(p.emission, M, memory, "scene points: emission");
  if (p.direct.data != nullptr) {
    points.direct = borrow_triples(p.direct, M, memory, "scene points: direct");
  }
  if (p.indirect.data != nullptr) {
    points.indirect = borrow_triples(p.indirect, M, memory, "scene points: indirect");
  }
  points.area = p.area == nullptr ? at::ones({M}, points.position.options())
                                  : borrow_floats(p.area, M, memory, "scene points: area");
  return points;
}

/// Where the network sees the scene. Positions that are not finite are left to encode(), which
/// names the row.
nn::Frame frame_of(const lte_scene_points& p, const at::Tensor& position, double s) {
  nn::Frame frame;
  if (p.origin != nullptr) {
    check_finite_triple(p.origin, "scene points: origin");
    frame.origin =
        at::tensor({p.origin[0], p.origin[1], p.origin[2]}, at::kFloat).to(position.device());
  }
  const at::Tensor low = frame.origin.defined() ? frame.origin : std::get<0>(position.min(0));
  const at::Tensor high = std::get<0>(position.max(0));
  const double extent = (high.to(at::kDouble) - low.to(at::kDouble)).max().item<double>();
  if (!std::isfinite(extent) || extent <= s) return frame;
  if (p.rescale == 0) {
    throw ApiError(
        LTE_ERROR_SCENE_TOO_LARGE,
        concat("scene points: the scene spans ", extent, " m, the model knows scenes up to ", s,
               " m: set rescale to shrink it for the network"));
  }
  frame.scale = extent * (1 + kShrinkMargin);
  return frame;
}

/// Those on the model's device; some may be undefined.
std::vector<at::Tensor> tensors_of(const nn::Embedding& embedding) {
  std::vector<at::Tensor> tensors = embedding.cache.tensors();
  tensors.insert(tensors.end(),
                 {embedding.position, embedding.features, embedding.origin, embedding.table});
  return tensors;
}

nn::QuerySet rows_of(const nn::QuerySet& queries, const at::Tensor& rows) {
  return {queries.position.index_select(0, rows), queries.normal.index_select(0, rows),
          queries.albedo.index_select(0, rows)};
}

/// Zeros where `mask` is false, so that what is there is not looked at.
nn::QuerySet masked(const nn::QuerySet& queries, const at::Tensor& mask) {
  const at::Tensor keep = mask.unsqueeze(1);
  return {at::where(keep, queries.position, 0), at::where(keep, queries.normal, 0),
          at::where(keep, queries.albedo, 0)};
}

}  // namespace

std::shared_ptr<Network> open_network(const std::string& path, int32_t number) {
  const at::Device device = device_of(number);
  auto network = std::make_shared<Network>(
      Network{nn::load_model(path), nn::read_model_metadata(path), device});
  network->model->to(device);
  network->model->eval();
  return network;
}

SceneEmbedding::SceneEmbedding(std::shared_ptr<Network> network, const lte_scene_points& points,
                               at::Device memory)
    : network_(std::move(network)), scene_points_(points.count) {
  const at::NoGradGuard no_grad;
  const at::Device device = network_->device;
  nn::PointSet set = borrow_points(points, memory);
  for (at::Tensor* t : {&set.position, &set.normal, &set.albedo, &set.emission, &set.area,
                        &set.direct, &set.indirect}) {
    if (t->defined()) *t = t->to(device);
  }
  const nn::Frame frame = frame_of(points, set.position, network_->model->config().scale);
  embedding_ = network_->model->encode(set, 0, frame);
  if (device.is_cpu()) return;
  ready_.emplace(device.type());
  ready_->record(current_stream(device));
}

lte_embedding_info SceneEmbedding::info() const {
  const nn::Embedding embedding = snapshot();
  lte_embedding_info info = {};
  info.scene_points = scene_points_;
  info.latents = embedding.position.size(0);
  for (const at::Tensor& t : tensors_of(embedding)) {
    if (t.defined()) info.bytes += static_cast<int64_t>(t.nbytes());
  }
  const at::Tensor origin = embedding.origin.to(at::kCPU, at::kDouble);
  for (int64_t i = 0; i < 3; ++i) {
    info.origin[i] = origin[i].item<double>();
    info.radiance[i] = embedding.emission_scale[i].item<double>();
  }
  info.scale = embedding.scale;
  return info;
}

void SceneEmbedding::set_gain(const float* rgb) {
  check_finite_triple(rgb, "emission gain");
  for (int i = 0; i < 3; ++i) require(rgb[i] >= 0, "emission gain[", i, "] is negative: ", rgb[i]);
  const std::lock_guard lock(mutex_);
  for (int i = 0; i < 3; ++i) gain_[i] = rgb[i];
}

nn::Embedding SceneEmbedding::snapshot() const {
  nn::Embedding embedding = embedding_;
  {
    const std::lock_guard lock(mutex_);
    embedding.emission_scale =
        embedding.emission_scale * at::tensor({gain_[0], gain_[1], gain_[2]}, at::kDouble);
  }
  if (!ready_) return embedding;
  const c10::Stream stream = current_stream(network_->device);
  ready_->block(stream);
  // The allocator must not give this memory to another stream while this one reads it.
  for (const at::Tensor& t : tensors_of(embedding)) {
    if (t.defined()) t.record_stream(stream);
  }
  return embedding;
}

void SceneEmbedding::decode(const lte_queries& q, at::Device memory, float* irradiance,
                            int64_t stride) const {
  require(q.count >= 0, "queries: count is ", q.count, ", expected 0 or more");
  require((q.flags & ~LTE_QUERIES_TRUSTED) == 0, "queries: unknown flags ", q.flags);
  if (q.count == 0) return;
  const at::NoGradGuard no_grad;
  const at::Device device = network_->device;
  const at::Tensor out = borrow_output(irradiance, stride, q.count, memory, "irradiance");
  nn::QuerySet set;
  set.position = borrow_triples(q.position, q.count, memory, "queries: position").to(device);
  set.normal = borrow_triples(q.normal, q.count, memory, "queries: normal").to(device);
  set.albedo = borrow_triples(q.albedo, q.count, memory, "queries: albedo").to(device);
  const bool check = (q.flags & LTE_QUERIES_TRUSTED) == 0;
  if (q.mask == nullptr) {
    out.copy_(network_->model->decode(snapshot(), set, {check}));
    return;
  }
  const at::Tensor mask = read_mask(q.mask, q.mask_stride, q.count, memory).to(device);
  if (check) nn::check_queries(masked(set, mask));
  const at::Tensor rows = mask.nonzero().view({-1});
  const at::Tensor answer = network_->model->decode(snapshot(), rows_of(set, rows), {false});
  out.zero_();
  out.index_copy_(0, rows.to(memory), answer.to(memory));
}

}  // namespace lte::c_api
