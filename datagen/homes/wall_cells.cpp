#include "datagen/homes/wall_cells.h"

#include <algorithm>

namespace lte::datagen::homes {

std::vector<WallCell> wall_cells(const std::vector<Opening>& openings, Side side,
                                 const std::array<float, 2>& along,
                                 const std::array<float, 2>& up) {
  std::vector<float> columns(along.begin(), along.end()), rows(up.begin(), up.end());
  std::vector<Opening> holes;
  for (const Opening& o : openings) {
    if (o.side != side) continue;
    holes.push_back(o);
    columns.insert(columns.end(), {o.from, o.to});
    rows.insert(rows.end(), {o.bottom, o.top});
  }
  for (auto* cuts : {&columns, &rows}) {
    std::sort(cuts->begin(), cuts->end());
    cuts->erase(std::unique(cuts->begin(), cuts->end()), cuts->end());
  }
  std::vector<WallCell> cells;
  for (size_t i = 0; i + 1 < columns.size(); ++i) {
    for (size_t j = 0; j + 1 < rows.size(); ++j) {
      const WallCell cell{columns[i], columns[i + 1], rows[j], rows[j + 1]};
      const float a = (cell.a0 + cell.a1) / 2, y = (cell.y0 + cell.y1) / 2;
      const auto takes = [&](const Opening& o) {
        return a > o.from && a < o.to && y > o.bottom && y < o.top;
      };
      if (std::none_of(holes.begin(), holes.end(), takes)) cells.push_back(cell);
    }
  }
  return cells;
}

}  // namespace lte::datagen::homes
