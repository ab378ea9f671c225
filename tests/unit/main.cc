// SPDX-License-Identifier: LGPL-2.1-or-later

// Runs the unit tests on any number of MPI ranks. Every rank runs the same
// tests in the same order; those other than the first report only failures.

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/mpi_singleton.h>

#include <gtest/gtest.h>

#include <iostream>

int
main(int argc, char **argv)
{
  testing::InitGoogleTest(&argc, argv);
  Viscoplastic::run_without_mpi_job();
  const dealii::Utilities::MPI::MPI_InitFinalize mpi(argc,
                                                     argv,
                                                     /* max_num_threads = */ 1);

  // A failed assertion is the failure of one test, not of all that follow.
  dealii::deal_II_exceptions::disable_abort_on_exception();
  dealii::deal_II_exceptions::suppress_stacktrace_in_exceptions();

  auto &listeners = testing::UnitTest::GetInstance()->listeners();
  class FailuresOnly : public testing::EmptyTestEventListener
  {
    void
    OnTestPartResult(const testing::TestPartResult &result) override
    {
      if (result.failed())
        std::cerr << "Rank "
                  << dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD)
                  << ", " << (result.file_name() ? result.file_name() : "")
                  << ":" << result.line_number() << ": " << result.summary()
                  << std::endl;
    }
  };
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) > 0)
    {
      delete listeners.Release(listeners.default_result_printer());
      listeners.Append(new FailuresOnly);
    }
  return RUN_ALL_TESTS();
}
