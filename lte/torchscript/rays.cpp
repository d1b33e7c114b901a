#include "lte/torchscript/rays.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "lte/torchscript/cache.h"
#include "lte/torchscript/text.h"

namespace lte::torchscript {
namespace {

// The numbers of lte/nn/points/surfels.cpp and lte/ops/surfel_walk.h, which say what they are for.
// A test holds the module's rays to those.
constexpr double kOverlap = 1.6, kDistanceShift = 1.6, kMinDistance = 1e-4;
constexpr double kOwn = 0.1, kLayer = 0.5, kSpread = 0.35, kInside = 0.1, kMinMetal = 0.02;
constexpr double kGoldenAngle = 2.3999632;
constexpr int kReflections = 4;

/// Pairs of a ray and a disc that are looked at together: a matrix of them is 4 MB.
constexpr int64_t kPairs = int64_t{1} << 20;

// Columns of a disc are those of nn::Surfels.
constexpr const char* kMakeSurfels =
    R"SCRIPT(    bounced = self.decode_normalized(embedding, points[:, 0:9])
    sent = torch.clamp_min(direct_sides[0] / scale, 0.0) + bounced
    albedo = points[:, 6:9] * (1.0 - {metallic})
    embedding['surfels'] = torch.cat([
        position,
        points[:, 3:6],
        torch.sqrt(points[:, 12:13] / {pi}) * {radius},
        albedo * sent,
        albedo * ((direct_sides[1] + indirect_sides[1]) / scale),
        points[:, 9:12] / scale * {pi},
        points[:, 6:9] * {metallic},
        {metallic},
        {roughness}], 1).contiguous()
)SCRIPT";

// What a ray meets first, blended; columns: distance, normal, what is sent, emission, metal,
// metallic, roughness, radius. Matrix products choose the pairs, with room for their rounding; what
// they choose is computed anew, as differences of near numbers lose digits there.
constexpr const char* kMet = R"SCRIPT(
def met(self, surfels: Tensor, origin: Tensor, direction: Tensor) -> Tuple[Tensor, Tensor]:
    place = surfels[:, 0:3]
    normal = surfels[:, 3:6]
    toward = torch.mm(direction, torch.t(normal))
    height = torch.sum(place * normal, [1]) - torch.mm(origin, torch.t(normal))
    along = torch.mm(direction, torch.t(place)) - torch.sum(direction * origin, [1], True)
    square = torch.sum(origin * origin, [1], True) - torch.mm(origin, torch.t(place)) * 2.0
    square = square + torch.sum(place * place, [1])
    distance = height / toward
    square = square + distance * (distance - along * 2.0)
    reach = surfels[:, 6] * surfels[:, 6] * 1.02 + {slack}
    pairs = torch.nonzero((distance > 0.0) & (square < reach))
    ray = pairs[:, 0]
    disc = surfels[pairs[:, 1]]
    way = direction[ray]
    offset = disc[:, 0:3] - origin[ray]
    radius = disc[:, 6]
    toward = torch.sum(way * disc[:, 3:6], [1])
    distance = torch.sum(offset * disc[:, 3:6], [1]) / toward
    away = way * distance.unsqueeze(1) - offset
    square = torch.sum(away * away, [1]) / (radius * radius)
    light = torch.tensor([0.2126, 0.7152, 0.0722], dtype=6, device=surfels.device)
    outside = torch.mv(disc[:, 10:13], light) > torch.mv(disc[:, 7:10], light) * {inside}
    met = (distance > radius * {own}) & (square < 1.0) & ((toward <= 0.0) | outside)
    limit = torch.full([origin.size(0)], float('inf'), dtype=6, device=surfels.device)
    rows = torch.nonzero(met).view([-1])
    limit = torch.scatter_reduce(
        limit, 0, ray[rows], distance[rows] + radius[rows] * {layer}, 'amin')
    rows = torch.nonzero(met & (distance <= limit[ray])).view([-1])
    front = toward[rows].unsqueeze(1) < 0.0
    disc = disc[rows]
    weight = torch.exp(square[rows] * -{sharpness}).unsqueeze(1)
    values = torch.cat([
        distance[rows].unsqueeze(1),
        torch.where(front, disc[:, 3:6], -disc[:, 3:6]),
        torch.where(front, disc[:, 7:10], disc[:, 10:13]),
        torch.where(front, disc[:, 13:16], torch.zeros_like(disc[:, 13:16])),
        disc[:, 16:21],
        disc[:, 6:7],
        torch.ones_like(weight)], 1)
    sums = torch.zeros([origin.size(0), values.size(1)], dtype=6, device=surfels.device)
    sums = torch.index_add(sums, 0, ray[rows], values * weight)
    total = sums[:, 16:17]
    hit = total > 0.0
    layer = sums[:, 0:16] / torch.where(hit, total, torch.ones_like(total))
    length = torch.sqrt(torch.sum(layer[:, 1:4] * layer[:, 1:4], [1], True))
    return hit, torch.cat([
        layer[:, 0:1], layer[:, 1:4] / torch.clamp_min(length, 1e-30), layer[:, 4:16]], 1)

def mirrored(self, direction: Tensor, about: Tensor) -> Tensor:
    return direction - about * (torch.sum(direction * about, [1], True) * 2.0)
)SCRIPT";

// Of a metal, what the reflections at GGX half vectors see: make_frame() of lte/base/math.h is
// written out.
constexpr const char* kReflected = R"SCRIPT(
def reflected{bounce}(self, surfels: Tensor, ambient: Tensor, layer: Tensor, origin: Tensor,
               direction: Tensor) -> Tensor:
    normal = layer[:, 1:4]
    start = origin + direction * layer[:, 0:1] + normal * (layer[:, 15:16] * {own})
    sign = torch.where(normal[:, 2] < 0.0, -torch.ones_like(normal[:, 2]),
                       torch.ones_like(normal[:, 2]))
    a = -1.0 / (sign + normal[:, 2])
    b = normal[:, 0] * normal[:, 1] * a
    x = torch.stack([sign * normal[:, 0] * normal[:, 0] * a + 1.0, sign * b,
                     -sign * normal[:, 0]], 1)
    y = torch.stack([b, sign + normal[:, 1] * normal[:, 1] * a, -normal[:, 1]], 1)
    alpha = layer[:, 14:15] * layer[:, 14:15]
    mirror = self.mirrored(direction, normal)
    tangents = {tangents}
    cosines = {cosines}
    sines = {sines}
    sum = torch.zeros_like(normal)
    for i in range(len(tangents)):
        tangent = alpha * tangents[i]
        cosine = 1.0 / torch.sqrt(tangent * tangent + 1.0)
        half = normal * cosine + (x * cosines[i] + y * sines[i]) * (tangent * cosine)
        way = self.mirrored(direction, half)
        way = torch.where(torch.sum(way * normal, [1], True) <= 0.0, mirror, way)
        hit, _, radiance = self.look{next}(surfels, ambient, start, way)
        sum = sum + torch.where(hit, radiance, ambient)
    return layer[:, 10:13] * sum / float(len(tangents))
)SCRIPT";

constexpr const char* kLook = R"SCRIPT(
def look{bounce}(self, surfels: Tensor, ambient: Tensor, origin: Tensor,
          direction: Tensor) -> Tuple[Tensor, Tensor, Tensor]:
    hit, layer = self.met(surfels, origin, direction)
    radiance = layer[:, 4:7]{emission}
    metals = torch.nonzero(layer[:, 13] > {least_metal}).view([-1])
    if metals.size(0) > 0:
        metal = layer[metals]
        radiance = torch.index_add(radiance, 0, metals, {reflected})
    return hit, layer, radiance
)SCRIPT";

constexpr const char* kSeen = R"SCRIPT(
def seen(self, embedding: Dict[str, Tensor], position: Tensor, directions: Tensor) -> Tensor:
    surfels = embedding['surfels']
    area = (surfels[:, 6] * surfels[:, 6]).to(7)
    ambient = torch.mv(torch.t(surfels[:, 7:10].to(7)), area) / torch.clamp_min(
        torch.sum(area), 1e-30)
    ambient = ambient.to(6)
    ways = torch.reshape(directions, [-1, 3])
    origins = torch.reshape(position.unsqueeze(1).expand(directions.size()), [-1, 3])
    out: List[Tensor] = [torch.zeros([0, 10], dtype=6, device=directions.device)]
    rays = max(1, {pairs} // surfels.size(0))
    begin = 0
    while begin < ways.size(0):
        way = ways[begin:begin + rays]
        hit, layer, radiance = self.look0(surfels, ambient, origins[begin:begin + rays], way)
        seen = torch.cat([
            radiance,
            torch.log1p(radiance),
            torch.ones_like(layer[:, 0:1]),
            torch.log(torch.clamp_min(layer[:, 0:1], {least_distance})) + {distance_shift},
            layer[:, 13:14],
            -torch.sum(way * layer[:, 1:4], [1], True)], 1)
        out.append(torch.where(hit, seen, torch.zeros_like(seen)))
        begin += rays
    return torch.reshape(torch.cat(out), [directions.size(0), directions.size(1), 10])
)SCRIPT";

/// "[1.0e+00, ...]": a literal list.
std::string list(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "[" : ", ") + number(value);
  return text + "]";
}

/// The reflections of a metal, as many as there are half vectors, whose rays `next` looks for.
std::string reflected(int bounce, int count) {
  std::vector<double> tangents, cosines, sines;
  for (int i = 0; i < count; ++i) {
    const double u = count == 1 ? 0 : (i + 0.5) / count;
    tangents.push_back(std::sqrt(u / (1 - u)));
    cosines.push_back(std::cos(i * kGoldenAngle));
    sines.push_back(std::sin(i * kGoldenAngle));
  }
  return fill(kReflected, {{"bounce", std::to_string(bounce)},
                           {"next", std::to_string(bounce + 1)},
                           {"tangents", list(tangents)},
                           {"cosines", list(cosines)},
                           {"sines", list(sines)}});
}

/// @param shine  whether emission is seen
/// @param last   metal then shows what all discs send out on average
std::string look(int bounce, bool shine, bool last) {
  const std::string at = std::to_string(bounce);
  return fill(kLook, {{"bounce", at},
                      {"emission", shine ? " + layer[:, 7:10]" : ""},
                      {"reflected", last ? std::string("metal[:, 10:13] * ambient")
                                         : "self.reflected" + at +
                                               "(\n            surfels, ambient, metal, "
                                               "origin[metals], direction[metals])"}});
}

}  // namespace

std::string make_surfels_source(const nn::ModelConfig& config) {
  if (!config.predicts_radiance()) return "";
  const int64_t gloss = kPointColumns + light_columns(config);
  const std::string at = std::to_string(gloss), next = std::to_string(gloss + 1),
                    end = std::to_string(gloss + 2);
  return fill(kMakeSurfels, {{"metallic", "points[:, " + at + ":" + next + "]"},
                             {"roughness", "points[:, " + next + ":" + end + "]"},
                             {"radius", number(kOverlap / config.scale)},
                             {"pi", number(std::numbers::pi)}});
}

std::string rays_source(const nn::ModelConfig& config) {
  if (!config.predicts_radiance()) return "";
  const std::string source = std::string(kMet) + look(2, true, true) + reflected(1, 1) +
                             look(1, true, false) + reflected(0, kReflections) +
                             look(0, false, false) + kSeen;
  return fill(source, {{"slack", number(4e-6)},
                       {"inside", number(kInside)},
                       {"own", number(kOwn)},
                       {"layer", number(kLayer)},
                       {"sharpness", number(1 / kSpread)},
                       {"least_metal", number(kMinMetal)},
                       {"pairs", std::to_string(kPairs)},
                       {"least_distance", number(kMinDistance)},
                       {"distance_shift", number(kDistanceShift)}});
}

}  // namespace lte::torchscript
