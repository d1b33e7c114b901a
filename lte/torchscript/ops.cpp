#include "lte/torchscript/ops.h"

namespace lte::torchscript {
namespace {

constexpr const char* kNative = R"SCRIPT(
def farthest_points(self, points: Tensor, count: int) -> Tuple[Tensor, Tensor]:
    return lte.farthest_point_sampling(points.contiguous(), count)

def nearest(self, queries: Tensor, points: Tensor, k: int) -> Tensor:
    index, _ = lte.knn(queries.contiguous(), points.contiguous(), k)
    return index

def curve_codes(self, cells: Tensor, curve: int, bits: int) -> Tensor:
    return lte.curve_codes(cells, curve, bits)

def convolution_pairs(self, cells: Tensor, kernel: int) -> Tuple[Tensor, Tensor]:
    return lte.convolution_pairs(cells, kernel)

def submanifold_conv(self, x: Tensor, weight: Tensor, bias: Optional[Tensor], pairs: Tensor,
                     tap_begin: Tensor) -> Tensor:
    return lte.submanifold_conv(x, weight, bias, pairs, tap_begin)

def neighbour_table(self, keys: Tensor, values: Tensor) -> Tensor:
    return lte.neighbour_table(keys, values)

def neighbour_sums(self, table: Tensor, hidden: Tensor, weight: Tensor, bias: Tensor,
                   index: Tensor) -> Tuple[Tensor, Tensor]:
    return lte.neighbour_sums_inference(table, hidden, weight, bias, index)
)SCRIPT";

// Scalar types are numbers here, as in TorchScript's own serialization: 3 int32, 4 int64, 6
// float32, 7 float64. Equal distances go to the lower index, as the operators have it: torch.max
// finds the first, but torch.topk any. So distances grow by 2^-50 of themselves a row, less than
// float32 tells apart for up to 2^25 points, and those of 0 by less than any other.
constexpr const char* kPortableGeometry = R"SCRIPT(
def farthest_points(self, points: Tensor, count: int) -> Tuple[Tensor, Tensor]:
    picks = torch.zeros([count], dtype=4, device=points.device)
    insertion = torch.full([count], float('inf'), dtype=6, device=points.device)
    nearest = torch.full([points.size(0)], float('inf'), dtype=6, device=points.device)
    last = 0
    for i in range(1, count):
        d = points - points[last]
        d = d * d
        nearest = torch.minimum(nearest, d[:, 0] + d[:, 1] + d[:, 2])
        nearest[last] = -1.0
        distance, pick = torch.max(nearest, 0)
        last = int(pick)
        picks[i] = last
        insertion[i] = distance
    return picks, insertion

def nearest(self, queries: Tensor, points: Tensor, k: int) -> Tensor:
    columns = min(k, points.size(0))
    block = max(1, 2097152 // points.size(0))
    row = torch.arange(points.size(0), dtype=7, device=points.device)
    later = 1.0 + row * 8.881784197001252e-16
    nudge = row * 1e-60
    found: List[Tensor] = [torch.zeros([0, columns], dtype=4, device=points.device)]
    begin = 0
    while begin < queries.size(0):
        d = queries[begin:begin + block].unsqueeze(1) - points.unsqueeze(0)
        d = d * d
        d = (d[:, :, 0] + d[:, :, 1] + d[:, :, 2]).to(7) * later + nudge
        _, index = torch.topk(d, columns, 1, False, True)
        found.append(index)
        begin += block
    return torch.cat(found)

def spread_bits(self, v: Tensor) -> Tensor:
    v = (v | (v << 32)) & 8725724278095871
    v = (v | (v << 16)) & 8725728556220671
    v = (v | (v << 8)) & 1157144660301377551
    v = (v | (v << 4)) & 1207822528635744451
    v = (v | (v << 2)) & 1317624576693539401
    return v

def z_code(self, x: Tensor, y: Tensor, z: Tensor) -> Tensor:
    return (self.spread_bits(x) << 2) | (self.spread_bits(y) << 1) | self.spread_bits(z)

def curve_codes(self, cells: Tensor, curve: int, bits: int) -> Tensor:
    axes = [cells[:, 0].to(4), cells[:, 1].to(4), cells[:, 2].to(4)]
    if curve == 1 or curve == 3:
        axes = [axes[1], axes[0], axes[2]]
    if curve >= 2:
        for step in range(bits):
            bit = bits - 1 - step
            low = (1 << bit) - 1
            for a in range(3):
                on = ((axes[a] >> bit) & 1) == 1
                swap = (axes[0] ^ axes[a]) & low
                first = torch.where(on, axes[0] ^ low, axes[0] ^ swap)
                axes[a] = torch.where(on, axes[a], axes[a] ^ swap)
                axes[0] = first
    code = self.z_code(axes[0], axes[1], axes[2])
    if curve >= 2:
        for shift in [1, 2, 4, 8, 16, 32]:
            code = code ^ (code >> shift)
    return code
)SCRIPT";

constexpr const char* kPortableNetwork = R"SCRIPT(
def convolution_pairs(self, cells: Tensor, kernel: int) -> Tuple[Tensor, Tensor]:
    n = cells.size(0)
    half = kernel // 2
    c = cells.to(4)
    key = (c[:, 0] << 40) | (c[:, 1] << 20) | c[:, 2]
    ordered, order = torch.sort(key, stable=True, dim=0, descending=False)
    outputs: List[Tensor] = []
    inputs: List[Tensor] = []
    begin: List[int] = [0]
    total = 0
    for dx in range(kernel):
        for dy in range(kernel):
            for dz in range(kernel):
                if dx == half and dy == half and dz == half:
                    out = torch.arange(n, device=cells.device)
                    source = out
                else:
                    step = [dx - half, dy - half, dz - half]
                    shifted = c + torch.tensor(step, dtype=4, device=cells.device)
                    inside = torch.all((shifted >= 0) & (shifted < 1048576), 1)
                    wanted = (shifted[:, 0] << 40) | (shifted[:, 1] << 20) | shifted[:, 2]
                    at = torch.clamp(torch.searchsorted(ordered, wanted), max=n - 1)
                    out = torch.nonzero(inside & (ordered[at] == wanted)).squeeze(1)
                    source = order[at[out]]
                outputs.append(out)
                inputs.append(source)
                total += out.size(0)
                begin.append(total)
    return torch.stack([torch.cat(outputs), torch.cat(inputs)]), torch.tensor(begin, dtype=4)

def submanifold_conv(self, x: Tensor, weight: Tensor, bias: Optional[Tensor], pairs: Tensor,
                     tap_begin: Tensor) -> Tensor:
    y = torch.zeros([x.size(0), weight.size(2)], dtype=x.dtype, device=x.device)
    for tap in range(weight.size(0)):
        begin = int(tap_begin[tap])
        end = int(tap_begin[tap + 1])
        if end > begin:
            y.index_add_(0, pairs[0, begin:end], torch.mm(x[pairs[1, begin:end]], weight[tap]))
    if bias is not None:
        y = y + bias
    return y

def neighbour_table(self, keys: Tensor, values: Tensor) -> Tensor:
    return torch.stack([keys, values])

def neighbour_sums(self, table: Tensor, hidden: Tensor, weight: Tensor, bias: Tensor,
                   index: Tensor) -> Tuple[Tensor, Tensor]:
    keys = table[0]
    values = table[1]
    p = torch.linear(hidden, weight, bias)
    first: List[Tensor] = []
    second: List[Tensor] = []
    for layer in range(keys.size(0)):
        v = values[layer][index] + p
        first.append(torch.sum(v, 1))
        second.append(torch.sum((p - keys[layer][index]) * v, 1))
    return torch.stack(first), torch.stack(second)
)SCRIPT";

}  // namespace

std::string ops_source(bool portable) {
  return portable ? std::string(kPortableGeometry) + kPortableNetwork : std::string(kNative);
}

}  // namespace lte::torchscript
