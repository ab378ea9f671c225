// SPDX-License-Identifier: LGPL-2.1-or-later

// A level of geometric multigrid by itself.

#include "body.h"
#include <viscoplastic_contact/linear_solvers/multigrid_level.h>

#include <limits>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  template <typename Dimension>
  class Smoother : public testing::Test
  {};
  TYPED_TEST_SUITE(Smoother, Dimensions, );



  /// A few nodes on each rank, all of them coupled with each other: the matrix
  /// is the identity plus a matrix of ones.
  template <int dim>
  struct CoupledNodes
  {
    CoupledNodes()
    {
      const unsigned int rank =
        Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
      for (unsigned int r = 0;
           r <= Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
           ++r)
        begins.push_back(8 * r);
      for (auto row = begins[rank]; row < begins[rank + 1]; ++row)
        {
          nodes.push_back(row);
          for (NodeHierarchy::Node column = 0; column < begins.back(); ++column)
            {
              matrix.columns.push_back(column);
              NodeBlock<dim> block;
              for (unsigned int i = 0; i < dim; ++i)
                for (unsigned int j = 0; j < dim; ++j)
                  block[i][j] = 1. + (row == column && i == j ? 1. : 0.);
              matrix.values.push_back(block);
            }
          matrix.begin.push_back(matrix.columns.size());
        }
    }

    std::vector<NodeHierarchy::Node> begins, nodes;
    BlockRows<dim>                   matrix;
  };



  TYPED_TEST(Smoother, LowersTheEnergyOfErrorsThatOnlyRanksCouple)
  {
    // If blocks lacked the couplings of ranks, or half of them, constant errors
    // would grow on two and more ranks.
    constexpr int           dim = TypeParam::value;
    const CoupledNodes<dim> coupled;
    MultigridLevel<dim>     level(
      coupled.matrix, coupled.nodes, {}, coupled.begins, MPI_COMM_WORLD);
    for (unsigned int i = 0; i < coupled.nodes.size(); ++i)
      level.set_inverse_block(i, invert(level.smoothing_block(i)));

    // The solution is zero, so x is minus the error.
    auto                                      &x = level.x, &r = level.r;
    const typename MultigridLevel<dim>::Vector zero(x);
    typename MultigridLevel<dim>::Vector       correction(x);
    for (unsigned int i = 0; i < coupled.nodes.size() * dim; ++i)
      x.begin()[i] = 1.f + 0.1f * (i % 3);
    double energy = std::numeric_limits<double>::max();
    for (unsigned int n = 0; n < 20; ++n)
      {
        level.residual(r, x, zero);
        const double last = energy;
        energy            = -(r * x);
        EXPECT_LT(energy, last) << "sweep " << n;
        level.smooth_forward_from_zero(correction, r);
        level.smooth_backward(correction, r);
        x += correction;
      }
  }
} // namespace
