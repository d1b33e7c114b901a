// Precompiled: LibTorch's umbrella header costs 24 s of CPU in every file that parses it.
#pragma once

#include <torch/torch.h>
