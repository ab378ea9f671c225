// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/linear_solvers/residual_rounding.h>

#include <Epetra_Import.h>
#include <Epetra_Vector.h>

#include <cmath>
#include <limits>
#include <random>

namespace Viscoplastic
{
  double
  rounding_of_residual(
    const DistributedMatrix                          &matrix,
    const DistributedVector                          &load,
    const DistributedVector                          &u,
    const std::function<double(DistributedVector &)> &squared_norm)
  {
    const Epetra_CrsMatrix &K = matrix.trilinos_matrix();
    Epetra_Vector           values_of_columns(K.ColMap());
    if (K.Importer() != nullptr)
      values_of_columns.Import(u.trilinos_vector(), *K.Importer(), Insert);
    else
      values_of_columns = *u.trilinos_vector()(0);
    DistributedVector size(load);
    for (int i = 0; i < K.NumMyRows(); ++i)
      {
        int     length, *columns;
        double *values;
        K.ExtractMyRowView(i, length, values, columns);
        double sum = std::abs(load.begin()[i]);
        for (int e = 0; e < length; ++e)
          sum += std::abs(values[e] * values_of_columns[columns[e]]);
        size.begin()[i] = std::numeric_limits<double>::epsilon() * sum;
      }

    constexpr unsigned int n_samples = 4;
    // The same signs again and again; others on each rank.
    std::mt19937 random(1 + matrix.local_range().first);
    double       mean = 0.;
    for (unsigned int sample = 0; sample < n_samples; ++sample)
      {
        DistributedVector error(size);
        for (double &entry : error)
          if (random() % 2 == 0)
            entry = -entry;
        mean += squared_norm(error) / n_samples;
      }
    return std::sqrt(mean);
  }
} // namespace Viscoplastic
