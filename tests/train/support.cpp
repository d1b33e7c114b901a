#include "tests/train/support.h"

#include <cmath>
#include <fstream>

#include "lte/base/check.h"
#include "lte/base/half.h"
#include "lte/base/random.h"

namespace lte::test {
namespace {

constexpr Vec3 kRoom = {4, 3, 5};

/// A random point on one of the six walls, normal inwards.
void wall_point(Rng* rng, Vec3* position, Vec3* normal) {
  const int axis = static_cast<int>(rng->below(3));
  const bool high = rng->below(2) == 1;
  for (int a = 0; a < 3; ++a) (*position)[a] = rng->uniform(0, kRoom[a]);
  (*position)[axis] = high ? kRoom[axis] : 0;
  *normal = {};
  (*normal)[axis] = high ? -1.0f : 1.0f;
}

/// cosines over squared distance; a floor keeps near pairs finite.
float form_factor(const Vec3& p, const Vec3& n, const Vec3& q, const Vec3& m) {
  const Vec3 d = q - p;
  const float r2 = dot(d, d) + 0.05f;
  const float a = std::max(0.0f, dot(d, n)), b = std::max(0.0f, -dot(d, m));
  return a * b / (r2 * r2);
}

std::vector<Rgb> gather(const std::vector<Vec3>& at, const std::vector<Vec3>& at_normal,
                        const std::vector<Vec3>& from, const std::vector<Vec3>& from_normal,
                        const std::vector<Rgb>& radiance, const std::vector<float>& area) {
  std::vector<Rgb> out(at.size());
  for (size_t i = 0; i < at.size(); ++i) {
    for (size_t j = 0; j < from.size(); ++j) {
      out[i] += radiance[j] * (area[j] * form_factor(at[i], at_normal[i], from[j], from_normal[j]));
    }
  }
  return out;
}

Rgb random_color(Rng* rng, float low, float high) {
  return {rng->uniform(low, high), rng->uniform(low, high), rng->uniform(low, high)};
}

}  // namespace

Transport transport(const std::vector<Vec3>& position, const std::vector<Vec3>& normal,
                    const std::vector<Rgb>& albedo, const std::vector<Rgb>& emission,
                    const std::vector<float>& area, const std::vector<Vec3>& query_position,
                    const std::vector<Vec3>& query_normal) {
  Transport out;
  out.direct = gather(query_position, query_normal, position, normal, emission, area);
  std::vector<Rgb> reflected = gather(position, normal, position, normal, emission, area);
  for (size_t i = 0; i < reflected.size(); ++i) reflected[i] *= albedo[i] * (1 / kPi);
  out.indirect = gather(query_position, query_normal, position, normal, reflected, area);
  return out;
}

data::SceneSample box_sample(uint64_t seed, int64_t points, int64_t queries) {
  Rng rng(seed, 77);
  data::SceneSample sample;
  sample.light_groups = 2;
  sample.seed = seed;
  sample.bounds_high = kRoom;
  const float area =
      2 * (kRoom.x * kRoom.y + kRoom.y * kRoom.z + kRoom.z * kRoom.x) / static_cast<float>(points);
  for (int64_t i = 0; i < points; ++i) {
    Vec3 p, n;
    wall_point(&rng, &p, &n);
    const int group = i < 8 ? 0 : i < 16 ? 1 : -1;
    if (group >= 0) {  // under the ceiling, facing down
      p = {rng.uniform(0.5f, 1.0f) + 2.0f * static_cast<float>(group), 2.9f,
           rng.uniform(1.0f, 4.0f)};
      n = {0, -1, 0};
    }
    sample.scene_position.push_back(p);
    sample.scene_normal.push_back(n);
    sample.scene_albedo.push_back(random_color(&rng, 0.1f, 0.9f));
    sample.scene_emission.push_back(group >= 0 ? random_color(&rng, 5, 20) : Rgb{});
    sample.scene_area.push_back(area);
    sample.scene_light.push_back(group);
  }
  for (int64_t i = 0; i < queries; ++i) {
    Vec3 p, n;
    wall_point(&rng, &p, &n);
    sample.query_position.push_back(p);
    sample.query_normal.push_back(n);
    sample.query_albedo.push_back(random_color(&rng, 0.1f, 0.9f));
  }
  for (int group = 0; group < 2; ++group) {
    std::vector<Rgb> emission = sample.scene_emission;
    for (size_t i = 0; i < emission.size(); ++i)
      emission[i] *= sample.scene_light[i] == group ? 1.0f : 0.0f;
    const Transport part =
        transport(sample.scene_position, sample.scene_normal, sample.scene_albedo, emission,
                  sample.scene_area, sample.query_position, sample.query_normal);
    sample.direct.insert(sample.direct.end(), part.direct.begin(), part.direct.end());
    sample.indirect.insert(sample.indirect.end(), part.indirect.begin(), part.indirect.end());
  }
  sample.variance.assign(static_cast<size_t>(queries), 0.0f);
  return sample;
}

void add_incident(data::SceneSample* sample, int64_t points) {
  constexpr int kBins = 4;
  sample->scene_metallic.assign(sample->scene_position.size(), 0.0f);
  sample->scene_roughness.assign(sample->scene_position.size(), 1.0f);
  for (size_t i = 0; i < sample->scene_metallic.size(); i += 3) {
    sample->scene_metallic[i] = 1;
    sample->scene_roughness[i] = 0.2f;
  }
  data::IncidentField& field = sample->incident;
  field.bins = kBins;
  field.samples = 1;
  for (int cell = 0; cell < kBins * kBins; ++cell) {  // on rings around the normal, of equal pdf
    const float height = std::sqrt(static_cast<float>(cell / kBins) / kBins + 0.1f),
                angle = kPi / 2 * static_cast<float>(cell % kBins);
    const float across = std::sqrt(1 - height * height);
    field.direction.push_back({across * std::cos(angle), across * std::sin(angle), height});
    field.pdf.push_back(1 / kPi);
  }
  for (size_t i = 0; i < static_cast<size_t>(points); ++i) {
    const Vec3 normal = sample->query_normal[i];
    field.position.push_back(sample->query_position[i]);
    field.normal.push_back(normal);
    field.tangent.push_back(std::abs(normal.x) > 0.5f ? Vec3{0, 1, 0} : Vec3{1, 0, 0});
    field.albedo.push_back(sample->query_albedo[i]);
    field.metallic.push_back(0);
    field.roughness.push_back(1);
    field.scale.push_back(0.25f);
  }
  for (size_t group = 0; group < 2; ++group) {
    const Vec3 lamp = sample->scene_position[8 * group];
    for (size_t i = 0; i < static_cast<size_t>(points); ++i) {
      const Vec3 normal = field.normal[i], tangent = field.tangent[i];
      for (const Vec3& local : field.direction) {
        const Vec3 world = tangent * local.x + cross(normal, tangent) * local.y + normal * local.z;
        const float towards = std::max(0.0f, dot(world, normalize(lamp - field.position[i])));
        const Rgb light = sample->scene_emission[8 * group] * (0.05f + 0.2f * towards * towards);
        for (int c = 0; c < 3; ++c) {
          field.indirect.push_back(to_half(light[c] / 0.25f));
          field.direct.push_back(to_half(0.5f * light[c] / 0.25f));
        }
      }
    }
  }
}

void write_dataset(const std::filesystem::path& root, int train, int val,
                   const std::function<void(int, data::SceneSample*)>& edit) {
  std::filesystem::create_directories(root / "scenes");
  data::DatasetInfo info;
  info.tool_version = "test";
  info.scale = 8;
  for (int i = 0; i < train + val; ++i) {
    data::SceneSample sample = box_sample(static_cast<uint64_t>(i));
    sample.name = concat("room", i);
    if (edit) edit(i, &sample);
    data::write_scene_sample(data::scene_path(root, sample.name), sample);
    info.scenes.push_back({sample.name, i < train ? data::Split::Train : data::Split::Val,
                           sample.seed, sample.scene_points(), sample.query_points()});
  }
  data::write_dataset_info(root, info);
}

std::string tiny_yaml(const std::filesystem::path& root, const std::filesystem::path& output) {
  return concat(
      "seed: 5\noutput: ", output.string(), "\ndata: {root: ", root.string(),
      ", scene_points: 192, queries_per_scene: 96}\n",
      "model: {channels: 32, nne_neighbours: 6, encoder_depths: [1, 1], encoder_widths: [1, 1], ",
      "decoder_depths: [1], decoder_widths: [1], patch_size: 16, dropout: 0.1, ",
      "query_neighbours: 6, query_layers: 2}\n",
      "train: {steps: 8, scenes_per_step: 2, learning_rate: 2.0e-3, min_learning_rate: 1.0e-4, ",
      "warmup_steps: 2, ema_decay: 0.9, log_every: 2, checkpoint_every: 3, validate_every: 4}\n");
}

train::TrainConfig tiny_config(const std::filesystem::path& root,
                               const std::filesystem::path& output, const std::string& extra) {
  const TempDir dir;
  const std::filesystem::path base = dir / "base.yaml", file = dir / "cfg.yaml";
  std::ofstream(base) << tiny_yaml(root, output);
  std::ofstream(file) << "parent: base.yaml\n" << extra;
  return train::TrainConfig::read(Config::load(file));
}

void expect_error(const std::function<void()>& body, const std::vector<std::string>& parts) {
  try {
    body();
  } catch (const std::exception& error) {
    for (const std::string& part : parts) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
          << error.what() << "\nlacks: " << part;
    }
    return;
  }
  ADD_FAILURE() << "nothing was thrown; expected: " << testing::PrintToString(parts);
}

std::vector<std::string> lines_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

}  // namespace lte::test
