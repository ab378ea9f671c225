// SPDX-License-Identifier: LGPL-2.1-or-later

// The matrix in blocks of nodes: what ranks add to rows of each other, and
// products with its upper triangle.

#include <deal.II/base/mpi.h>
#include <deal.II/lac/vector.h>

#include "body.h"
#include <viscoplastic_contact/base/linear_algebra.h>

#include <set>

namespace
{
  using namespace dealii;
  using namespace Viscoplastic;
  using namespace Viscoplastic::Testing;

  template <typename Dimension>
  class DistributedMatrixTest : public testing::Test
  {};
  TYPED_TEST_SUITE(DistributedMatrixTest, Dimensions, );



  /// A sum of small matrices for lists of nodes, dealt out to the ranks
  /// regardless of who owns the nodes, and the same matrix as a whole.
  template <int dim>
  struct Sum
  {
    static constexpr unsigned int n_nodes = 23, n = n_nodes * dim;

    Sum()
      : rank(Utilities::MPI::this_mpi_process(MPI_COMM_WORLD))
      , n_ranks(Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD))
      , owned(n)
      , expected(n, n)
    {
      owned.add_range(n_nodes * rank / n_ranks * dim,
                      n_nodes * (rank + 1) / n_ranks * dim);
      DistributedMatrix::NodeLists lists;
      for (unsigned int l = rank; l < n_nodes; l += n_ranks)
        {
          const std::set<unsigned int> nodes = list(l);
          lists.nodes.insert(lists.nodes.end(), nodes.begin(), nodes.end());
          lists.begin.push_back(lists.nodes.size());
        }
      matrix.reinit(owned, dim, lists, MPI_COMM_WORLD);
      for (unsigned int l = 0; l < n_nodes; ++l)
        {
          std::vector<types::global_dof_index> dofs;
          for (const unsigned int node : list(l))
            for (unsigned int d = 0; d < dim; ++d)
              dofs.push_back(node * dim + d);
          FullMatrix<double> values(dofs.size(), dofs.size());
          for (unsigned int i = 0; i < dofs.size(); ++i)
            for (unsigned int j = 0; j < dofs.size(); ++j)
              values(i, j) = std::sin(l + i + j) + std::cos(i * j);
          for (unsigned int i = 0; i < dofs.size(); ++i)
            for (unsigned int j = 0; j < dofs.size(); ++j)
              expected(dofs[i], dofs[j]) += values(i, j);
          if (l % n_ranks == rank)
            matrix.add(dofs, values);
        }
      matrix.compress();
    }

    static std::set<unsigned int>
    list(const unsigned int l)
    {
      return {l, (l + 1) % n_nodes, (5 * l + 3) % n_nodes};
    }

    /// The largest difference to products with @p other.
    double
    distance(const FullMatrix<double>                    &other,
             const std::vector<DistributedMatrix::Place> *places) const
    {
      DistributedVector x(owned, MPI_COMM_WORLD), y(x);
      Vector<double>    all(n), product(n);
      for (unsigned int i = 0; i < n; ++i)
        all[i] = std::sin(3. * i);
      other.vmult(product, all);
      for (const auto i : owned)
        x.begin()[owned.index_within_set(i)] = all[i];
      if (places != nullptr)
        matrix.vmult_add(y, x, *places);
      else
        {
          y = 7.;
          matrix.vmult(y, x);
        }
      double result = 0.;
      for (const auto i : owned)
        result =
          std::max(result,
                   std::abs(y.begin()[owned.index_within_set(i)] - product[i]));
      return Utilities::MPI::max(result, MPI_COMM_WORLD);
    }

    const unsigned int rank, n_ranks;
    IndexSet           owned;
    DistributedMatrix  matrix;
    FullMatrix<double> expected;
  };



  TYPED_TEST(DistributedMatrixTest, HasWhatAllRanksAdd)
  {
    constexpr int  dim = TypeParam::value;
    const Sum<dim> sum;
    for (const auto i : sum.owned)
      for (unsigned int j = 0; j < sum.n; ++j)
        EXPECT_NEAR(sum.matrix.el(i, j), sum.expected(i, j), 1e-14)
          << i << ' ' << j;
    const auto rows   = sum.matrix.whole_rows();
    double     square = 0.;
    for (unsigned int i = 0; i < sum.matrix.n_rows(); ++i)
      {
        EXPECT_EQ(sum.matrix.diagonal(i * dim + 1),
                  sum.matrix.el(sum.matrix.global_node(i) * dim + 1,
                                sum.matrix.global_node(i) * dim + 1));
        for (std::size_t e = rows.begin[i]; e < rows.begin[i + 1]; ++e)
          {
            const unsigned int j = rows.columns[e];
            for (unsigned int c = 0; c < dim; ++c)
              for (unsigned int d = 0; d < dim; ++d)
                square += Utilities::fixed_power<2>(
                  rows.blocks[e][j < i ? d * dim + c : c * dim + d] -
                  sum.expected(sum.matrix.global_node(i) * dim + c,
                               sum.matrix.global_node(j) * dim + d));
          }
      }
    EXPECT_LT(square, 1e-24);
  }



  TYPED_TEST(DistributedMatrixTest, MultipliesBySomeOrAllBlocks)
  {
    constexpr int  dim = TypeParam::value;
    const Sum<dim> sum;
    EXPECT_LT(sum.distance(sum.expected, nullptr), 1e-13);
    const auto is_chosen = [](const unsigned int node) {
      return node % 4 == 1;
    };
    std::vector<bool> chosen;
    for (unsigned int i = 0; i < sum.matrix.n_columns(); ++i)
      chosen.push_back(is_chosen(sum.matrix.global_node(i)));
    FullMatrix<double> part(sum.expected);
    for (unsigned int i = 0; i < sum.n; ++i)
      for (unsigned int j = 0; j < sum.n; ++j)
        if (!is_chosen(j / dim))
          part(i, j) = 0.;
    const auto places = sum.matrix.blocks_at(chosen);
    EXPECT_LT(sum.distance(part, &places), 1e-13);
  }



  TYPED_TEST(DistributedMatrixTest, EqualRowsShareValues)
  {
    // A chain with a spring at one end.
    constexpr int      dim     = TypeParam::value;
    const unsigned int n_nodes = 60, n_links = n_nodes - 1;
    const unsigned int rank = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD),
                       n_ranks =
                         Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
    IndexSet owned(n_nodes * dim);
    owned.add_range(n_nodes * rank / n_ranks * dim,
                    n_nodes * (rank + 1) / n_ranks * dim);
    DistributedMatrix::NodeLists lists;
    FullMatrix<double>           link(2 * dim, 2 * dim);
    for (unsigned int i = 0; i < 2 * dim; ++i)
      for (unsigned int j = 0; j < 2 * dim; ++j)
        link(i, j) = std::sin(i + j) + 1. / 3.;
    std::vector<std::vector<types::global_dof_index>> dofs_of_links;
    for (unsigned int l = 0; l < n_links; ++l)
      if (owned.is_element(l * dim))
        {
          lists.nodes.insert(lists.nodes.end(), {l, l + 1});
          lists.begin.push_back(lists.nodes.size());
          dofs_of_links.emplace_back();
          for (unsigned int i = 0; i < 2 * dim; ++i)
            dofs_of_links.back().push_back(l * dim + i);
        }
    DistributedMatrix matrix;
    matrix.reinit(owned, dim, lists, MPI_COMM_WORLD);
    for (const auto &dofs : dofs_of_links)
      matrix.add(dofs, link);
    // A row that differs from others in its last entry alone.
    FullMatrix<double> last(2 * dim, 2 * dim);
    last(dim - 1, 2 * dim - 1) = last(2 * dim - 1, dim - 1) = 1.;
    if (dofs_of_links.size() > 5)
      matrix.add(dofs_of_links[5], last);
    matrix.compress();
    if (owned.is_element(0))
      matrix.add_to_diagonal(0, 7.);
    DistributedMatrix shared(matrix);
    shared.share_rows();

    std::set<const double *> blocks;
    std::size_t              n_blocks = 0;
    shared.for_each_block([&](unsigned int, unsigned int, const double *block) {
      ++n_blocks;
      blocks.insert(block);
    });
    EXPECT_LE(blocks.size(), 10);
    EXPECT_GE(n_blocks, 2 * owned.n_elements() / dim - 1);
    const auto expect_equal = [&] {
      DistributedVector x(owned, MPI_COMM_WORLD), y(x), z(x);
      for (const auto i : owned)
        x.begin()[owned.index_within_set(i)] = std::sin(3. * i);
      matrix.vmult(y, x);
      shared.vmult(z, x);
      y -= z;
      EXPECT_EQ(y.linfty_norm(), 0.);
      for (unsigned int i = 0; i < owned.n_elements(); ++i)
        EXPECT_EQ(shared.diagonal(i), matrix.diagonal(i));
      for (const auto i : owned)
        for (unsigned int j = 0; j < n_nodes * dim; ++j)
          EXPECT_EQ(shared.el(i, j), matrix.el(i, j));
      const std::vector<bool> all(shared.n_columns(), true);
      y = z;
      matrix.vmult_add(y, x, matrix.blocks_at(all));
      shared.vmult_add(z, x, shared.blocks_at(all));
      y -= z;
      EXPECT_EQ(y.linfty_norm(), 0.);
    };
    expect_equal();
    for (DistributedMatrix *const either : {&matrix, &shared})
      {
        if (!dofs_of_links.empty())
          either->add(dofs_of_links.back(), link);
        either->compress();
        either->add_to_diagonal(3, 2.);
      }
    expect_equal();
  }
} // namespace
