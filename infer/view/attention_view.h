// A network's attention, for pages: for a point that was clicked, numbers at the
// latents that the camera sees.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "infer/session/session.h"
#include "infer/view/messages.h"
#include "lte/runtime/attention.h"

namespace lte::infer::view {

/// Used by one thread.
class AttentionView {
 public:
  /// An answer for the page that asked. The first question about a state encodes it once more, with
  /// a record, which is kept until another state is asked about.
  /// @param camera  latents that it does not see are left out
  /// @throws lte::Error in one line for a scene without a network's answers, a point far from any
  ///         surface, a block or head that there is not
  std::string answer(const SessionState& state, const scene::Camera& camera,
                     const LookInside& question);

 private:
  void record(const SessionState& state);

  uint64_t version_ = 0;  ///< of the state that is recorded; 0: none
  std::optional<runtime::SceneAttention> inside_;
  std::vector<double> entropies_;  ///< by block
};

}  // namespace lte::infer::view
