// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/linear_algebra.h>
#include <viscoplastic_contact/linear_solvers/block_rows.h>

namespace Viscoplastic
{
  namespace
  {
    /// Return the direction of each column, one vector for each of its
    /// components. Owners send directions, since hanging-node constraints
    /// couple rows with nodes that no cell of this rank has. Collective.
    template <int dim>
    std::vector<std::vector<double>>
    directions_of_columns(const DistributedMatrix &matrix,
                          const NodeHierarchy     &hierarchy)
    {
      std::vector<std::vector<double>> result;
      for (unsigned int d = 0; d < dim; ++d)
        {
          std::vector<double> owned(matrix.n_rows() * dim);
          for (std::size_t i = d; i < owned.size(); i += dim)
            owned[i] = 1.;
          for (const auto &[node, frame] : hierarchy.frames)
            if (node >= hierarchy.begin && node < hierarchy.end)
              for (unsigned int i = 0; i < dim; ++i)
                owned[(node - hierarchy.begin) * dim + i] = frame[d][i];
          result.push_back(matrix.at_columns(owned.data()));
        }
      return result;
    }
  } // namespace



  template <int dim>
  BlockRows<dim>
  cartesian_rows(const DistributedMatrix                &matrix,
                 const std::vector<bool>                &excluded,
                 const NodeHierarchy                    &hierarchy,
                 const std::vector<NodeHierarchy::Node> &nodes,
                 const double                            unit)
  {
    std::vector<double> keep(excluded.size());
    for (std::size_t i = 0; i < excluded.size(); ++i)
      keep[i] = excluded[i] ? 0. : 1.;
    keep = matrix.at_columns(keep.data());
    std::vector<std::vector<double>> directions;
    if (Utilities::MPI::max(hierarchy.frames.empty() ? 0 : 1,
                            matrix.get_mpi_communicator()) == 1)
      directions = directions_of_columns<dim>(matrix, hierarchy);
    const auto directions_at = [&](const unsigned int node) {
      NodeBlock<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int i = 0; i < dim; ++i)
          result[d][i] = directions[d][node * dim + i];
      return result;
    };

    const DistributedMatrix::WholeRows whole = matrix.whole_rows();
    BlockRows<dim>                     rows;
    rows.columns.reserve(whole.columns.size());
    rows.values.reserve(whole.columns.size());
    rows.begin.reserve(nodes.size() + 1);
    for (const NodeHierarchy::Node node : nodes)
      {
        const unsigned int i = node - hierarchy.begin;
        for (std::size_t e = whole.begin[i]; e < whole.begin[i + 1]; ++e)
          {
            const unsigned int        j      = whole.columns[e];
            const NodeHierarchy::Node column = matrix.global_node(j);
            if (column >= hierarchy.end_of_mesh)
              continue;
            NodeBlock<dim> block;
            for (unsigned int c = 0; c < dim; ++c)
              for (unsigned int d = 0; d < dim; ++d)
                block[c][d] =
                  whole.blocks[e][j < i ? d * dim + c : c * dim + d] *
                  keep[i * dim + c] * keep[j * dim + d] / unit;
            if (!directions.empty())
              block = directions_at(i) * block * transpose(directions_at(j));
            rows.columns.push_back(column);
            rows.values.push_back(block);
          }
        rows.begin.push_back(rows.columns.size());
      }
    return rows;
  }



  VISCOPLASTIC_INSTANTIATE(cartesian_rows);
} // namespace Viscoplastic
