// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/linear_solvers/residual_rounding.h>

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
    const std::vector<double> at_columns = matrix.at_columns(u.begin());
    const unsigned int        dim        = matrix.block_size();
    DistributedVector         size(load);
    for (double &entry : size)
      entry = std::abs(entry);
    matrix.for_each_block(
      [&](const unsigned int i, const unsigned int j, const double *block) {
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            {
              const unsigned int row = i * dim + c, column = j * dim + d;
              const double       size_of_entry = std::abs(block[c * dim + d]);
              size.begin()[row] += size_of_entry * std::abs(at_columns[column]);
              if (j != i && j < matrix.n_rows())
                size.begin()[column] +=
                  size_of_entry * std::abs(at_columns[row]);
            }
      });
    size *= std::numeric_limits<double>::epsilon();

    constexpr unsigned int n_samples = 4;
    // The fixed seed makes results reproducible; ranks differ by it.
    std::mt19937 random(1 + load.local_range().first);
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
