#include "lte/scene/import/limit_error.h"

namespace lte::scene {

void rethrow_at(const std::string& place, const Error& error) {
  const std::string message = concat(place, ": ", error.what());
  if (const auto* over = dynamic_cast<const OverLimit*>(&error))
    throw OverLimit(message, over->limit(), over->needed());
  if (dynamic_cast<const OutsideFolder*>(&error) != nullptr) throw OutsideFolder(message);
  throw Error(message);
}

}  // namespace lte::scene
