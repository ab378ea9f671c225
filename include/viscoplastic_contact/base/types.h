// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/trilinos_sparse_matrix.h>
#include <deal.II/lac/trilinos_vector.h>

/**
 * Quasi-static frictional contact of elastic-viscoplastic bodies after Chen,
 * Han, Sofonea, SIAM J. Numer. Anal. 38(4), 2000. Numbers in round brackets
 * in the documentation are equations of that paper.
 */
namespace Viscoplastic
{
  using DistributedVector = dealii::TrilinosWrappers::MPI::Vector;
  using DistributedMatrix = dealii::TrilinosWrappers::SparseMatrix;
} // namespace Viscoplastic
