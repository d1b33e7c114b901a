// Functions of tensors, at::cat() and the like.
#pragma once

#ifdef LTE_OWN_TENSORS
#include "lte/tensor/own/functions.h"
#else
#include <ATen/ATen.h>
#endif
