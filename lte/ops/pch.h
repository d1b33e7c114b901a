// Precompiled: what almost every file here parses to register and run an operator.
#pragma once

#include "lte/tensor/functions.h"
#include "lte/tensor/library.h"
#include "lte/tensor/tensor.h"
