#include "lte/ops/decoder_weights.h"

#include "lte/tensor/tensor.h"

namespace lte::ops {
namespace {

// The order of the list is written here alone: to_list(), from_list() and the count of tensors all
// visit the same way. `Weights` are const or not.

template <typename Visit>
void visit_pair(Visit& visit, auto& weight, auto& bias) {
  visit(weight);
  visit(bias);
}

template <typename Perceptron, typename Visit>
void visit_perceptron(Perceptron& w, Visit& visit) {
  visit_pair(visit, w.hidden.weight, w.hidden.bias);
  visit_pair(visit, w.output.weight, w.output.bias);
}

template <typename Layer, typename Visit>
void visit_layer(Layer& w, Visit& visit) {
  visit_pair(visit, w.norm1.gain, w.norm1.bias);
  visit_pair(visit, w.query.weight, w.query.bias);
  visit_pair(visit, w.output.weight, w.output.bias);
  visit_pair(visit, w.norm2.gain, w.norm2.bias);
  visit_perceptron(w.ffn, visit);
}

template <typename Weights, typename Visit>
void visit_tensors(Weights& w, Visit visit) {
  visit_perceptron(w.point, visit);
  visit_perceptron(w.gamma, visit);
  for (auto& layer : w.layers) visit_layer(layer, visit);
  visit_pair(visit, w.norm.gain, w.norm.bias);
  visit_perceptron(w.head, visit);
}

}  // namespace

std::vector<at::Tensor> DecoderWeights::to_list() const {
  std::vector<at::Tensor> list;
  visit_tensors(*this, [&](const at::Tensor& t) { list.push_back(t); });
  return list;
}

std::vector<at::Tensor> DecoderWeights::list_as_read() const {
  DecoderWeights read = *this;
  std::vector<LinearWeights*> dense;
  const auto add = [&dense](PerceptronWeights& w) {
    dense.insert(dense.end(), {&w.hidden, &w.output});
  };
  for (PerceptronWeights* w : {&read.point, &read.gamma, &read.head}) add(*w);
  for (LayerWeights& layer : read.layers) {
    dense.insert(dense.end(), {&layer.query, &layer.output});
    add(layer.ffn);
  }
  for (LinearWeights* w : dense) w->weight = w->as_read();
  return read.to_list();
}

DecoderWeights DecoderWeights::from_list(at::TensorList list, int64_t layers) {
  DecoderWeights out;
  out.layers.resize(static_cast<size_t>(layers));
  size_t expected = 0;
  visit_tensors(out, [&](const at::Tensor&) { ++expected; });
  TORCH_CHECK(list.size() == expected, "query_decoder_inference: ", layers, " layers have ",
              expected, " weights, got ", list.size());
  size_t next = 0;
  visit_tensors(out, [&](at::Tensor& t) { t = list[next++]; });
  return out;
}

}  // namespace lte::ops
