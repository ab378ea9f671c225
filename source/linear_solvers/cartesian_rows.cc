// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/linear_solvers/block_rows.h>

#include <Epetra_CrsMatrix.h>
#include <Epetra_Import.h>
#include <Epetra_MultiVector.h>

#include <algorithm>
#include <array>
#include <optional>

namespace Viscoplastic
{
  namespace
  {
    using Node = NodeHierarchy::Node;



    /// Values of owned degrees of freedom for the columns of a matrix.
    /// Collective.
    Epetra_MultiVector
    at_columns(const Epetra_CrsMatrix &K, const Epetra_MultiVector &owned)
    {
      if (K.Importer() == nullptr)
        return owned;
      Epetra_MultiVector result(K.ColMap(), owned.NumVectors());
      result.Import(owned, *K.Importer(), Insert);
      return result;
    }



    /// The direction of each column, as a vector for each of its components:
    /// its owner knows it, and hanging nodes couple rows with nodes that no
    /// cell here has. Collective.
    template <int dim>
    Epetra_MultiVector
    directions_of_columns(const Epetra_CrsMatrix &K,
                          const NodeHierarchy    &hierarchy)
    {
      Epetra_MultiVector owned(K.DomainMap(), dim);
      for (int i = 0; i < owned.MyLength(); ++i)
        owned[i % dim][i] = 1.;
      for (const auto &[node, frame] : hierarchy.frames)
        if (node >= hierarchy.begin && node < hierarchy.end)
          for (unsigned int d = 0; d < dim; ++d)
            for (unsigned int i = 0; i < dim; ++i)
              owned[d][(node - hierarchy.begin) * dim + i] = frame[d][i];
      return at_columns(K, owned);
    }
  } // namespace



  template <int dim>
  BlockRows<dim>
  cartesian_rows(const DistributedMatrix &matrix,
                 const std::vector<bool> &excluded,
                 const NodeHierarchy     &hierarchy,
                 const std::vector<Node> &nodes,
                 const double             unit)
  {
    const Epetra_CrsMatrix &K = matrix.trilinos_matrix();
    Epetra_MultiVector      owned_keep(K.DomainMap(), 1);
    double *const           keep = owned_keep[0];
    for (std::size_t i = 0; i < excluded.size(); ++i)
      keep[i] = excluded[i] ? 0. : 1.;
    const Epetra_MultiVector keep_columns = at_columns(K, owned_keep);
    const double *const      keep_column  = keep_columns[0];
    const bool               has_frames =
      Utilities::MPI::max(hierarchy.frames.empty() ? 0 : 1,
                          matrix.get_mpi_communicator()) == 1;
    std::optional<Epetra_MultiVector> directions;
    if (has_frames)
      directions = directions_of_columns<dim>(K, hierarchy);

    // The node of each column, if it is the first of the node, and where the
    // other ones are: of ghosts in any order.
    const int                         n_columns = K.NumMyCols();
    std::vector<std::array<int, dim>> siblings(n_columns);
    std::vector<Node> first_of(n_columns, numbers::invalid_dof_index);
    for (int c = 0; c < n_columns; ++c)
      {
        const Node dof = K.GCID(c);
        if (dof % dim != 0 || dof / dim >= hierarchy.end_of_mesh)
          continue;
        first_of[c] = dof / dim;
        for (unsigned int j = 0; j < dim; ++j)
          siblings[c][j] = K.LCID(static_cast<int>(dof + j));
      }

    BlockRows<dim>                    rows;
    std::vector<std::pair<Node, int>> order;            // and first column
    std::vector<int>                  place(n_columns); // in the row
    const std::size_t n_entries = K.NumMyNonzeros() / (dim * dim);
    rows.columns.reserve(n_entries);
    rows.values.reserve(n_entries);
    rows.begin.reserve(nodes.size() + 1);
    for (const Node node : nodes)
      {
        const int n = static_cast<int>(node - hierarchy.begin) * dim;
        // Dof by dof of the node, which have the same columns.
        int                       length, *indices;
        std::array<double *, dim> values;
        for (unsigned int i = 0; i < dim; ++i)
          K.ExtractMyRowView(n + i, length, values[i], indices);
        order.clear();
        for (int e = 0; e < length; ++e)
          {
            const int c = indices[e];
            place[c]    = e;
            if (first_of[c] != numbers::invalid_dof_index)
              order.emplace_back(first_of[c], c);
          }
        std::sort(order.begin(), order.end());
        for (const auto &[column, first] : order)
          {
            NodeBlock<dim> block;
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int j = 0; j < dim; ++j)
                {
                  const int c = siblings[first][j];
                  block[i][j] =
                    values[i][place[c]] * keep[n + i] * keep_column[c] / unit;
                }
            if (has_frames)
              {
                NodeBlock<dim> to_cartesian;
                for (unsigned int j = 0; j < dim; ++j)
                  for (unsigned int d = 0; d < dim; ++d)
                    to_cartesian[j][d] = (*directions)[d][siblings[first][j]];
                block            = block * to_cartesian;
                const auto frame = hierarchy.frames.find(node);
                if (frame != hierarchy.frames.end())
                  block = leading_block<dim>(frame->second) * block;
              }
            rows.columns.push_back(column);
            rows.values.push_back(block);
          }
        rows.begin.push_back(rows.columns.size());
      }
    return rows;
  }



  VISCOPLASTIC_INSTANTIATE(cartesian_rows);
} // namespace Viscoplastic
