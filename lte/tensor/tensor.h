// The tensors that operators and networks compute with: LibTorch's, or, in builds without it, our
// own. Those have the part of LibTorch's interface that inference uses, under the same names, on
// the CPU: the sources of lte/ops, lte/nn and lte/runtime are the same in both builds.
//
// The four headers of this folder are the only ones that know which.
#pragma once

#ifdef LTE_OWN_TENSORS
#include "lte/tensor/own/device.h"
#include "lte/tensor/own/parallel.h"
#include "lte/tensor/own/tensor.h"
#else
#include <ATen/Parallel.h>
#include <ATen/core/Tensor.h>
#include <ATen/core/grad_mode.h>
#include <c10/core/DeviceGuard.h>
#include <c10/core/Event.h>
#include <c10/core/impl/VirtualGuardImpl.h>
#include <c10/macros/Macros.h>
#include <c10/util/BFloat16.h>
#include <c10/util/Exception.h>
#endif
