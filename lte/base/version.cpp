#include "lte/base/version.h"

namespace lte {

const char* version() { return LTE_VERSION; }

}  // namespace lte
