// The tensors and modules behind a network and its embedding, for what is LibTorch's itself: this
// folder, lte/torchscript, training, experiments and benchmarks of single stages. Everything else
// goes through network.h and embedding.h.
#pragma once

#include "lte/nn/points/point_set.h"
#include "lte/runtime/device.h"
#include "lte/runtime/embedding.h"
#include "lte/tensor/tensor.h"

namespace lte::nn {
class LightTransportModel;
struct DecodeOptions;
struct Embedding;
struct EncoderAttention;
}  // namespace lte::nn

namespace lte::runtime {

c10::Device torch_device(Device device);
Device device_of(c10::Device device);

/// Tensors on the CPU that borrow the arrays: do not write to them, and keep the arrays alive.
/// @throws lte::Error if the arrays differ in length, or there are no scene points.
nn::PointSet borrow(const ScenePoints& points);
nn::QuerySet borrow(const QueryPoints& queries);

/// What network.h and embedding.h keep to themselves. Tensors may be on any device; errors are
/// c10::Error.
struct TorchParts {
  /// In evaluation mode.
  static nn::LightTransportModel& model(const Network& network);

  /// SceneEmbedding's constructor, from tensors.
  static SceneEmbedding encode(const Network& network, const nn::PointSet& points,
                               const EncodeOptions& options = {});
  /// [Q, 3] on the network's device. On a GPU the kernels are put on this thread's stream, which
  /// waits for those of the encoder by itself.
  static at::Tensor decode(const SceneEmbedding& embedding, const nn::QuerySet& queries,
                           const nn::DecodeOptions& options);
  /// [Q, N, 3] of directions [Q, N, 3].
  static at::Tensor decode_radiance(const SceneEmbedding& embedding, const nn::QuerySet& queries,
                                    const at::Tensor& directions, const nn::DecodeOptions& options);

  /// At gain 1, ready on the current stream.
  static nn::Embedding embedding(const SceneEmbedding& embedding);
  /// From the parts of an embedding that this network has made, on the network's device.
  static SceneEmbedding from(const Network& network, const nn::Embedding& parts,
                             int64_t scene_points, const MemoryLimit& memory);
  /// What EncodeOptions::record_attention keeps; null without it, and for an embedding from a file.
  static const nn::EncoderAttention* attention(const SceneEmbedding& embedding);
};

}  // namespace lte::runtime
