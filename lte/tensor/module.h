// Modules: what owns the parameters of a network, under the names that its file gives them.
#pragma once

#ifdef LTE_OWN_TENSORS
#include "lte/tensor/own/module.h"
#else
#include <torch/nn/init.h>
#include <torch/nn/module.h>
#include <torch/nn/modules/linear.h>
#include <torch/nn/modules/normalization.h>
#include <torch/nn/pimpl.h>
#endif
