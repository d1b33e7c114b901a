// Operators by name, and modules, of builds without LibTorch.
#include "lte/tensor/library.h"

#include <atomic>
#include <stdexcept>

#include <gtest/gtest.h>

#include "lte/tensor/module.h"
#include "lte/tensor/tensor.h"

namespace lte {
namespace {

int64_t doubled(int64_t x) { return 2 * x; }

TORCH_LIBRARY_FRAGMENT(lte, m) { m.def("doubled(int x) -> int"); }
TORCH_LIBRARY_IMPL(lte, CPU, m) { m.impl("doubled", doubled); }

TEST(Operators, AreFoundByNameAndType) {
  const auto& op = c10::Dispatcher::singleton().findSchemaOrThrow("lte::doubled", "");
  EXPECT_EQ(op.typed<int64_t(int64_t)>().call(21), 42);
  EXPECT_THROW(op.typed<double(double)>(), c10::Error);
  EXPECT_THROW(c10::Dispatcher::singleton().findSchemaOrThrow("lte::tripled", ""), c10::Error);
}

class Pair : public torch::nn::Module {
 public:
  Pair()
      : first_(register_module("first", torch::nn::ModuleHolder<torch::nn::LinearImpl>(2, 3))),
        scale_(register_parameter("scale", at::ones({3}))) {}
  const at::Tensor& weight() const { return first_->weight; }

 private:
  torch::nn::ModuleHolder<torch::nn::LinearImpl> first_;
  at::Tensor scale_;
};

TEST(Modules, NameTheirParameters) {
  const Pair pair;
  const auto parameters = pair.named_parameters();
  std::vector<std::string> names;
  for (const auto& item : parameters) names.push_back(item.key());
  EXPECT_EQ(names, (std::vector<std::string>{"scale", "first.weight", "first.bias"}));
  parameters["first.weight"].fill_(3);
  EXPECT_EQ(pair.weight()[2][1].item<float>(), 3) << "a parameter is shared, not copied";
  EXPECT_THROW(parameters["second.weight"], c10::Error);
  EXPECT_EQ(pair.modules(false).size(), 1u);
}

TEST(Threads, CoverARangeOnceAndHandOnErrors) {
  std::vector<std::atomic<int>> visits(1000);
  at::parallel_for(0, 1000, 7, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) ++visits[static_cast<size_t>(i)];
  });
  for (const auto& count : visits) ASSERT_EQ(count, 1);
  EXPECT_THROW(at::parallel_for(0, 100, 1,
                                [](int64_t begin, int64_t) {
                                  if (begin == 0) throw std::runtime_error("no");
                                }),
               std::runtime_error);
}

}  // namespace
}  // namespace lte
