#include "lte/tensor/own/library.h"

namespace lte::tensor {

Dispatcher& Dispatcher::singleton() {
  static Dispatcher all;
  return all;
}

const Operator& Dispatcher::findSchemaOrThrow(const char* name, const char* /*overload*/) const {
  const auto found = operators_.find(name);
  TORCH_CHECK(found != operators_.end(), "there is no operator ", name);
  return found->second;
}

}  // namespace lte::tensor
