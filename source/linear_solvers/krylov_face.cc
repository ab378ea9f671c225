// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/linear_solvers/krylov_solver.h>

#include <Epetra_CrsMatrix.h>
#include <Epetra_Import.h>
#include <Epetra_IntVector.h>
#include <Epetra_Vector.h>

// The rows of the matrix that belong to the face.

namespace Viscoplastic
{
  void
  KrylovSolver::make_face_matrix()
  {
    // Which columns are entries of the face, on whatever rank.
    const Epetra_CrsMatrix &K    = matrix.trilinos_matrix();
    constexpr int           none = -1;
    Epetra_IntVector        number(K.DomainMap());
    number.PutValue(none);
    for (unsigned int k = 0; k < face.n_dofs(); ++k)
      number[restriction.positions()[k]] =
        restriction.global_numbers().nth_index_in_set(k);
    Epetra_IntVector number_of_column(K.ColMap());
    if (K.Importer() != nullptr)
      number_of_column.Import(number, *K.Importer(), Insert);
    else
      number_of_column = number;

    // Not by the iterators of the matrix, each of which fills a vector of the
    // size of the whole matrix.
    std::vector<SparseFaceMatrix::Entry> entries;
    for (unsigned int k = 0; k < face.n_dofs(); ++k)
      {
        int     length, *indices;
        double *values;
        K.ExtractMyRowView(restriction.positions()[k], length, values, indices);
        for (int e = 0; e < length; ++e)
          if (number_of_column[indices[e]] != none)
            entries.push_back({k,
                               static_cast<types::global_dof_index>(
                                 number_of_column[indices[e]]),
                               values[e]});
      }
    sparse_face_matrix =
      std::make_unique<SparseFaceMatrix>(face,
                                         restriction.global_numbers(),
                                         std::move(entries));
  }



  void
  KrylovSolver::multiply_face(const Vector<double> &x,
                              DistributedVector    &y) const
  {
    // The rows of the face are its columns.
    const Epetra_CrsMatrix      &K = matrix.trilinos_matrix();
    std::optional<Epetra_Vector> on_columns;
    if (K.Importer() != nullptr)
      on_columns.emplace(K.ColMap());
    y                = 0.;
    double *const to = on_columns ? on_columns->Values() : y.begin();
    for (unsigned int k = 0; k < x.size(); ++k)
      if (x[k] != 0.)
        {
          int     length, *indices;
          double *values;
          K.ExtractMyRowView(restriction.positions()[k],
                             length,
                             values,
                             indices);
          for (int e = 0; e < length; ++e)
            to[indices[e]] += x[k] * values[e];
        }
    if (on_columns)
      y.trilinos_vector().Export(*on_columns, *K.Importer(), Add);
  }
} // namespace Viscoplastic
