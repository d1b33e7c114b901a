// Furniture put together from boxes and cylinders.
#pragma once

#include "datagen/boxes/materials.h"
#include "datagen/common/parts.h"
#include "lte/base/random.h"

namespace lte::datagen::boxes {

enum class PieceKind {
  Table,
  CoffeeTable,
  Desk,
  Cabinet,
  Shelf,
  Sofa,
  Bed,
  Lamp,
  Plant,
  Stool,
  Cartons,
  Rug,
  Pillar
};
inline constexpr int kPieceKinds = 13;

/// Whether it stands with its back to a wall. Other pieces stand anywhere, at any angle.
bool stands_at_wall(PieceKind kind);

/// Makes a piece of random size, parts and materials. No two of its parts overlap, and no faces
/// coincide: where one part stands on or against another, the covered face of the smaller is left
/// out.
/// @param room_height  metres; pieces stay below the ceiling, and a pillar reaches it
Assembly make_piece(PieceKind kind, float room_height, MaterialFactory* materials, Rng* rng);

}  // namespace lte::datagen::boxes
