#include "lte/pathtrace/transport/transport.h"

#include "lte/pathtrace/transport/transport_impl.h"

namespace lte::pathtrace {

template class BasicTransport<NoObserver>;

}  // namespace lte::pathtrace
