// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/exceptions.h>

#include <mpi.h>

#include <exception>
#include <functional>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// Throw ExcMessage with a sentence for the user.
  [[noreturn]] void
  refuse(const std::string &sentence);

  /// A number or a place as a stream writes it.
  template <typename T>
  std::string
  as_text(const T &value, const int digits = 6)
  {
    std::ostringstream text;
    text.precision(digits);
    text << value;
    return text.str();
  }

  /// The number that a text is, or nothing if it is none.
  std::optional<double>
  number_of(const std::string &text);

  /// The message of an exception for the user, as one line, without the place
  /// in the code where it was thrown.
  std::string
  reason(const std::exception &exception);


  /// The message of the exception that is being handled, of whatever type: laws
  /// of shared libraries may throw anything. For use in `catch (...)'.
  std::string
  reason_of_current_exception();


  /// Do @p work, which is not collective, and throw on all ranks if it fails on
  /// some, with the reason() of the first of them: the ranks stay together, and
  /// a step can be tried again. Collective; throws ExcMessage.
  void
  fail_together(const MPI_Comm communicator, const std::function<void()> &work);


  /// Ids of boundaries or materials, separated by commas.
  std::string
  list(const std::set<unsigned int> &ids);

  /// A number for people, of at most so many digits.
  std::string
  number(const double value, const int digits = 5);



  /// The candidate that @p name was probably meant to be; empty if none is
  /// near. Case, blanks and punctuation do not count, and the beginning of a
  /// long name is near to it.
  std::string
  nearest_name(const std::string              &name,
               const std::vector<std::string> &candidates);

  /// "; did you mean 'a'?" with the nearest candidate, @p otherwise without.
  std::string
  did_you_mean(const std::string              &name,
               const std::vector<std::string> &candidates,
               const std::string              &otherwise = ".");

  /// The identifier (letters, digits and underscores, no digit first) that
  /// begins at @p begin of @p text; empty if none begins there.
  std::string
  identifier_at(const std::string &text, const std::size_t begin);

  /// Whether the identifier @p name stands in @p text by itself, not as a part
  /// of a longer one.
  bool
  mentions(const std::string &text, const std::string &name);

  /// A text from outside as part of a sentence: on one line, without control
  /// characters, and shortened to @p longest characters.
  std::string
  excerpt(const std::string &text, const std::size_t longest = 60);

  /// `a, b, c'; the first @p n_max of them if there are more.
  std::string
  enumeration(const std::vector<std::string> &names,
              const unsigned int              n_max = 20);
} // namespace Viscoplastic
