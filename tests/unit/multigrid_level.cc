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



  TYPED_TEST(Smoother, ProductWithInterpolationsKeepsRowsThatItDoesNotChange)
  {
    // A row of nodes on each rank, the second one of which lies between the
    // first and the third. The fourth is coupled with it, those behind are with
    // coarse nodes only.
    constexpr int                    dim     = TypeParam::value;
    const unsigned int               n_nodes = 7, middle = 1;
    std::vector<NodeHierarchy::Node> begins, nodes, coarse;
    const unsigned int rank = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
    for (unsigned int r = 0;
         r <= Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
         ++r)
      begins.push_back(n_nodes * r);
    BlockRows<dim>                   A;
    Interpolation                    P;
    const NodeHierarchy::Node        first = begins[rank];
    std::vector<std::vector<double>> weights(n_nodes,
                                             std::vector<double>(n_nodes));
    const auto block = [](const unsigned int i, const unsigned int j) {
      NodeBlock<dim> result;
      for (unsigned int c = 0; c < dim && std::max(i, j) <= std::min(i, j) + 2;
           ++c)
        for (unsigned int d = 0; d < dim; ++d)
          result[c][d] = 1. + i + 3. * j + 0.5 * c + 0.25 * d;
      return result;
    };
    for (unsigned int i = 0; i < n_nodes; ++i)
      {
        nodes.push_back(first + i);
        for (unsigned int j = i < 2 ? 0 : i - 2; j < std::min(i + 3, n_nodes);
             ++j)
          {
            A.columns.push_back(first + j);
            A.values.push_back(block(i, j));
          }
        A.begin.push_back(A.columns.size());
        if (i == middle)
          {
            P.parents.push_back({first + i - 1, 0.5});
            P.parents.push_back({first + i + 1, 0.5});
            weights[i][i - 1] = weights[i][i + 1] = 0.5;
          }
        else
          {
            coarse.push_back(first + i);
            P.parents.push_back({first + i, 1.});
            weights[i][i] = 1.;
          }
        P.begin.push_back(P.parents.size());
      }
    const BlockRows<dim> product =
      galerkin_product(A, nodes, {}, P, coarse, begins, MPI_COMM_WORLD);
    ASSERT_EQ(product.n_rows(), coarse.size());
    for (unsigned int row = 0; row < coarse.size(); ++row)
      for (const auto column : coarse)
        {
          NodeBlock<dim> expected, found;
          for (unsigned int i = 0; i < n_nodes; ++i)
            for (unsigned int j = 0; j < n_nodes; ++j)
              expected += weights[i][coarse[row] - first] * block(i, j) *
                          weights[j][column - first];
          for (auto e = product.begin[row]; e < product.begin[row + 1]; ++e)
            if (product.columns[e] == column)
              found = product.values[e];
          EXPECT_EQ(found, expected) << coarse[row] << ", " << column;
        }
  }
} // namespace
