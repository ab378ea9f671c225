// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/linear_solvers/krylov_solver.h>

// The rows of the matrix that belong to the face.

namespace Viscoplastic
{
  void
  KrylovSolver::make_face_matrix()
  {
    // The global number of the face entry of each column, on any rank.
    const unsigned int  n_rows = matrix.n_rows(), dim = matrix.block_size();
    constexpr double    none = -1.;
    std::vector<double> number(n_rows * dim, none);
    const IndexSet     &numbers = restriction.global_numbers();
    for (unsigned int k = 0; k < face.n_dofs(); ++k)
      number[restriction.positions()[k]] = numbers.nth_index_in_set(k);
    number = matrix.at_columns(number.data());
    std::vector<bool> is_on_face(matrix.n_columns(), false);
    for (std::size_t i = 0; i < number.size(); ++i)
      if (number[i] != none)
        is_on_face[i / dim] = true;

    face_blocks = matrix.blocks_at(is_on_face);
    std::vector<SparseFaceMatrix::Entry> entries;
    const auto add = [&](const double row, const double column, double value) {
      if (row != none && column != none)
        entries.push_back({static_cast<unsigned int>(numbers.index_within_set(
                             static_cast<unsigned int>(row))),
                           static_cast<types::global_dof_index>(column),
                           value});
    };
    for (const DistributedMatrix::Place &place : face_blocks)
      {
        const unsigned int j      = matrix.column(place);
        const double      *values = matrix.block(place);
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            {
              const double row    = number[place.row * dim + c],
                           column = number[j * dim + d];
              add(row, column, values[c * dim + d]);
              if (j != place.row && j < n_rows)
                add(column, row, values[c * dim + d]);
            }
      }
    sparse_face_matrix =
      std::make_unique<SparseFaceMatrix>(face, numbers, std::move(entries));
  }
} // namespace Viscoplastic
