// The whole library in one include, and the glossary that every header uses. docs/glossary.md has
// all words, docs/architecture.md the layers.
//
// Shapes: N points; M scene points and m = M/4 latents of one scene; Q queries; K (κ) neighbours;
//   C channels, D the network's width; H heads; L layers of the query decoder; G light groups, one
//   a luminaire. [A, B] is a row-major tensor.
// Units: metres; radiance L in W sr^-1 m^-2; irradiance E = ∫ L cosθ dω in W/m², not divided by π;
//   radiant intensity in W/sr; colors are linear Rec.709 triples. Angles are radians but for the
//   field of view of a camera, in degrees.
// Frames: world space is the scene file's own after node transforms (glTF: Y up). Network space is
//   (p − b_min)/s, with b_min the least corner of the scene points and s the model's scale; nothing
//   outside lte/nn sees it.
// Sides: a triangle's front is counter-clockwise; normals are geometric and unit. A query's normal
//   names the side asked about.
// Depth: counts surface hits after leaving a point; 1 is direct light. Indirect is total minus
//   direct.
// Errors: lte::Error without LibTorch, c10::Error with it. Both are std::exceptions whose first
//   line says what, expected, got.
#pragma once

#include "lte/base/check.h"
#include "lte/base/config.h"
#include "lte/base/log.h"
#include "lte/base/safetensors.h"
#include "lte/data/dataset.h"
#include "lte/data/held_out.h"
#include "lte/data/scene_sample.h"
#include "lte/gi/gather.h"
#include "lte/image/denoise.h"
#include "lte/image/exr.h"
#include "lte/image/metrics.h"
#include "lte/image/png.h"
#include "lte/image/tonemap.h"
#include "lte/pathtrace/adaptive.h"
#include "lte/pathtrace/direct_light.h"
#include "lte/pathtrace/incident/hemisphere_bins.h"
#include "lte/pathtrace/incident/incident.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/placement/added_light.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "lte/pathtrace/placement/turntable.h"
#include "lte/pathtrace/probe.h"
#include "lte/pathtrace/reach/reach.h"
#include "lte/pathtrace/render.h"
#include "lte/render/picture.h"
#include "lte/render/progressive.h"
#include "lte/scene/export.h"
#include "lte/scene/fingerprint.h"
#include "lte/scene/load.h"
#include "lte/scene/load_camera.h"
#include "lte/scene/metal.h"
#include "lte/scene/point_table.h"
#include "lte/scene/sampler.h"
#if __has_include(<ATen/core/Tensor.h>)
#include "lte/embed/embed.h"
#include "lte/nn/files/model_file.h"
#include "lte/nn/loss.h"
#include "lte/nn/model.h"
#include "lte/ops/curve_codes.h"
#include "lte/ops/farthest_point.h"
#include "lte/ops/knn.h"
#include "lte/ops/neighbour_sums.h"
#include "lte/ops/solve_light.h"
#include "lte/ops/submanifold_conv.h"
#include "lte/runtime/embedding.h"
#include "lte/runtime/embedding_file.h"
#endif
