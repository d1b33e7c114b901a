// Operators by their names, and their gradients, which only LibTorch computes.
#pragma once

#ifdef LTE_OWN_TENSORS
#include "lte/tensor/own/autograd.h"
#include "lte/tensor/own/library.h"
#else
#include <ATen/core/LegacyTypeDispatch.h>
#include <ATen/core/dispatch/Dispatcher.h>
#include <torch/csrc/autograd/custom_function.h>
#include <torch/custom_class.h>
#include <torch/library.h>
#endif
