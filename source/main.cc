// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/messages.h>
#include <viscoplastic_contact/viscoplastic_contact.h>

#include <chrono>
#include <iostream>
#include <thread>

namespace
{
  void
  run(const std::vector<std::string> &files)
  {
    const Viscoplastic::Parameters parameters(files);
    if (parameters.dimension == 2)
      Viscoplastic::ViscoplasticContact<2>(parameters).run();
    else
      Viscoplastic::ViscoplasticContact<3>(parameters).run();
  }
} // namespace



int
main(int argc, char *argv[])
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const unsigned int                       rank =
    dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
  const bool is_parallel =
    dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1;

  if (argc < 2)
    {
      if (rank == 0)
        std::cerr << "Usage: viscoplastic_contact scene.prm [more.prm ...]"
                  << std::endl;
      return 2;
    }
  try
    {
      run({argv + 1, argv + argc});
      return 0;
    }
  catch (const std::exception &exception)
    {
      // Most errors occur on all ranks; the first one speaks. A rank that fails
      // alone must speak, too, and end the others.
      if (rank > 0)
        std::this_thread::sleep_for(std::chrono::seconds(2));
      std::cerr << "viscoplastic_contact: " << Viscoplastic::reason(exception)
                << std::endl;
      if (is_parallel)
        MPI_Abort(MPI_COMM_WORLD, 1);
      return 1;
    }
}
