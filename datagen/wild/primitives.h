// Things of plain and displaced shapes, on y = 0 about the origin.
#pragma once

#include "datagen/homes/piece.h"
#include "datagen/wild/dice.h"
#include "datagen/wild/materials.h"

namespace lte::datagen::wild {

/// @param size  metres, of its largest side, about
homes::Piece make_primitive(float size, Materials* materials, Dice* dice);

}  // namespace lte::datagen::wild
