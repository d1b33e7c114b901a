// What the handles of lte/c_api.h stand for, and the threads of a call.
#pragma once

#include <cstdint>

#include "lte/c_api.h"
#include "lte/runtime/embedding.h"

struct lte_model {
  lte::runtime::Network network;
};

struct lte_embedding {
  lte::runtime::SceneEmbedding scene;
};

namespace lte::c_api {

/// Sets the threads of every later call.
void set_threads(int32_t threads);

/// Every function that computes begins with it: LibTorch keeps the number by thread, so each thread
/// takes it over when it calls.
void apply_threads();

}  // namespace lte::c_api
