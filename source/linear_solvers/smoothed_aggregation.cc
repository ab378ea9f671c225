// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/lac/trilinos_precondition.h>

#include <viscoplastic_contact/linear_solvers/smoothed_aggregation.h>

#include <Teuchos_ParameterList.hpp>
#include <ml_MultiLevelPreconditioner.h>
#include <ml_utils.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace Viscoplastic
{
  SmoothedAggregation::SmoothedAggregation(
    std::unique_ptr<TrilinosWrappers::SparseMatrix> matrix_,
    std::vector<double>                             near_null_space_,
    const unsigned int                              dim)
    : matrix(std::move(matrix_))
    , near_null_space(std::move(near_null_space_))
    , amg(std::make_unique<TrilinosWrappers::PreconditionAMG>())
  {
    // ML shifts the diagonal of the coarsest matrix by 1e-12, so very small or
    // large units of stress are scaled, by a power of two, which is exact.
    const MPI_Comm communicator = matrix->get_mpi_communicator();
    double         largest      = 0.;
    for (const auto row : matrix->locally_owned_range_indices())
      largest = std::max(largest, matrix->diag_element(row));
    largest = Utilities::MPI::max(largest, communicator);
    if (!(largest > 1e-6 && largest < 1e18))
      unit = std::ldexp(1., std::ilogb(largest));
    if (unit != 1.)
      *matrix /= unit;
    if (near_null_space.empty())
      near_null_space.resize(1); // data() must not be null

    Teuchos::ParameterList parameters;
    ML_Epetra::SetDefaults("SA", parameters);
    parameters.set("ML output", 0);
    parameters.set("PDE equations", static_cast<int>(dim));
    parameters.set("aggregation: type", "Uncoupled");
    parameters.set("aggregation: threshold", 0.);
    parameters.set("smoother: type", "Chebyshev");
    parameters.set("smoother: sweeps", 2);
    parameters.set("smoother: Chebyshev alpha", 20.);
    parameters.set("coarse: type", "Amesos-KLU");
    parameters.set("coarse: max size", 2000);
    parameters.set("null space: type", "pre-computed");
    parameters.set("null space: dimension", dim == 2 ? 3 : 6);
    parameters.set("null space: vectors", near_null_space.data());
    // ML estimates eigenvalues from random vectors. With a fixed seed, a set-up
    // does not depend on how many set-ups preceded it.
    ML_set_random_seed(
      1 + static_cast<int>(Utilities::MPI::this_mpi_process(communicator)));
    amg->initialize(*matrix, parameters);
  }



  SmoothedAggregation::~SmoothedAggregation() = default;



  void
  SmoothedAggregation::vmult(DistributedVector       &y,
                             const DistributedVector &x) const
  {
    amg->vmult(y, x);
    if (unit != 1.)
      y /= unit;
  }
} // namespace Viscoplastic
