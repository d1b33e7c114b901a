// Built with LTE_HAS_GLOO and LTE_HAS_NCCL as far as their headers are found
// (cmake/LteDistributed.cmake).
#include "train/distributed/process_group_backend.h"

#include <cstdlib>

#include "lte/base/check.h"

#ifdef LTE_HAS_GLOO
#include <torch/csrc/distributed/c10d/ProcessGroupGloo.hpp>
#endif
#ifdef LTE_HAS_NCCL
#include <torch/csrc/distributed/c10d/ProcessGroupNCCL.hpp>
#endif

namespace lte::train {
namespace {

#ifdef LTE_HAS_GLOO
c10::intrusive_ptr<c10d::Backend> gloo_backend(const c10::intrusive_ptr<c10d::Store>& store,
                                               const Rank& rank,
                                               std::chrono::milliseconds timeout) {
  using c10d::ProcessGroupGloo;
  const auto options = ProcessGroupGloo::Options::create(timeout);
  const bool one_machine = rank.address == "127.0.0.1" || rank.address == "localhost";
  // The variable by which PyTorch's users name the network interface.
  const char* interface = std::getenv("GLOO_SOCKET_IFNAME");  // NOLINT(concurrency-mt-unsafe)
  options->devices.push_back(interface     ? ProcessGroupGloo::createDeviceForInterface(interface)
                             : one_machine ? ProcessGroupGloo::createDeviceForHostname("127.0.0.1")
                                           : ProcessGroupGloo::createDefaultDevice());
  return c10::make_intrusive<ProcessGroupGloo>(store, rank.index, rank.count, options);
}
#else
c10::intrusive_ptr<c10d::Backend> gloo_backend(const c10::intrusive_ptr<c10d::Store>&, const Rank&,
                                               std::chrono::milliseconds) {
  throw Error(
      "this build has no Gloo: install libgloo-dev and build anew to train on CPUs in "
      "several processes");
}
#endif

#ifdef LTE_HAS_NCCL
c10::intrusive_ptr<c10d::Backend> nccl_backend(const c10::intrusive_ptr<c10d::Store>& store,
                                               const Rank& rank,
                                               std::chrono::milliseconds timeout) {
  using c10d::ProcessGroupNCCL;
  const auto options = ProcessGroupNCCL::Options::create();
  options->timeout = timeout;
  return c10::make_intrusive<ProcessGroupNCCL>(store, rank.index, rank.count, options);
}
#else
c10::intrusive_ptr<c10d::Backend> nccl_backend(const c10::intrusive_ptr<c10d::Store>&, const Rank&,
                                               std::chrono::milliseconds) {
  throw Error(
      "this build has no NCCL: build with LTE_CUDA=ON where nccl.h is found to train on "
      "several GPUs");
}
#endif

}  // namespace

c10::intrusive_ptr<c10d::ProcessGroup> make_backend(const c10::intrusive_ptr<c10d::Store>& store,
                                                    const Rank& rank, at::Device device,
                                                    std::chrono::milliseconds timeout) {
  auto group = c10::make_intrusive<c10d::ProcessGroup>(store, rank.index, rank.count);
  const bool cpu = device.is_cpu();
  const auto type =
      cpu ? c10d::ProcessGroup::BackendType::GLOO : c10d::ProcessGroup::BackendType::NCCL;
  auto backend = cpu ? gloo_backend(store, rank, timeout) : nccl_backend(store, rank, timeout);
  backend->setSequenceNumberForGroup();
  group->setBackend(device.type(), type, backend);
  group->setDefaultBackend(type);
  return group;
}

}  // namespace lte::train
