// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/linear_solvers/block_rows.h>

#include <Epetra_CrsMatrix.h>
#include <Epetra_Import.h>
#include <Epetra_MultiVector.h>
#include <Epetra_Vector.h>

#include <algorithm>
#include <array>
#include <memory>

namespace Viscoplastic
{
  namespace
  {
    using Node = NodeHierarchy::Node;
  }



  template <int dim>
  BlockRows<dim>
  cartesian_rows(const DistributedMatrix &matrix,
                 const std::vector<bool> &excluded,
                 const NodeHierarchy     &hierarchy,
                 const std::vector<Node> &nodes,
                 const double             unit)
  {
    const Epetra_CrsMatrix &K = matrix.trilinos_matrix();
    Epetra_Vector           keep(K.DomainMap());
    for (std::size_t i = 0; i < excluded.size(); ++i)
      keep[i] = excluded[i] ? 0. : 1.;
    Epetra_Vector keep_column(K.ColMap());
    if (K.Importer() != nullptr)
      keep_column.Import(keep, *K.Importer(), Insert);
    else
      keep_column = keep;
    // Where frames are rotated: the direction of each column. The owner knows
    // it; hanging nodes couple rows with nodes that no cell here has.
    const bool has_frames =
      Utilities::MPI::max(hierarchy.frames.empty() ? 0 : 1,
                          matrix.get_mpi_communicator()) == 1;
    std::unique_ptr<Epetra_MultiVector> directions;
    if (has_frames)
      {
        Epetra_MultiVector owned(K.DomainMap(), dim);
        for (std::size_t i = 0; i < excluded.size(); ++i)
          owned[i % dim][i] = 1.;
        for (const auto &[node, frame] : hierarchy.frames)
          if (node >= hierarchy.begin && node < hierarchy.end)
            for (unsigned int d = 0; d < dim; ++d)
              for (unsigned int i = 0; i < dim; ++i)
                owned[d][(node - hierarchy.begin) * dim + i] = frame[d][i];
        directions = std::make_unique<Epetra_MultiVector>(K.ColMap(), dim);
        if (K.Importer() != nullptr)
          directions->Import(owned, *K.Importer(), Insert);
        else
          *directions = owned;
      }

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
