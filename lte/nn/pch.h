// Precompiled for what includes modules. LibTorch's umbrella torch/torch.h would double the time of
// every file that uses it: what it defines inline is instantiated again in each of them.
#pragma once

#include "lte/tensor/functions.h"
#include "lte/tensor/module.h"
