// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/units.h>

#include <optional>
#include <string>

namespace Viscoplastic
{
  /// Check the dimensions of an expression, or of a list of them, whose numbers
  /// have units. Returns a part of a sentence if they are wrong, e.g. if a
  /// length is added to a stress or the result has not the dimension @p wanted;
  /// otherwise an empty string.
  ///
  /// Coordinates are lengths and t is a time; in expressions of laws, sigma_eq
  /// and p are stresses. A number without unit fits any dimension, since it is
  /// in units of the scene: `0.3*t' has any dimension. Expressions that cannot
  /// be read are left to their parser.
  std::string
  wrong_dimension(const std::string              &text,
                  const std::optional<Dimension> &wanted);

  /// Return the position after the number that begins at @p begin of @p text;
  /// @p begin itself if none begins there.
  std::size_t
  end_of_number(const std::string &text, const std::size_t begin);
} // namespace Viscoplastic
