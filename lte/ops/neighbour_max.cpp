#include "lte/ops/neighbour_max.h"

#include "lte/ops/dispatch.h"
#include "lte/tensor/library.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def(
      "neighbour_max_inference(Tensor dense, Tensor center, Tensor neighbour, Tensor weight, "
      "Tensor bias) -> Tensor");
  // The maxima, and which of the k pairs each is, int32.
  m.def(
      "neighbour_max(Tensor dense, Tensor center, Tensor neighbour, Tensor weight, Tensor bias) -> "
      "(Tensor, Tensor)");
  // Gradients by dense, center, weight and bias.
  m.def(
      "neighbour_max_backward(Tensor grad, Tensor dense, Tensor center, Tensor neighbour, Tensor "
      "weight, Tensor winner) -> (Tensor, Tensor, Tensor, Tensor)");
}

namespace lte::ops {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

class NeighbourMax : public torch::autograd::Function<NeighbourMax> {
 public:
  static at::Tensor forward(AutogradContext* context, const at::Tensor& dense,
                            const at::Tensor& center, const at::Tensor& neighbour,
                            const at::Tensor& /*weight*/, const at::Tensor& bias,
                            const at::Tensor& read) {
    using Signature =
        std::tuple<at::Tensor, at::Tensor>(const at::Tensor&, const at::Tensor&, const at::Tensor&,
                                           const at::Tensor&, const at::Tensor&);
    static const auto op = find_operator<Signature>("lte::neighbour_max");
    const at::AutoDispatchBelowADInplaceOrView below;
    const auto [out, winner] = op.call(dense, center, neighbour, read, bias);
    context->save_for_backward({dense, center, neighbour, read, winner});
    return out;
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    using Signature = std::tuple<at::Tensor, at::Tensor, at::Tensor, at::Tensor>(
        const at::Tensor&, const at::Tensor&, const at::Tensor&, const at::Tensor&,
        const at::Tensor&, const at::Tensor&);
    static const auto op = find_operator<Signature>("lte::neighbour_max_backward");
    const variable_list saved = context->get_saved_variables();
    const auto [dense, center, weight, bias] =
        op.call(grads[0], saved[0], saved[1], saved[2], saved[3], saved[4]);
    return {dense, center, at::Tensor(), weight, bias, at::Tensor()};
  }
};

}  // namespace

at::Tensor neighbour_max(const at::Tensor& dense, const at::Tensor& center,
                         const at::Tensor& neighbour, const LinearWeights& layer) {
  return NeighbourMax::apply(dense, center, neighbour, layer.weight, layer.bias, layer.as_read());
}

at::Tensor neighbour_max_inference(const at::Tensor& dense, const at::Tensor& center,
                                   const at::Tensor& neighbour, const at::Tensor& weight,
                                   const at::Tensor& bias) {
  static const auto op =
      find_operator<decltype(neighbour_max_inference)>("lte::neighbour_max_inference");
  return op.call(dense, center, neighbour, weight, bias);
}

}  // namespace lte::ops
