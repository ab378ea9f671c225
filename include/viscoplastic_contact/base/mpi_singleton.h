// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdlib>

namespace Viscoplastic
{
  /// Let a process that is not launched as part of an MPI job run on its own.
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
