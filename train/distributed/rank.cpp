#include "train/distributed/rank.h"

#include <array>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "lte/base/check.h"

namespace lte::train {
namespace {

/// What a launcher calls the three numbers. `local` may be missing: then it is the rank.
struct Names {
  const char *rank, *size, *local;
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
  int value = 0;
  const char* end = text->data() + text->size();
  const auto [stop, error] = std::from_chars(text->data(), end, value);
  LTE_CHECK(error == std::errc() && stop == end && value >= low && value <= high,
            "environment variable ", name, "=", *text, ": expected a number from ", low, " to ",
            high);
  return value;
}

constexpr int kMostProcesses = 1 << 16;

World read_world(const Names& names) {
  World world;
  const std::optional<int> size = number(names.size, 1, kMostProcesses);
  LTE_CHECK(size, "environment variable ", names.rank, " is set and ", names.size,
            " is not; start through scripts/launch.sh, torchrun, srun or mpirun");
  world.size = *size;
  world.rank = *number(names.rank, 0, world.size - 1);
  world.local_rank = number(names.local, 0, kMostProcesses).value_or(world.rank);
  if (const auto address = variable("MASTER_ADDR")) world.address = *address;
  if (const auto port = number("MASTER_PORT", 1, 65535)) world.port = static_cast<uint16_t>(*port);
  return world;
}

}  // namespace

World world_from_environment() {
  if (variable(kTorchrun.rank)) return read_world(kTorchrun);
  LTE_CHECK(number(kTorchrun.size, 1, kMostProcesses).value_or(1) == 1, "environment variable ",
            kTorchrun.size, " is set and ", kTorchrun.rank,
            " is not; start through scripts/launch.sh, torchrun, srun or mpirun");
  if (!variable("MASTER_ADDR")) return {};
  for (const Names& names : kOthers) {
    if (variable(names.rank)) return read_world(names);
  }
  return {};
}

}  // namespace lte::train
