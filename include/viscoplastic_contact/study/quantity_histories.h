// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/study/study_record.h>

#include <string>
#include <vector>

namespace Viscoplastic
{
  /// How far a quantity is from that of another run.
  struct QuantityChange
  {
    std::string quantity;
    /// The largest difference of all times over the largest size, and the same
    /// for the error of the discretization.
    double change = 0., error = 0.;
  };

  /**
   * The differences between the quantities of two runs, at the times of the
   * first and linear in between in the second: forces, displacements of points,
   * energies and dissipations, slipping area, largest displacement and stress.
   * They are relative to the largest value of the first, or to a thousandth of
   * what others of the same kind reach, if that is larger. What a run has no
   * column for is zero.
   */
  std::vector<QuantityChange>
  changes_between(const Table &run, const Table &other);
} // namespace Viscoplastic
