// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace dealii
{
  namespace TrilinosWrappers
  {
    class SparseMatrix;
    namespace MPI
    {
      class Vector;
    }
  } // namespace TrilinosWrappers
} // namespace dealii

/**
 * Quasi-static frictional contact of elastic-viscoplastic bodies after Chen,
 * Han, Sofonea, SIAM J. Numer. Anal. 38(4), 2000. Numbers in round brackets
 * in the documentation are equations of that paper.
 */
namespace Viscoplastic
{
  // Declared only: their headers are heavy, and rooms that see nothing of
  // linear algebra but references do without. See base/linear_algebra.h.
  using DistributedVector = dealii::TrilinosWrappers::MPI::Vector;
  using DistributedMatrix = dealii::TrilinosWrappers::SparseMatrix;
} // namespace Viscoplastic
