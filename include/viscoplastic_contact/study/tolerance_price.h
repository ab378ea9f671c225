// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/study/study_analysis.h>

#include <string>

namespace Viscoplastic
{
  /// What an error costs by a run to a tolerance, and the sentence of a signal
  /// that has ended the search for it, if one has.
  struct ToleranceQuote
  {
    std::string    measure;
    TolerancePrice price;
    std::string    interruption;
  };

  /**
   * The price of the error @p eps of a scene with a tolerance, from pilot runs
   * to larger ones: the tolerance of the scene times powers of two, from the
   * largest that makes sense down to the last that is well above the one for
   * @p eps, and does not take half of the budget. Finished ones are used again.
   *
   * Prints what it makes and finds. Throws ExcMessage if a pilot run fails, or
   * none knows its error. Collective.
   */
  ToleranceQuote
  price_to_tolerance(StudyRuns &runs, const double eps, Console &console);
} // namespace Viscoplastic
