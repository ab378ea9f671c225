// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/contact/sparse_face_matrix.h>

#include <algorithm>
#include <set>

namespace Viscoplastic
{
  SparseFaceMatrix::SparseFaceMatrix(const ContactLayout &face,
                                     const IndexSet      &numbers,
                                     std::vector<Entry>   entries)
    : FaceMatrix(face)
    , row_begin(face.n_dofs() + 1, 0)
  {
    AssertDimension(numbers.n_elements(), face.n_dofs());
    std::sort(entries.begin(),
              entries.end(),
              [](const Entry &a, const Entry &b) {
                return a.row != b.row ? a.row < b.row : a.column < b.column;
              });
    const auto elsewhere_begin =
      std::stable_partition(entries.begin(),
                            entries.end(),
                            [&numbers](const Entry &entry) {
                              return numbers.is_element(entry.column);
                            });
    columns.reserve(elsewhere_begin - entries.begin());
    values.reserve(elsewhere_begin - entries.begin());
    for (auto entry = entries.begin(); entry != elsewhere_begin; ++entry)
      {
        ++row_begin[entry->row + 1];
        columns.push_back(numbers.index_within_set(entry->column));
        values.push_back(entry->value);
      }
    for (unsigned int i = 0; i < face.n_dofs(); ++i)
      row_begin[i + 1] += row_begin[i];

    if (Utilities::MPI::n_mpi_processes(face.communicator) == 1 ||
        numbers.size() == 0)
      return;
    std::vector<types::global_dof_index> others;
    for (auto entry = elsewhere_begin; entry != entries.end(); ++entry)
      others.push_back(entry->column);
    std::sort(others.begin(), others.end());
    IndexSet ghosts(numbers.size());
    ghosts.add_indices(others.begin(), others.end());
    changes.reinit(numbers, ghosts, face.communicator);
    for (auto entry = elsewhere_begin; entry != entries.end(); ++entry)
      elsewhere.push_back(
        {entry->row,
         changes.get_partitioner()->global_to_local(entry->column),
         entry->value});
    make_stages();
  }



  void
  SparseFaceMatrix::make_stages()
  {
    // Greedy coloring: each rank takes the first stage after the common one
    // that no rank before it has with which it couples.
    std::vector<unsigned int> neighbors;
    for (const auto &[rank, n_entries] :
         changes.get_partitioner()->ghost_targets())
      neighbors.push_back(rank);
    std::vector<unsigned int> stage_of_rank;
    for (const auto &neighbors_of_rank :
         Utilities::MPI::all_gather(face.communicator, neighbors))
      {
        std::set<unsigned int> taken;
        for (const unsigned int neighbor : neighbors_of_rank)
          if (neighbor < stage_of_rank.size())
            taken.insert(stage_of_rank[neighbor]);
        unsigned int stage = 1;
        while (taken.count(stage) > 0)
          ++stage;
        stage_of_rank.push_back(stage);
      }

    std::vector<bool> couples(face.n_dofs(), false);
    for (const Coupling &coupling : elsewhere)
      couples[coupling.row] = true;
    nodes_of_stage.assign(1 + *std::max_element(stage_of_rank.begin(),
                                                stage_of_rank.end()),
                          {});
    const unsigned int own_stage =
      stage_of_rank[Utilities::MPI::this_mpi_process(face.communicator)];
    for (unsigned int node = 0; node < face.n_nodes(); ++node)
      {
        const bool is_inside =
          std::none_of(couples.begin() + face.first_dof[node],
                       couples.begin() + face.first_dof[node + 1],
                       [](const bool entry) { return entry; });
        nodes_of_stage[is_inside ? 0 : own_stage].push_back(node);
      }
  }



  Tensor<2, 3>
  SparseFaceMatrix::diagonal_block(const unsigned int node) const
  {
    Tensor<2, 3>       result;
    const unsigned int first = face.first_dof[node];
    const unsigned int n     = face.n_node_dofs(node);
    for (unsigned int i = 0; i < n; ++i)
      for (std::size_t e = row_begin[first + i]; e < row_begin[first + i + 1];
           ++e)
        if (columns[e] >= first && columns[e] < first + n)
          result[i][columns[e] - first] = values[e];
    pad_block(result, n);
    return result;
  }



  void
  SparseFaceMatrix::subtract(const unsigned int  node,
                             const Tensor<1, 3> &change,
                             Vector<double>     &r) const
  {
    for (unsigned int i = 0; i < face.n_node_dofs(node); ++i)
      {
        const unsigned int row = face.first_dof[node] + i;
        for (std::size_t e = row_begin[row]; e < row_begin[row + 1]; ++e)
          r[columns[e]] -= values[e] * change[i];
      }
  }



  void
  SparseFaceMatrix::subtract_changes_elsewhere(const unsigned int    stage,
                                               const Vector<double> &change,
                                               Vector<double>       &r) const
  {
    // Nodes of the first stage couple with no other rank.
    if (stage == 0)
      return;
    changes.zero_out_ghost_values();
    std::copy(change.begin(), change.end(), changes.begin());
    changes.update_ghost_values();
    for (const Coupling &coupling : elsewhere)
      r[coupling.row] -=
        coupling.value * changes.local_element(coupling.column);
  }
} // namespace Viscoplastic
