#include "lte/ops/neighbour_sums.h"

#include "lte/ops/dispatch.h"
#include "lte/tensor/library.h"

TORCH_LIBRARY_FRAGMENT(lte, m) {
  m.def(
      "neighbour_sums(Tensor keys, Tensor values, Tensor position, Tensor index) -> (Tensor, "
      "Tensor)");
  m.def(
      "neighbour_sums_backward(Tensor grad1, Tensor grad2, Tensor keys, Tensor values, Tensor "
      "position, Tensor index) -> (Tensor, Tensor, Tensor)");
  m.def("neighbour_table(Tensor keys, Tensor values) -> Tensor");
  m.def(
      "neighbour_sums_inference(Tensor table, Tensor hidden, Tensor weight, Tensor bias, Tensor "
      "index) -> (Tensor, Tensor)");
}

namespace lte::ops {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

class NeighbourSums : public torch::autograd::Function<NeighbourSums> {
 public:
  static variable_list forward(AutogradContext* context, const at::Tensor& keys,
                               const at::Tensor& values, const at::Tensor& position,
                               const at::Tensor& index) {
    const at::AutoDispatchBelowADInplaceOrView below;
    context->save_for_backward({keys, values, position, index});
    const auto [sum1, sum2] = neighbour_sums(keys, values, position, index);
    return {sum1, sum2};
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    using Signature = std::tuple<at::Tensor, at::Tensor, at::Tensor>(
        const at::Tensor&, const at::Tensor&, const at::Tensor&, const at::Tensor&,
        const at::Tensor&, const at::Tensor&);
    static const auto op = find_operator<Signature>("lte::neighbour_sums_backward");
    const variable_list saved = context->get_saved_variables();
    const auto [keys, values, position] =
        op.call(grads[0], grads[1], saved[0], saved[1], saved[2], saved[3]);
    return {keys, values, position, at::Tensor()};
  }
};

std::tuple<at::Tensor, at::Tensor> neighbour_sums_autograd(const at::Tensor& keys,
                                                           const at::Tensor& values,
                                                           const at::Tensor& position,
                                                           const at::Tensor& index) {
  const variable_list sums = NeighbourSums::apply(keys, values, position, index);
  return {sums[0], sums[1]};
}

}  // namespace

std::tuple<at::Tensor, at::Tensor> neighbour_sums(const at::Tensor& keys, const at::Tensor& values,
                                                  const at::Tensor& position,
                                                  const at::Tensor& index) {
  static const auto op = find_operator<decltype(neighbour_sums)>("lte::neighbour_sums");
  return op.call(keys, values, position, index);
}

at::Tensor neighbour_table(const at::Tensor& keys, const at::Tensor& values) {
  static const auto op = find_operator<decltype(neighbour_table)>("lte::neighbour_table");
  return op.call(keys, values);
}

std::tuple<at::Tensor, at::Tensor> neighbour_sums_inference(const at::Tensor& table,
                                                            const at::Tensor& hidden,
                                                            const at::Tensor& weight,
                                                            const at::Tensor& bias,
                                                            const at::Tensor& index) {
  static const auto op =
      find_operator<decltype(neighbour_sums_inference)>("lte::neighbour_sums_inference");
  return op.call(table, hidden, weight, bias, index);
}

}  // namespace lte::ops

TORCH_LIBRARY_IMPL(lte, Autograd, m) {
  m.impl("neighbour_sums", lte::ops::neighbour_sums_autograd);
}
