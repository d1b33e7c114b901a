// Prints indirect irradiance at points of a small room, by a module that lte_export has written,
// and radiance there from other places, if the module tells it.
//   room_light MODEL.pt
// It needs LibTorch and nothing of lte, if the module was exported with --portable. room_light.py
// beside it does the same in Python; docs/torchscript.md explains the tensors.
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include <torch/script.h>

namespace {

constexpr double kCell = 0.25;  // metres between samples
constexpr double kPi = 3.14159265358979;
using Triple = std::array<float, 3>;

/// The cross product of the edges faces the room.
struct Rectangle {
  Triple corner, edge1, edge2, albedo, emission;
};
const Rectangle kRoom[] = {
    {{0, 0, 0}, {0, 0, 5}, {4, 0, 0}, {0.55f, 0.45f, 0.35f}, {0, 0, 0}},       // floor
    {{0, 2.5f, 0}, {4, 0, 0}, {0, 0, 5}, {0.8f, 0.8f, 0.8f}, {0, 0, 0}},       // ceiling
    {{0, 0, 0}, {0, 2.5f, 0}, {0, 0, 5}, {0.65f, 0.1f, 0.1f}, {0, 0, 0}},      // left
    {{4, 0, 0}, {0, 0, 5}, {0, 2.5f, 0}, {0.1f, 0.5f, 0.15f}, {0, 0, 0}},      // right
    {{0, 0, 0}, {4, 0, 0}, {0, 2.5f, 0}, {0.75f, 0.75f, 0.75f}, {0, 0, 0}},    // back
    {{0, 0, 5}, {0, 2.5f, 0}, {4, 0, 0}, {0.75f, 0.75f, 0.75f}, {0, 0, 0}},    // front
    {{1.4f, 2.49f, 1.8f}, {1.2f, 0, 0}, {0, 0, 1.4f}, {0, 0, 0}, {12, 11, 9}}  // lamp
};
using Places = std::vector<std::pair<std::string, Triple>>;
const Places kPlaces = {
    {"floor", {2.1f, 0, 2.6f}}, {"left wall", {0, 1.3f, 2.6f}}, {"back wall", {2.1f, 1.3f, 0}}};
/// Of each place, one that radiance comes from.
const Places kSeen = {{"the left wall", {0, 1.3f, 2.6f}},
                      {"the right wall", {4, 1.3f, 2.6f}},
                      {"the floor", {2.1f, 0, 2.6f}}};

at::Tensor tensor(const Triple& v) { return torch::tensor({v[0], v[1], v[2]}); }
at::Tensor columns(const at::Tensor& rows, int64_t from, int64_t to) {
  return rows.slice(1, from, to);
}

/// The cells of a rectangle: position, normal, albedo, emission, area; [cells, 13].
at::Tensor samples(const Rectangle& r) {
  const at::Tensor edge1 = tensor(r.edge1), edge2 = tensor(r.edge2);
  const auto rows = std::lround(edge1.norm().item<double>() / kCell),
             across = std::lround(edge2.norm().item<double>() / kCell);
  const at::Tensor u = (torch::arange(rows).repeat_interleave(across) + 0.5) / rows,
                   v = (torch::arange(across).repeat({rows}) + 0.5) / across;
  const at::Tensor normal = torch::linalg_cross(edge1, edge2), area = normal.norm();
  const at::Tensor same = torch::cat(
      {normal / area, tensor(r.albedo), tensor(r.emission), area.reshape({1}) / (rows * across)});
  return torch::cat({tensor(r.corner) + u.unsqueeze(1) * edge1 + v.unsqueeze(1) * edge2,
                     same.expand({rows * across, 10})},
                    1);
}

/// Direct and indirect irradiance at the points, by radiosity between the cells; 0 on the lamp. For
/// a model that reads it a renderer would trace some paths instead; others solve it themselves.
std::pair<at::Tensor, at::Tensor> light(const at::Tensor& points) {
  const at::Tensor position = columns(points, 0, 3), normal = columns(points, 3, 6),
                   albedo = columns(points, 6, 9), emission = columns(points, 9, 12),
                   area = columns(points, 12, 13).t();
  const at::Tensor to = position.unsqueeze(0) - position.unsqueeze(1),
                   distance2 = to.square().sum(2).clamp_min(1e-6),
                   here = (to * normal.unsqueeze(1)).sum(2).clamp_min(0),
                   there = (-to * normal.unsqueeze(0)).sum(2).clamp_min(0);
  // What a cell of the column gives to a point of the row, the cell taken for a disc.
  const at::Tensor share = here * there / distance2 * area / (kPi * distance2 + area);
  const at::Tensor direct = share.mm(kPi * emission);
  at::Tensor total = direct;
  for (int bounce = 0; bounce < 5; ++bounce) total = direct + share.mm(albedo * total);
  const at::Tensor dark = (emission.amax(1, true) == 0).to(torch::kFloat);
  return {dark * direct, dark * (total - direct)};
}

/// The cells at some places, [places].
at::Tensor nearest(const at::Tensor& points, const Places& places) {
  std::vector<int64_t> cells;
  for (const auto& place : places) {
    const at::Tensor offset = columns(points, 0, 3) - tensor(place.second);
    cells.push_back(offset.square().sum(1).argmin().item<int64_t>());
  }
  return torch::tensor(cells);
}

void print_rgb(const at::Tensor& rgb) {
  for (int c = 0; c < 3; ++c) std::printf("%7.3f", rgb[c].item<double>());
}

void print_table(const char* what, const std::vector<std::string>& names, const at::Tensor& answers,
                 const at::Tensor& expected) {
  std::printf("%-32snetwork: R      G      B   radiosity: R      G      B\n", what);
  for (size_t i = 0; i < names.size(); ++i) {
    std::printf("%-30s", names[i].c_str());
    print_rgb(answers[static_cast<int64_t>(i)]);
    std::printf("     ");
    print_rgb(expected[static_cast<int64_t>(i)]);
    std::printf("\n");
  }
}

void run(const char* path) {
  const torch::NoGradGuard no_grad;
  torch::jit::ExtraFilesMap files{{"normalization.json", ""}};
  torch::jit::Module model = torch::jit::load(path, torch::kCPU, files);
  // The names of the columns, and of those that the module solves, cut out of the text for want of
  // a JSON reader.
  const std::string& json = files["normalization.json"];
  const auto list = [&](const char* key) {
    const size_t begin = json.find(key);
    return begin == json.npos ? std::string() : json.substr(begin, json.find(']', begin) - begin);
  };
  const std::string names = list("\"points\""), solved = list("\"solved\"");
  const auto reads = [&](const char* name) {
    return names.find(name) != names.npos && solved.find(name) == solved.npos;
  };

  std::vector<at::Tensor> cells;
  for (const Rectangle& rectangle : kRoom) cells.push_back(samples(rectangle));
  const at::Tensor surface = torch::cat(cells);
  const auto [direct, indirect] = light(surface);
  std::vector<at::Tensor> points = {surface};
  if (reads("\"direct\"")) points.push_back(direct);
  if (reads("\"indirect\"")) points.push_back(indirect);
  // The backs of the walls are dark, the estimates exact, and nothing is metal.
  for (const char* back : {"\"direct_back\"", "\"indirect_back\""})
    if (reads(back)) points.push_back(torch::zeros_like(direct));
  if (reads("\"indirect_error\"")) points.push_back(torch::zeros({surface.size(0), 2}));
  if (reads("\"gloss\""))
    points.push_back(torch::tensor({0.0f, 1.0f}).expand({surface.size(0), 2}));

  const at::Tensor rows = nearest(surface, kPlaces), here = surface.index_select(0, rows),
                   queries = columns(here, 0, 9);
  const c10::IValue embedding = model.get_method("encode")({torch::cat(points, 1)});
  const at::Tensor irradiance = model.get_method("decode")({embedding, queries}).toTensor();
  std::vector<std::string> labels;
  for (const auto& place : kPlaces) labels.push_back(place.first);
  print_table("indirect irradiance, W/m^2", labels, irradiance, indirect.index_select(0, rows));

  const auto ask = model.find_method("radiance");
  if (!ask) return;
  const at::Tensor seen = nearest(surface, kSeen), there = surface.index_select(0, seen),
                   way = columns(there, 0, 3) - columns(here, 0, 3);
  const at::Tensor directions = (way / way.norm(2, {1}, true)).unsqueeze(1);
  const at::Tensor radiance = (*ask)({embedding, queries, directions}).toTensor().select(1, 0);
  for (size_t i = 0; i < labels.size(); ++i) labels[i] += " from " + kSeen[i].first;
  print_table("radiance, W sr^-1 m^-2", labels, radiance,
              columns(there, 6, 9) / kPi * (direct + indirect).index_select(0, seen));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: room_light MODEL.pt\n", stderr);
    return 2;
  }
  try {
    run(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "room_light: %s\n", error.what());
    return 1;
  }
}
