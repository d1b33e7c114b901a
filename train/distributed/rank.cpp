#include "train/distributed/rank.h"

#include <array>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "lte/base/check.h"
#include "lte/base/to_number.h"

namespace lte::train {
namespace {

/// What a launcher calls the three numbers of a Rank. Where `local` is not set, the index is taken.
struct Names {
  const char *index, *count, *local;
};
constexpr Names kTorchrun{"RANK", "WORLD_SIZE", "LOCAL_RANK"};
// Only with MASTER_ADDR: a batch script of SLURM has these as well, and is one process alone.
constexpr std::array<Names, 3> kOthers{
    {{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_LOCAL_RANK"},
     {"PMI_RANK", "PMI_SIZE", "MPI_LOCALRANKID"},
     {"SLURM_PROCID", "SLURM_NTASKS", "SLURM_LOCALID"}}};

std::optional<std::string> variable(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nobody calls setenv
  return value && *value ? std::optional<std::string>(value) : std::nullopt;
}

/// @return `name` as a number in [low, high]; nothing if it is not set
std::optional<int> number(const char* name, int low, int high) {
  const std::optional<std::string> text = variable(name);
  if (!text) return std::nullopt;
  const auto value = to_number<int>(*text);
  LTE_CHECK(value && *value >= low && *value <= high, "environment variable ", name, "=", *text,
            ": expected a number from ", low, " to ", high);
  return value;
}

constexpr int kMaxProcesses = 1 << 16;

Rank read_rank(const Names& names) {
  Rank rank;
  const std::optional<int> count = number(names.count, 1, kMaxProcesses);
  LTE_CHECK(count, "environment variable ", names.index, " is set and ", names.count,
            " is not; start through scripts/launch.sh, torchrun, srun or mpirun");
  rank.count = *count;
  rank.index = *number(names.index, 0, rank.count - 1);
  rank.local = number(names.local, 0, kMaxProcesses).value_or(rank.index);
  if (const auto address = variable("MASTER_ADDR")) rank.address = *address;
  if (const auto port = number("MASTER_PORT", 1, 65535)) rank.port = static_cast<uint16_t>(*port);
  return rank;
}

}  // namespace

Rank rank_from_environment() {
  if (variable(kTorchrun.index)) return read_rank(kTorchrun);
  LTE_CHECK(number(kTorchrun.count, 1, kMaxProcesses).value_or(1) == 1, "environment variable ",
            kTorchrun.count, " is set and ", kTorchrun.index,
            " is not; start through scripts/launch.sh, torchrun, srun or mpirun");
  if (!variable("MASTER_ADDR")) return {};
  for (const Names& names : kOthers) {
    if (variable(names.index)) return read_rank(names);
  }
  return {};
}

}  // namespace lte::train
