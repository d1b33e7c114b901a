// What a builder leaves standing in a shell: door leaves, window bars, columns, free walls and
// mezzanines.
#pragma once

#include "datagen/wild/builder.h"

namespace lte::datagen::wild {

void build_structure(Builder* builder, Dice* dice);

}  // namespace lte::datagen::wild
