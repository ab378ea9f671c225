// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace Viscoplastic
{
  /// While an object of this class lives, a call of exit() and an exception
  /// that nobody can catch, both of which code from a shared library of laws
  /// may come with, end the process with a sentence and the exit code 1: a run
  /// that ends early must not look like one that has succeeded. Objects may be
  /// nested, the last one says what the program was doing.
  class UnexpectedEnd
  {
  public:
    /// @p doing completes "while", such as "loading 'laws.so'".
    explicit UnexpectedEnd(const std::string &doing);
    ~UnexpectedEnd();

    UnexpectedEnd(const UnexpectedEnd &) = delete;
    UnexpectedEnd &
    operator=(const UnexpectedEnd &) = delete;

  private:
    const std::string  doing;
    const std::string *before;
  };
} // namespace Viscoplastic
