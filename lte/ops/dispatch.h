// Calls of registered operators.
#pragma once

#include "lte/tensor/library.h"

namespace lte::ops {

/// The registered operator `name`, "lte::knn" for instance, as a function of type `Signature`.
/// Finding it takes a look-up under a lock, so callers keep the result in a static variable.
///
/// @throws c10::Error if there is no such operator, or its schema is not that of `Signature`
template <typename Signature>
c10::TypedOperatorHandle<Signature> find_operator(const char* name) {
  return c10::Dispatcher::singleton().findSchemaOrThrow(name, "").typed<Signature>();
}

}  // namespace lte::ops
