// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/run/command_line.h>

#include <string>

namespace Viscoplastic
{
  /**
   * A run with the mesh and the steps that reach `command_line.price' at the
   * lowest cost, as a few short runs predict it; says both before and
   * afterwards what it costs and gives. With the task check it only says what
   * it would cost.
   *
   * The short runs are those of a study of the scene on coarser meshes with
   * longer steps, or, where it is small already, on finer ones: four of them, h
   * and k each halved alone and both. Finished ones are used again.
   *
   * Returns the sentence of a signal, if one has ended a run early. Throws
   * ExcMessage. Collective.
   */
  std::string
  run_at_price(const CommandLine &command_line, Console &console);
} // namespace Viscoplastic
