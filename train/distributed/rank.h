// Which process of how many this is, as torchrun, srun and mpirun tell it through the environment.
#pragma once

#include <cstdint>
#include <string>

namespace lte::train {

struct World {
  int rank = 0;                       ///< 0 to size - 1
  int size = 1;                       ///< number of processes
  int local_rank = 0;                 ///< among those of this machine: its GPU
  std::string address = "127.0.0.1";  ///< where rank 0 listens
  uint16_t port = 29500;

  /// Rank 0 alone writes the run directory.
  bool leads() const { return rank == 0; }
};

/// RANK, WORLD_SIZE and LOCAL_RANK as torchrun sets them; where they are missing and MASTER_ADDR is
/// set, those of Open MPI (OMPI_COMM_WORLD_RANK, ...), of MPICH and Intel MPI (PMI_RANK, ...,
/// MPI_LOCALRANKID), or of a SLURM step (SLURM_PROCID, ...). MASTER_ADDR and MASTER_PORT say where
/// rank 0 listens. One process alone if none of them is set.
/// @throws lte::Error naming the variable: not a number, out of range, or missing beside the others
World world_from_environment();

}  // namespace lte::train
