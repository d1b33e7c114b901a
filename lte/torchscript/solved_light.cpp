// The portable source is lte/radiosity with a tensor in the place of a loop: what blocks the view
// (surfels.cpp, occupancy_grid.cpp), who sees whom (marches.cpp), and the solution
// (point_radiosity.cpp). Numbers that C++ holds as floats are rounded to floats, so that cells
// begin where they begin there.
#include "lte/torchscript/solved_light.h"

#include <numbers>

#include "lte/radiosity/constants.h"
#include "lte/radiosity/point_radiosity.h"
#include "lte/torchscript/text.h"

namespace lte::torchscript {
namespace {

constexpr const char* kNative = R"SCRIPT(
def solve_light(self, points: Tensor) -> Tensor:
    return lte.solve_light(
        points[:, 0:3].contiguous(), points[:, 3:6].contiguous(), points[:, 6:9].contiguous(),
        points[:, 9:12].contiguous(), points[:, 12].contiguous())
)SCRIPT";

// A grid is `low`, `size`, and the numbers `cell` and `inverse`; size is 0 without points.
constexpr const char* kGrid = R"SCRIPT(
def single(self, x: float) -> float:
    return float(torch.tensor(x, dtype=6))

def grid_around(self, points: Tensor, cell: float) -> Dict[str, Tensor]:
    size = torch.zeros([3], dtype=4)
    low = torch.zeros([3], dtype=6, device=points.device)
    if points.size(0) > 0:
        low = torch.amin(points, [0])
        extent = torch.amax(points, [0]) - low
        longest = float(torch.max(extent))
        cell = max(cell, self.single({min_cell} * longest))
        if cell <= 0.0:
            cell = 1.0
        wide = extent.to(7).cpu()
        size = (wide / cell).to(4) + 3
        while int(torch.prod(size)) > {max_cells}:
            cell = self.single(cell * {growth})
            size = (wide / cell).to(4) + 3
        low = low - cell
    inverse = 0.0
    if cell > 0.0:
        inverse = self.single(1.0 / cell)
    return {'low': low, 'size': size.to(points.device), 'cell': torch.tensor(cell, dtype=7),
            'inverse': torch.tensor(inverse, dtype=7)}

def cells_at(self, grid: Dict[str, Tensor], place: Tensor) -> Tensor:
    size = grid['size']
    at = torch.minimum(torch.clamp(place.to(4), min=0), size - 1)
    return (at[:, 0] * size[1] + at[:, 1]) * size[2] + at[:, 2]

def place_in(self, grid: Dict[str, Tensor], points: Tensor) -> Tensor:
    return (points - grid['low']) * float(grid['inverse'])
)SCRIPT";

// Surfels are middles, normals and keys: 3 cell + axis, in their order.
constexpr const char* kSurfels = R"SCRIPT(
def merged(self, middle: Tensor, normal: Tensor, key: Tensor) -> Tuple[Tensor, Tensor, Tensor]:
    keys, which, count = torch._unique2(key, True, True, True)
    sums = torch.zeros([keys.size(0), 6], dtype=6, device=key.device)
    sums = torch.index_add(sums, 0, which, torch.cat([middle, normal], 1))
    normals = sums[:, 3:6]
    length = torch.sqrt(torch.sum(normals * normals, [1], True))
    normals = torch.where(length > 0.0, normals / length, normals)
    return sums[:, 0:3] / count.unsqueeze(1).to(6), normals, keys

def find(self, keys: Tensor, wanted: Tensor) -> Tuple[Tensor, Tensor]:
    if keys.size(0) == 0:
        return torch.zeros_like(wanted), torch.zeros_like(wanted, dtype=11)
    at = torch.clamp(torch.searchsorted(keys, wanted), max=keys.size(0) - 1)
    return at, keys[at] == wanted

def surfels_at(self, points: Tensor, normals: Tensor,
               grid: Dict[str, Tensor]) -> Tuple[Tensor, Tensor, Tensor]:
    size = torch.abs(normals)
    x = size[:, 0]
    y = size[:, 1]
    z = size[:, 2]
    axis = torch.where(y >= z, torch.full_like(y, 1.0), torch.full_like(y, 2.0))
    axis = torch.where((x >= y) & (x >= z), torch.zeros_like(y), axis).to(4)
    turned = torch.gather(normals, 1, axis.unsqueeze(1)) < 0.0
    normals = torch.where(turned, -normals, normals)
    cell = self.cells_at(grid, self.place_in(grid, points))
    return self.merged(points, normals, 3 * cell + axis)

def surfels_of(self, points: Tensor, normals: Tensor,
               grid: Dict[str, Tensor]) -> Tuple[Tensor, Tensor, Tensor]:
    middle, normal, key = self.surfels_at(points, normals, grid)
    size = grid['size']
    cell = torch.floor_divide(key, 3)
    rest = torch.remainder(cell, size[1] * size[2])
    at = torch.stack([torch.floor_divide(cell, size[1] * size[2]),
                      torch.floor_divide(rest, size[2]), torch.remainder(rest, size[2])], 1)
    flat = {flat} * float(grid['cell'])
    middles: List[Tensor] = []
    facing: List[Tensor] = []
    keys: List[Tensor] = []
    for dx in range({reach} + 1):
        for dy in range(-{reach}, {reach} + 1):
            for dz in range(-{reach}, {reach} + 1):
                first = dx > 0 or dy > 0 or (dy == 0 and dz > 0)
                if not first or dx * dx + dy * dy + dz * dz > {reach} * {reach}:
                    continue
                offset = torch.tensor([dx, dy, dz], dtype=4, device=key.device)
                to = at + offset
                inside = torch.all((to >= 0) & (to < size), 1)
                step = (offset[0] * size[1] + offset[1]) * size[2] + offset[2]
                other, found = self.find(key, key + 3 * step)
                a = torch.nonzero(inside & found).squeeze(1)
                b = other[a]
                d = middle[b] - middle[a]
                off = torch.maximum(torch.abs(torch.sum(d * normal[a], [1])),
                                    torch.abs(torch.sum(d * normal[b], [1])))
                alike = torch.sum(normal[a] * normal[b], [1]) >= {min_cosine}
                near = torch.nonzero((off <= flat) & alike).squeeze(1)
                a = a[near]
                steps = 2 * max(dx, max(abs(dy), abs(dz)))
                along = d[near] / float(steps)
                axis = torch.remainder(key[a], 3)
                for i in range(1, steps):
                    p = middle[a] + along * float(i)
                    fill = 3 * self.cells_at(grid, self.place_in(grid, p)) + axis
                    _, there = self.find(key, fill)
                    new = torch.nonzero(torch.logical_not(there)).squeeze(1)
                    middles.append(p[new])
                    facing.append(normal[a][new])
                    keys.append(fill[new])
    fill_middle, fill_normal, fill_key = self.merged(
        torch.cat(middles), torch.cat(facing), torch.cat(keys))
    key, order = torch.sort(torch.cat([key, fill_key]), stable=True, dim=0, descending=False)
    return torch.cat([middle, fill_middle])[order], torch.cat([normal, fill_normal])[order], key

def occupied(self, points: Tensor, normals: Tensor, cell: float) -> Dict[str, Tensor]:
    grid = self.grid_around(points, cell)
    if points.size(0) == 0:
        return grid
    middle, normal, key = self.surfels_of(points, normals, grid)
    size = grid['size']
    cells, _, count = torch._unique2(torch.floor_divide(key, 3), True, True, True)
    shape = [1, 1, int(size[0]), int(size[1]), int(size[2])]
    near = torch.zeros(shape, dtype=6, device=points.device)
    near.view([-1]).index_fill_(0, cells, 1.0)
    clearance = torch.full(shape, {farthest}, dtype=4, device=points.device)
    for i in range({farthest}):
        reached = near > 0.0
        clearance = torch.where(reached, torch.clamp(clearance, max=i), clearance)
        near = torch.max_pool3d(near, [3, 3, 3], [1, 1, 1], [1, 1, 1])
    first = torch.zeros([cells.size(0)], dtype=4, device=points.device)
    first[1:] = torch.cumsum(count, 0)[:-1]
    clearance = clearance.view([-1])
    clearance[cells] = -(4 * first + count)
    grid['clearance'] = clearance
    grid['surfel'] = torch.cat([middle, normal], 1)
    return grid
)SCRIPT";

// Pairs of points march together; those that have come to their end drop out.
constexpr const char* kMarch = R"SCRIPT(
def crossed(self, grid: Dict[str, Tensor], start: Tensor, end: Tensor, mark: Tensor) -> Tensor:
    own = {own} * float(grid['cell'])
    radius = {radius} * float(grid['cell'])
    entry = -mark
    first = torch.floor_divide(entry, 4)
    count = torch.remainder(entry, 4)
    last = grid['surfel'].size(0) - 1
    blocked = torch.zeros_like(mark, dtype=11)
    for i in range(3):
        surfel = grid['surfel'][torch.clamp(first + i, max=last)]
        a = start - surfel[:, 0:3]
        normal = surfel[:, 3:6]
        above = torch.sum(a * normal, [1])
        below = torch.sum((end - surfel[:, 0:3]) * normal, [1])
        span = above - below
        off = a * span.unsqueeze(1) + (end - start) * above.unsqueeze(1)
        limit = radius * span
        hit = (above * below < 0.0) & (torch.minimum(torch.abs(above), torch.abs(below)) > own)
        hit = hit & (torch.sum(off * off, [1]) < limit * limit)
        blocked = blocked | (hit & (i < count))
    return blocked

def march(self, grid: Dict[str, Tensor], start: Tensor, end: Tensor) -> Tensor:
    visible = torch.ones([start.size(0)], dtype=11, device=start.device)
    if 'clearance' not in grid:
        return visible
    size = grid['size'].to(6)
    a = self.place_in(grid, start)
    way = self.place_in(grid, end) - a
    distance = torch.sqrt(torch.sum(way * way, [1], True))
    way = torch.where(distance > 0.0, way / distance, way)
    at = torch.zeros_like(distance)
    low = (0.0 - a) / way
    high = (size - a) / way
    along = way == 0.0
    outside = torch.any(along & ((a < 0.0) | (a > size)), 1)
    enter = torch.where(along, torch.zeros_like(low), torch.minimum(low, high))
    leave = torch.where(along, torch.full_like(low, float('inf')), torch.maximum(low, high))
    at = torch.clamp(torch.amax(enter, [1]), min=0.0)
    stop = torch.minimum(distance.squeeze(1), torch.amin(leave, [1]))
    stop = torch.where(outside, torch.full_like(stop, -1.0), stop)
    live = torch.arange(start.size(0), device=start.device)
    tested = torch.zeros_like(live)
    while live.size(0) > 0:
        cell = self.cells_at(grid, a + way * at.unsqueeze(1))
        clearance = grid['clearance'][cell]
        within = at <= stop
        marked = clearance < 0
        hits = torch.nonzero(within & marked & (clearance != tested)).squeeze(1)
        going = within
        if hits.size(0) > 0:
            pair = live[hits]
            blocked = self.crossed(grid, start[pair], end[pair], clearance[hits])
            visible[pair[blocked]] = False
            going = within.clone()
            going[hits[blocked]] = False
        at = at + torch.clamp((clearance - 1).to(6), min={step})
        tested = torch.where(marked, clearance, tested)
        keep = torch.nonzero(going).squeeze(1)
        live = live[keep]
        a = a[keep]
        way = way[keep]
        at = at[keep]
        stop = stop[keep]
        tested = tested[keep]
    return visible

def see(self, grid: Dict[str, Tensor], start: Tensor, end: Tensor) -> Tensor:
    out: List[Tensor] = [torch.zeros([0], dtype=11, device=start.device)]
    begin = 0
    while begin < start.size(0):
        out.append(self.march(grid, start[begin:begin + {pairs}], end[begin:begin + {pairs}]))
        begin += {pairs}
    return torch.cat(out)
)SCRIPT";

// Rows of matrices are points that receive; their columns are patches that send, and the sides that
// light leaves and reaches are parts of the rows and columns.
constexpr const char* kTransfer = R"SCRIPT(
def transfer(self, points: Tensor, normals: Tensor, patches: Tensor, facing: Tensor,
             area: Tensor) -> Tuple[Tensor, Tensor, Tensor]:
    d = patches.unsqueeze(0) - points.unsqueeze(1)
    d2 = torch.sum(d * d, [2])
    here = torch.sum(d * normals.unsqueeze(1), [2])
    there = torch.sum(d * facing.unsqueeze(0), [2])
    weight = torch.abs(here * there) / d2 * area / (d2 + area / {pi})
    weight = torch.where(d2 > 0.0, weight, torch.zeros_like(weight))
    return weight, there > 0.0, here < 0.0

def links(self, grid: Dict[str, Tensor], points: Tensor, normals: Tensor, patches: Tensor,
          facing: Tensor, area: Tensor) -> Tensor:
    weight, from_back, to_back = self.transfer(points, normals, patches, facing, area)
    pairs = torch.nonzero(weight >= {min_transfer})
    seen = self.see(grid, points[pairs[:, 0]], patches[pairs[:, 1]])
    kept = torch.zeros_like(weight)
    kept[pairs[:, 0], pairs[:, 1]] = seen.to(6)
    weight = torch.where(kept > 0.0, weight / {pi}, kept)
    none = torch.zeros_like(weight)
    sides: List[Tensor] = []
    for back in range(2):
        part = torch.where(to_back == (back == 1), weight, none)
        part = part / torch.clamp(torch.sum(part, [1], True), min=1.0)
        sides.append(torch.cat(
            [torch.where(from_back, none, part), torch.where(from_back, part, none)], 1))
    return torch.stack(sides, 1)

def received(self, links: Tensor, radiosity: Tensor) -> Tensor:
    rows = torch.reshape(links, [2 * links.size(0), links.size(2)])
    sent = torch.reshape(torch.transpose(radiosity, 0, 1), [links.size(2), 3])
    return torch.reshape(torch.mm(rows, sent), [links.size(0), 2, 3])
)SCRIPT";

constexpr const char* kLuminaires = R"SCRIPT(
def clusters(self, points: Tensor, normals: Tensor,
             cubes: Dict[str, Tensor]) -> Tuple[Tensor, Tensor]:
    facing = torch.zeros([points.size(0)], dtype=4, device=points.device)
    for axis in range(3):
        n = normals[:, axis]
        side = torch.where(n > {axis_cosine}, torch.full_like(n, 2.0), torch.zeros_like(n))
        side = torch.where(n < -{axis_cosine}, torch.full_like(n, 1.0), side)
        facing = 3 * facing + side.to(4)
    place = self.place_in(cubes, points)
    inside = torch.all((place >= 0.0) & (place < cubes['size'].to(6)), 1)
    alone = 27 * (2147483647 + torch.arange(points.size(0), device=points.device))
    key = torch.where(inside, 27 * self.cells_at(cubes, place) + facing, alone)
    _, which, count = torch._unique2(key, True, True, True)
    mean = torch.zeros([count.size(0), 3], dtype=6, device=points.device)
    mean = torch.index_add(mean, 0, which, points / count.to(6)[which].unsqueeze(1))
    off = points - mean[which]
    distance = torch.sqrt(torch.sum(off * off, [1]))
    order = torch.argsort(distance, stable=True, dim=0, descending=False)
    order = order[torch.argsort(which[order], stable=True, dim=0, descending=False)]
    first = torch.cumsum(count, 0) - count
    return which, points[order[first]]

def direct_light(self, grid: Dict[str, Tensor], points: Tensor, normals: Tensor, lamps: Tensor,
                 facing: Tensor, emission: Tensor, area: Tensor, which: Tensor,
                 middle: Tensor) -> Tensor:
    out: List[Tensor] = [torch.zeros([0, 2, 3], dtype=6, device=points.device)]
    block = max(1, {entries} // max(1, lamps.size(0)))
    begin = 0
    while begin < points.size(0):
        p = points[begin:begin + block]
        weight, from_back, to_back = self.transfer(
            p, normals[begin:begin + block], lamps, facing, area)
        none = torch.zeros_like(weight)
        weight = torch.where((weight >= {min_direct}) & torch.logical_not(from_back), weight, none)
        asked = torch.zeros([p.size(0), middle.size(0)], dtype=6, device=points.device)
        asked = torch.index_add(asked, 1, which, weight)
        pairs = torch.nonzero(asked > 0.0)
        seen = self.see(grid, p[pairs[:, 0]], middle[pairs[:, 1]])
        asked[pairs[:, 0], pairs[:, 1]] = seen.to(6)
        weight = weight * asked[:, which]
        out.append(torch.stack([torch.mm(torch.where(to_back, none, weight), emission),
                                torch.mm(torch.where(to_back, weight, none), emission)], 1))
        begin += block
    return torch.cat(out)
)SCRIPT";

constexpr const char* kSenders = R"SCRIPT(
def curve_order(self, points: Tensor, cubes: Dict[str, Tensor]) -> Tensor:
    cell = self.place_in(cubes, points).to(4)
    code = torch.zeros([points.size(0)], dtype=4, device=points.device)
    for bit in range(21):
        for axis in range(3):
            code = code | (((cell[:, axis] >> bit) & 1) << (3 * bit + axis))
    return torch.argsort(code, stable=True, dim=0, descending=False)

def senders(self, points: Tensor, albedo: Tensor, area: Tensor, direct: Tensor,
            cubes: Dict[str, Tensor]) -> Tuple[Tensor, Tensor]:
    if points.size(0) <= {senders}:
        return torch.arange(points.size(0), device=points.device), area
    areas = area.to(7)
    power = areas * torch.sum((albedo * torch.sum(direct, [1])).to(7), [1])
    total = float(torch.sum(power))
    whole = float(torch.sum(areas))
    if not whole > 0.0:
        return torch.zeros([0], dtype=4, device=points.device), area[:0]
    importance = areas / whole
    if total > 0.0 and total < float('inf'):
        importance = (1.0 - {by_light}) * importance + {by_light} * power / total
    step = float(torch.sum(importance)) / {senders}.0
    order = self.curve_order(points, cubes)
    marks = torch.round(torch.cumsum(importance[order], 0) / step)
    times = marks.clone()
    times[1:] = marks[1:] - marks[:-1]
    chosen = torch.nonzero(times > 0.0).squeeze(1)
    rows = order[chosen]
    return rows, (areas[rows] * (times[chosen] * step / importance[rows])).to(6)
)SCRIPT";

constexpr const char* kSolve = R"SCRIPT(
def indirect_light(self, grid: Dict[str, Tensor], points: Tensor, normals: Tensor,
                   albedo: Tensor, direct: Tensor, rows: Tensor, area: Tensor) -> Tensor:
    patches = points[rows]
    facing = normals[rows]
    among = self.links(grid, patches, facing, patches, facing, area)
    radiosity = torch.zeros_like(direct[rows])
    for bounce in range({bounces}):
        radiosity = albedo[rows].unsqueeze(1) * (direct[rows] + self.received(among, radiosity))
    out: List[Tensor] = [torch.zeros([0, 2, 3], dtype=6, device=points.device)]
    block = max(1, {entries} // max(1, rows.size(0)))
    begin = 0
    while begin < points.size(0):
        links = self.links(grid, points[begin:begin + block], normals[begin:begin + block],
                           patches, facing, area)
        out.append(self.received(links, radiosity))
        begin += block
    return torch.cat(out)

def solve_light(self, points: Tensor) -> Tensor:
    emits = torch.amax(points[:, 9:12], [1]) > 0.0
    dark = torch.nonzero(torch.logical_not(emits)).squeeze(1)
    lit = torch.nonzero(emits).squeeze(1)
    position = points[:, 0:3][dark]
    normal = points[:, 3:6][dark]
    lamps = points[:, 0:3][lit]
    facing = points[:, 3:6][lit]
    area = points[:, 12][dark]
    spacing = self.single(
        (float(torch.sum(area.to(7))) / float(max(1, dark.size(0)))) ** 0.5)
    blockers = position
    blocking = normal
    if dark.size(0) > 0:
        inside = (lamps >= torch.amin(position, [0])) & (lamps <= torch.amax(position, [0]))
        among = torch.nonzero(torch.all(inside, 1)).squeeze(1)
        blockers = torch.cat([position, lamps[among]])
        blocking = torch.cat([normal, facing[among]])
    grid = self.occupied(blockers, blocking, self.single({cell_spacings} * spacing))
    finer = self.single(max(1.0, points.size(0) / {finest}) ** 0.5)
    cubes = self.grid_around(
        blockers, self.single(self.single({cluster_spacings} * spacing) * finer))
    which, middle = self.clusters(lamps, facing, cubes)
    direct = self.direct_light(
        grid, position, normal, lamps, facing, points[:, 9:12][lit], points[:, 12][lit], which,
        middle)
    albedo = points[:, 6:9][dark]
    rows, sent_area = self.senders(
        position, albedo, area, direct, self.grid_around(blockers, spacing))
    indirect = self.indirect_light(grid, position, normal, albedo, direct, rows, sent_area)
    out = torch.zeros([points.size(0), 12], dtype=6, device=points.device)
    out[dark] = torch.cat(
        [torch.sum(direct, [1]), torch.sum(indirect, [1]), direct[:, 1], indirect[:, 1]], 1)
    return out
)SCRIPT";

/// Pairs that march together, and entries of a matrix: some 50 MB each.
constexpr int64_t kPairs = int64_t{1} << 19, kEntries = int64_t{1} << 20;

}  // namespace

std::string solved_light_source(bool portable) {
  if (!portable) return kNative;
  using namespace radiosity;
  const Options options;
  return fill(std::string(kGrid) + kSurfels + kMarch + kTransfer + kLuminaires + kSenders + kSolve,
              {{"min_cell", number(kMinCell)},
               {"max_cells", std::to_string(kMaxCells)},
               {"growth", number(kCellGrowth)},
               {"reach", std::to_string(kReach)},
               {"flat", number(kFlat)},
               {"min_cosine", number(kMinNormalCosine)},
               {"farthest", std::to_string(kFarthest)},
               {"step", number(kStep)},
               {"own", number(kOwnCells)},
               {"radius", number(kRadiusCells)},
               {"axis_cosine", number(kMinAxisCosine)},
               {"min_direct", number(kMinDirect)},
               {"min_transfer", number(kMinTransfer)},
               {"by_light", number(kShareByLight)},
               {"cell_spacings", number(kCellSpacings)},
               {"cluster_spacings", number(kClusterSpacings)},
               {"finest", number(kFinestClusters)},
               {"senders", std::to_string(options.senders)},
               {"bounces", std::to_string(options.bounces)},
               {"pairs", std::to_string(kPairs)},
               {"entries", std::to_string(kEntries)},
               {"pi", number(std::numbers::pi_v<float>)}});
}

}  // namespace lte::torchscript
