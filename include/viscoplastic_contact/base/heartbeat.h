// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/console.h>

#include <array>

namespace Viscoplastic
{
  /// The nested iterations that solve a time step, from the outermost to the
  /// innermost.
  enum class Loop
  {
    newton,
    contact,
    linear
  };

  /// While an object of this class lives, a run that has said nothing for some
  /// time says where it is, from within the iterations of a step: "Still at
  /// step 3 (t = 0.3): 2 Newton, 17 contact, 340 linear iterations  elapsed 31
  /// s". Iterations and steps report to it by count() and begin_step(), which
  /// may be called without an object and then do nothing. Not for several
  /// threads.
  class Heartbeat
  {
  public:
    /// Speaks on @p console if that has been silent for @p seconds, or a
    /// hundredth of the run, whichever is longer.
    explicit Heartbeat(Console &console, const double seconds = 10.);
    ~Heartbeat();

    Heartbeat(const Heartbeat &) = delete;
    Heartbeat &
    operator=(const Heartbeat &) = delete;

    /// A step, or another try of one, is begun.
    static void
    begin_step(const unsigned int n, const double t);

    /// An iteration of this kind is made.
    static void
    count(const Loop loop);

  private:
    void
    speak(const double elapsed);

    Console                    &console;
    const double                seconds;
    unsigned int                n = 0;
    double                      t = 0.;
    std::array<unsigned int, 3> n_iterations{};
  };
} // namespace Viscoplastic
