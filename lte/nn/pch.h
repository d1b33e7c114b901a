// Precompiled for what includes LibTorch's modules. The umbrella torch/torch.h would double the
// time of every file that uses it: what it defines inline is instantiated again in each of them.
#pragma once

#include <ATen/ATen.h>
#include <torch/nn/init.h>
#include <torch/nn/module.h>
#include <torch/nn/modules/linear.h>
#include <torch/nn/modules/normalization.h>
#include <torch/nn/pimpl.h>
#include <torch/types.h>
