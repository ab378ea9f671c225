// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/units.h>

#include <optional>
#include <string>

namespace Viscoplastic
{
  /// What is wrong with the dimensions of an expression, or of a list of them,
  /// whose numbers have units: that it adds a length to a stress, or that it is
  /// no @p wanted. A part of a sentence, or empty.
  ///
  /// The coordinates are lengths and t is a time; of the function of a law,
  /// sigma_eq and p are stresses. A number without unit may have any, since it
  /// has that of the scene, so that `0.3*t' is whatever is wanted. What cannot
  /// be read is left to the parser of expressions.
  std::string
  wrong_dimension(const std::string              &text,
                  const std::optional<Dimension> &wanted);

  /// Behind the number that begins at @p begin of @p text; @p begin itself if
  /// none begins there.
  std::size_t
  end_of_number(const std::string &text, const std::size_t begin);
} // namespace Viscoplastic
