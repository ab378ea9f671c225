// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdlib>

namespace Viscoplastic
{
  /// Let a process that is not launched as part of an MPI job run on its own.
  ///
  /// Without mpirun, MPI_Init of Open MPI 4 starts a daemon (orted) for each
  /// process, which only MPI_Comm_spawn needs. The daemon takes time to start,
  /// outlives a process that is killed, and simultaneous starts may fail.
  /// Without daemons, all such processes would share one session directory,
  /// which the first one to end removes while others start; they do not need
  /// it. MPI_Init also lets network libraries look for adapters, and that of
  /// Omni-Path waits a quarter of a second if there are none; the component
  /// `ob1' does without these libraries.
  ///
  /// Call this before MPI_Init: unless a launcher is present, it sets variables
  /// of Open MPI that turn all this off, if they are not set in the
  /// environment. Other implementations of MPI ignore them. Returns whether
  /// there is no launcher.
  inline bool
  run_without_mpi_job()
  {
    // Set by mpirun of Open MPI, by launchers that speak PMIx or PMI (prterun,
    // srun, mpiexec.hydra), and by srun.
    for (const char *name :
         {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "SLURM_STEP_ID"})
      if (std::getenv(name) != nullptr)
        return false;
    setenv("OMPI_MCA_ess_singleton_isolated", "1", /* overwrite = */ 0);
    setenv("OMPI_MCA_orte_create_session_dirs", "0", /* overwrite = */ 0);
    setenv("OMPI_MCA_pml", "ob1", /* overwrite = */ 0);
    return true;
  }
} // namespace Viscoplastic
