#include "train/data/run_data.h"

#include <utility>

#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/cli/progress.h"
#include "lte/data/held_out.h"

namespace lte::train {
namespace {

uint64_t names_fingerprint(const std::vector<data::DatasetEntry>& entries) {
  uint64_t hash = entries.size();
  for (const data::DatasetEntry& entry : entries) {
    for (const char letter : entry.name)
      hash = hash_combine(hash, static_cast<unsigned char>(letter));
    hash = hash_combine(hash, '/');
  }
  return hash;
}

}  // namespace

RunData open_run_data(const TrainConfig& config) {
  LTE_CHECK(!config.data.root.empty(),
            "data.root: names no data set; give the directory that lte_datagen generate wrote, "
            "e.g. --set data.root=data/rooms");
  const std::filesystem::path root = config.data.root;
  const bool skip = config.data.on_bad_scene == BadScene::Skip;
  const data::DatasetInfo info = data::read_dataset_info(
      root, skip ? data::MissingScenes::Allow : data::MissingScenes::Refuse);
  LTE_CHECK(!config.has_scale || config.model.scale == info.scale,
            "model.scale: ", config.model.scale, " differs from the data set's ", info.scale, " (",
            (root / "dataset.json").string(), "); leave the key out to take the data set's");
  std::vector<data::DatasetEntry> train = data::entries_of(info, data::Split::Train);
  LTE_CHECK(!train.empty(), (root / "dataset.json").string(),
            ": no scene is in the split \"train\"");
  std::vector<data::DatasetEntry> val = data::entries_of(info, data::Split::Val);
  data::refuse_held_out(root, train);
  data::refuse_held_out(root, val);
  LTE_CHECK(!config.model.reads_estimates() || info.light_paths >= kMinPathsOfError,
            "model.light_input traced: the light estimates of ", root.string(), " come from ",
            info.light_paths, " paths, and the spread of fewer than ", kMinPathsOfError,
            " says nothing");
  const uint64_t fingerprint = names_fingerprint(train);
  SceneStoreOptions options{static_cast<size_t>(config.data.cache_mb) << 20, info.scale, skip,
                            LightKeys(config.model), config.data.solved_light};
  SceneStore train_store(root, std::move(train), options);
  options.cache_bytes = 0;  // each is read once
  SceneStore val_store(root, std::move(val), options);
  return {info.scale,
          info.pruned,
          info.suns,
          {info.light_paths, info.light_depth},
          std::move(train_store),
          std::move(val_store),
          fingerprint};
}

std::string check_run_data(const TrainConfig& config) {
  RunData data = open_run_data(config);
  int64_t points = 0, queries = 0;
  lte::Progress progress("checking", static_cast<int64_t>(data.train.size() + data.val.size()),
                         "scenes");
  for (SceneStore* store : {&data.train, &data.val}) {
    for (size_t i = 0; i < store->size(); ++i) {
      progress.advance();
      const auto scene = store->get(i);
      if (!scene) continue;
      points += scene->scene_points();
      queries += scene->query_points();
    }
  }
  const size_t bad = data.train.bad().size() + data.val.bad().size();
  return concat(config.data.root, ": ", data.train.size() - data.train.bad().size(),
                " scenes to train on, ", data.val.size() - data.val.bad().size(),
                " to validate on, ", points, " scene points, ", queries, " queries, scale ",
                data.scale, " m: ", bad == 0 ? "valid" : concat("valid but for ", bad, " scenes"),
                "\n");
}

}  // namespace lte::train
