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
   * energies and dissipations, largest displacement and stress. The slipping
   * area is none of them: it jumps from point to point, in time, too.
   * They are relative to the largest value of the first, or to a thousandth of
   * what others of the same kind reach, if that is larger; energies are to the
   * largest of them. What a run has no column for is zero, but for the force of
   * unilateral contact, which then is not compared.
   */
  std::vector<QuantityChange>
  changes_between(const Table &run, const Table &other);

  /**
   * By how much two changes do not add up, for each quantity of @p run: the
   * largest |q - q_first - q_second + q_both| over the largest size, as above.
   */
  std::vector<QuantityChange>
  interactions(const Table &run,
               const Table &first,
               const Table &second,
               const Table &both);
} // namespace Viscoplastic
