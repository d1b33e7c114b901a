// Which of a run's processes this is, as torchrun, srun and mpirun tell it through the environment.
#pragma once

#include <cstdint>
#include <string>

namespace lte::train {

/// One process among those of a run. The default is a process that is alone.
struct Rank {
  int index = 0;                      ///< 0 to count - 1
  int count = 1;                      ///< number of processes
  int local = 0;                      ///< index among the processes of this machine: its GPU
  std::string address = "127.0.0.1";  ///< where rank 0 listens
  uint16_t port = 29500;

  /// Rank 0 alone writes the run directory.
  bool leads() const { return index == 0; }
};

/// Reads RANK, WORLD_SIZE and LOCAL_RANK as torchrun sets them. Where they are missing and
/// MASTER_ADDR is set, it reads those of Open MPI (OMPI_COMM_WORLD_RANK, ...), of MPICH and Intel
/// MPI (PMI_RANK, ..., MPI_LOCALRANKID), or of a SLURM step (SLURM_PROCID, ...). MASTER_ADDR and
/// MASTER_PORT say where rank 0 listens. Where none of them is set, the process is alone.
/// @throws lte::Error naming the variable: not a number, out of range, or missing beside the others
Rank rank_from_environment();

}  // namespace lte::train
