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

  /// Return a number or point as a stream writes it.
  template <typename T>
  std::string
  as_text(const T &value, const int digits = 6)
  {
    std::ostringstream text;
    text.precision(digits);
    text << value;
    return text.str();
  }

  /// Return the number that a text represents, or nothing if it is no number.
  std::optional<double>
  number_of(const std::string &text);

  /// Return the message of an exception as one line without source location.
  std::string
  reason(const std::exception &exception);


  /// Return the message of the exception that is being handled, which may be of
  /// any type, since laws of shared libraries may throw anything. For use in
  /// `catch (...)'.
  std::string
  reason_of_current_exception();


  /// Do @p work, which is not collective. If it throws on some ranks, throw
  /// ExcMessage on all of them with the reason() of the first such rank, so
  /// that all ranks stay in step and a time step can be repeated. Collective.
  void
  fail_together(const MPI_Comm communicator, const std::function<void()> &work);


  /// Return ids of boundaries or materials, separated by commas.
  std::string
  list(const std::set<unsigned int> &ids);

  /// Return a number as text with at most so many significant digits.
  std::string
  number(const double value, const int digits = 5);



  /// Return the candidate closest to @p name, or "" if none is close. Case,
  /// blanks and punctuation do not count; the beginning of a name is close.
  std::string
  nearest_name(const std::string              &name,
               const std::vector<std::string> &candidates);

  /// Return "; did you mean 'a'?" with nearest_name(), or else @p otherwise.
  std::string
  did_you_mean(const std::string              &name,
               const std::vector<std::string> &candidates,
               const std::string              &otherwise = ".");

  /// Return the identifier (letters, digits and underscores, no digit first)
  /// that begins at position @p begin of @p text; empty if none does.
  std::string
  identifier_at(const std::string &text, const std::size_t begin);

  /// Return whether @p text contains the whole identifier @p name.
  bool
  mentions(const std::string &text, const std::string &name);

  /// Prepare text from the user for an error message: replace control
  /// characters and shorten it to @p longest characters.
  std::string
  excerpt(const std::string &text, const std::size_t longest = 60);

  /// Return `a, b, c', with only the first @p n_max names if there are more.
  std::string
  enumeration(const std::vector<std::string> &names,
              const unsigned int              n_max = 20);
} // namespace Viscoplastic
