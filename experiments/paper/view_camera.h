// The camera of a G-buffer, from its positions alone: data sets keep what pixels see, not from
// where.
#pragma once

#include <optional>

#include <ATen/core/Tensor.h>

#include "lte/data/scene_sample.h"

namespace lte::experiments {

struct ViewCamera {
  at::Tensor rotation;  ///< [3, 3] float64, world to camera: x right, y down, z into the picture
  at::Tensor center;    ///< [3] float64, metres
};

/// Solves for the projection that takes each position to its pixel (direct linear transformation,
/// Hartley and Zisserman 2004, algorithm 7.1).
/// @return  nothing for a view that sees one plane alone, or less, which has many such cameras
std::optional<ViewCamera> camera_of(const data::View& view);

}  // namespace lte::experiments
