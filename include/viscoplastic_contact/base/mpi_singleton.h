// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdlib>

namespace Viscoplastic
{
  /// Let a process that nobody launches as part of an MPI job run on its own.
  ///
  /// Without mpirun, MPI_Init of Open MPI 4 starts a daemon (orted) for each
  /// process, which only MPI_Comm_spawn would need. The daemon takes time to
  /// start, outlives a process that is killed, and simultaneous starts may
  /// fail. Without the daemon, all such processes share one directory for their
  /// session, which the first that ends takes from those that start: they need
  /// none.
  /// MPI_Init also asks the libraries of networks for their adapters, and that
  /// of Omni-Path waits a quarter of a second for them where there are none:
  /// `ob1' is what talks without these libraries. Call this before MPI_Init; it
  /// says so to Open MPI unless the environment is that of a launcher or says
  /// something else. Other implementations of MPI take no notice. Returns
  /// whether nobody has launched the process as part of a job.
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
