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

  /// A symmetric matrix in dense blocks of nodes, which have `dim` degrees of
  /// freedom each, in compressed rows. Each rank has the rows of its own range
  /// of nodes: the diagonal, the upper triangle, and all columns of other
  /// ranks.
  ///
  /// Nodes have local numbers, those of this rank first, in their order.
  class DistributedMatrix
  {
  public:
    /// The number of a node on all ranks: its first degree of freedom over
    /// their number at a node.
    using Node = types::global_dof_index;

    /// Lists of nodes, one after the other; the nodes of a list couple.
    struct NodeLists
    {
      std::vector<std::size_t> begin{0};
      std::vector<Node>        nodes;
    };

    /// Set to zero, with blocks for the nodes that couple in lists of any rank;
    /// @p owned: the degrees of freedom of this rank. Collective.
    void
    reinit(const IndexSet    &owned,
           const unsigned int dim,
           NodeLists          lists,
           const MPI_Comm     communicator);

    /// The degrees of freedom on all ranks.
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

    /// Owned nodes, and those with columns of other ranks.
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

    /// The degrees of freedom of a node.
    unsigned int
    block_size() const
    {
      return pattern->dim;
    }

    /// The number on all ranks of the node with a local number.
    Node
    global_node(const unsigned int number) const
    {
      return number < pattern->n_owned ?
               pattern->first + number :
               pattern->ghosts[number - pattern->n_owned];
    }

    /// The entry on the diagonal, by the position among the owned degrees of
    /// freedom.
    double
    diagonal(const std::size_t i) const
    {
      return block(i / pattern->dim,
                   pattern->begin[i / pattern->dim])[(i % pattern->dim) *
                                                     (pattern->dim + 1)];
    }

    /// The entry of an owned row; zero outside of the pattern.
    double
    el(const types::global_dof_index i, const types::global_dof_index j) const;

    /// Call act(row, column, block) for each block of owned rows, by local
    /// numbers; @p block is a pointer to dim x dim numbers, row by row.
    template <typename Function>
    void
    for_each_block(const Function &act) const
    {
      for (unsigned int i = 0; i < pattern->n_owned; ++i)
        for (std::size_t e = pattern->begin[i]; e < pattern->begin[i + 1]; ++e)
          act(i, pattern->columns[e], block(i, e));
    }

    /// The whole rows of owned nodes, columns in ascending order of their local
    /// numbers. A block whose column is that of an owned node before the row is
    /// the transpose of what its pointer shows.
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

    /// A block of an owned row.
    struct Place
    {
      unsigned int row;
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

    /// The blocks with a row or a column among these nodes, by local numbers of
    /// columns.
    std::vector<Place>
    blocks_at(const std::vector<bool> &is_chosen) const;

    /// y := A x with these blocks and their transposes alone. Collective.
    void
    vmult(DistributedVector        &y,
          const DistributedVector  &x,
          const std::vector<Place> &places) const;

    /// Entries of owned degrees of freedom at all columns. Collective.
    std::vector<double>
    at_columns(const double *owned) const;

    /// Add a symmetric matrix for these degrees of freedom, node by node; what
    /// is zero need not be in the pattern.
    void
    add(const std::vector<types::global_dof_index> &dofs,
        const FullMatrix<double>                   &matrix);

    void
    add_to_diagonal(const std::size_t i, const double value);

    /// Pass on what has been added to rows of other ranks. Collective.
    void
    compress();

    /// Have rows with the same values share them, if most can, as on uniform
    /// meshes. What is added later takes them apart again.
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
      /// Owned rows, then what this rank adds to those of ghosts; in a row the
      /// columns ascend.
      std::vector<std::size_t>  begin{0};
      std::vector<unsigned int> columns;
      /// Of degrees of freedom.
      std::shared_ptr<const Utilities::MPI::Partitioner> partitioner;
      /// For compress(): where rows of each other rank begin and end here, and
      /// the entries for which it has contributions.
      std::map<unsigned int, std::pair<std::size_t, std::size_t>> to_send;
      std::map<unsigned int, std::vector<std::size_t>>            to_receive;

      unsigned int
      local_number(const Node node) const;

      /// Whether the block is stored, or else its transpose.
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

    /// The block of an entry of an owned row; the diagonal is the first one.
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

    /// Give each row values of its own.
    void
    take_apart();

    std::shared_ptr<const Pattern> pattern;
    std::vector<double>            values;
    /// Where rows share values: the number of their first block among these.
    std::vector<std::size_t> shared_block;
  };
} // namespace Viscoplastic
