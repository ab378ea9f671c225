// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/partitioner.h>
#include <deal.II/lac/full_matrix.h>

#include <viscoplastic_contact/base/types.h>

#include <map>
#include <memory>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /// A symmetric matrix of dense blocks, one for each pair of coupled nodes
  /// with `dim` degrees of freedom each, in compressed row storage. Each rank
  /// stores the rows of its own range of nodes: the diagonal, the upper
  /// triangle, and all columns of nodes of other ranks.
  ///
  /// Nodes have local numbers: first owned nodes in global order, then ghosts.
  class DistributedMatrix
  {
  public:
    /// The global number of a node: its first degree of freedom over `dim`.
    using Node = types::global_dof_index;

    /// Lists of nodes in compressed storage; all nodes of a list couple.
    struct NodeLists
    {
      std::vector<std::size_t> begin{0};
      std::vector<Node>        nodes;
    };

    /// Set the matrix to zero, with blocks for the nodes that couple in lists
    /// of any rank. @p owned: the degrees of freedom of this rank. Collective.
    void
    reinit(const IndexSet    &owned,
           const unsigned int dim,
           NodeLists          lists,
           const MPI_Comm     communicator);

    /// The global number of degrees of freedom.
    types::global_dof_index
    m() const
    {
      return pattern->partitioner->size();
    }

    const IndexSet &
    locally_owned_range_indices() const
    {
      return pattern->partitioner->locally_owned_range();
    }

    MPI_Comm
    get_mpi_communicator() const
    {
      return pattern->partitioner->get_mpi_communicator();
    }

    /// The numbers of owned nodes, and of owned and ghost nodes.
    unsigned int
    n_rows() const
    {
      return pattern->n_owned;
    }
    unsigned int
    n_columns() const
    {
      return pattern->n_owned + pattern->ghosts.size();
    }

    /// The number of degrees of freedom of a node.
    unsigned int
    block_size() const
    {
      return pattern->dim;
    }

    /// The global number of the node with a local number.
    Node
    global_node(const unsigned int number) const
    {
      return number < pattern->n_owned ?
               pattern->first + number :
               pattern->ghosts[number - pattern->n_owned];
    }

    /// The diagonal entry of the i-th owned degree of freedom.
    double
    diagonal(const std::size_t i) const
    {
      return block(i / pattern->dim,
                   pattern->begin[i / pattern->dim])[(i % pattern->dim) *
                                                     (pattern->dim + 1)];
    }

    /// The entry of an owned row; zero outside of the sparsity pattern.
    double
    el(const types::global_dof_index i, const types::global_dof_index j) const;

    /// Call act(row, column, block) for each stored block of owned rows, with
    /// local numbers; @p block points to dim x dim numbers in row-major order.
    template <typename Function>
    void
    for_each_block(const Function &act) const
    {
      for (unsigned int i = 0; i < pattern->n_owned; ++i)
        for (std::size_t e = pattern->begin[i]; e < pattern->begin[i + 1]; ++e)
          act(i, pattern->columns[e], block(i, e));
    }

    /// The rows of owned nodes with both triangles, columns in ascending order
    /// of their local numbers. Where the column is less than the row, the
    /// pointer shows the transpose of the block.
    struct WholeRows
    {
      std::vector<std::size_t>    begin;
      std::vector<unsigned int>   columns;
      std::vector<const double *> blocks;
    };
    WholeRows
    whole_rows() const;

    /// y := A x for owned entries. Collective.
    void
    vmult(DistributedVector &y, const DistributedVector &x) const;

    /// A stored block of an owned row, by its position in the pattern, and
    /// whether row and column are chosen, see blocks_at().
    struct Place
    {
      unsigned int row;
      bool         row_is_chosen, column_is_chosen;
      std::size_t  entry;
    };
    unsigned int
    column(const Place &place) const
    {
      return pattern->columns[place.entry];
    }
    const double *
    block(const Place &place) const
    {
      return block(place.row, place.entry);
    }

    /// Return the stored blocks whose row or column is chosen; @p is_chosen is
    /// indexed by the local numbers of columns.
    std::vector<Place>
    blocks_at(const std::vector<bool> &is_chosen) const;

    /// y := y + A x for an x that is zero but at the nodes chosen for @p
    /// places; other entries of @p x are not read. Collective.
    void
    vmult_add(DistributedVector        &y,
              const DistributedVector  &x,
              const std::vector<Place> &places) const;

    /// Return the owned entries of a vector, then those of ghosts. Collective.
    std::vector<double>
    at_columns(const double *owned) const;

    /// Add a symmetric matrix for these degrees of freedom, which are ordered
    /// node by node; zero entries need not be in the pattern.
    void
    add(const std::vector<types::global_dof_index> &dofs,
        const FullMatrix<double>                   &matrix);

    void
    add_to_diagonal(const std::size_t i, const double value);

    /// Send contributions to rows of other ranks to their owners. Collective.
    void
    compress();

    /// Store rows with the same values only once if that halves the storage, as
    /// on uniform meshes. Later additions undo the sharing.
    void
    share_rows();

  private:
    static constexpr std::size_t no_entry = -1;

    struct Pattern
    {
      unsigned int              dim, n_owned;
      Node                      first;
      std::vector<Node>         ghosts; // ascending
      std::vector<unsigned int> owner_of_ghost;
      /// Where the rows begin: owned rows, then the contributions of this rank
      /// to rows of ghosts. The columns of a row ascend.
      std::vector<std::size_t>  begin{0};
      std::vector<unsigned int> columns;
      /// The owned and ghost degrees of freedom.
      std::shared_ptr<const Utilities::MPI::Partitioner> partitioner;
      /// For compress(): the range of entries of this rank that go to each
      /// other rank, and the entries to which those received are added.
      std::map<unsigned int, std::pair<std::size_t, std::size_t>> to_send;
      std::map<unsigned int, std::vector<std::size_t>>            to_receive;

      unsigned int
      local_number(const Node node) const;

      /// Whether this block is stored, rather than its transpose.
      bool
      has(const unsigned int row, const unsigned int column) const;

      std::size_t
      find(const unsigned int row, const unsigned int column) const;

      void
      add_rows(const NodeLists &lists, const std::size_t n_own_lists);

      void
      make_exchange();
    };

    std::size_t
    n_entries_of_block() const
    {
      return pattern->dim * pattern->dim;
    }

    /// The block of an entry of an owned row; the first one is the diagonal.
    const double *
    block(const unsigned int row, const std::size_t entry) const
    {
      return &values[(first_block()[row] + entry - pattern->begin[row]) *
                     n_entries_of_block()];
    }

    const std::vector<std::size_t> &
    first_block() const
    {
      return shared_block.empty() ? pattern->begin : shared_block;
    }

    /// Undo share_rows(): give each row its own values.
    void
    take_apart();

    std::shared_ptr<const Pattern> pattern;
    std::vector<double>            values;
    /// If rows are shared: the index of each row's first block in `values`.
    std::vector<std::size_t> shared_block;
  };
} // namespace Viscoplastic
