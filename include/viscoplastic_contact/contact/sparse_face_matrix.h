// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/index_set.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <viscoplastic_contact/contact/face_matrix.h>

namespace Viscoplastic
{
  /// A face matrix in compressed rows: couplings of face unknowns at fixed
  /// bulk.
  ///
  /// The first stage of a sweep has the nodes that couple with none of another
  /// rank. The others follow rank by rank; ranks that do not couple with each
  /// other share a stage.
  class SparseFaceMatrix : public FaceMatrix
  {
  public:
    /// A matrix entry: `row` is an index of face vectors of this rank, `column`
    /// is counted over all ranks.
    struct Entry
    {
      unsigned int            row;
      types::global_dof_index column;
      double                  value;
    };

    /// @p numbers: the numbers of this rank's face entries over all ranks, a
    /// range; @p entries: in any order, each pair once. Collective.
    SparseFaceMatrix(const ContactLayout &face,
                     const IndexSet      &numbers,
                     std::vector<Entry>   entries);

    Tensor<2, 3>
    diagonal_block(const unsigned int node) const override;

    void
    subtract(const unsigned int  node,
             const Tensor<1, 3> &change,
             Vector<double>     &r) const override;

    void
    subtract_changes_elsewhere(const unsigned int    stage,
                               const Vector<double> &change,
                               Vector<double>       &r) const override;

  private:
    /// Divide nodes into stages such that after the first one, ranks that
    /// couple never share a stage.
    void
    make_stages();

    /// A coupling with an entry that another rank owns; `column` is its local
    /// index in `changes`.
    struct Coupling
    {
      unsigned int row, column;
      double       value;
    };

    std::vector<std::size_t>  row_begin;
    std::vector<unsigned int> columns;
    std::vector<double>       values;
    std::vector<Coupling>     elsewhere;
    /// The changes of this rank's entries in a stage, and of coupled ghosts.
    mutable LinearAlgebra::distributed::Vector<double> changes;
  };
} // namespace Viscoplastic
