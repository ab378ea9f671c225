// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/run/viscoplastic_contact.h>

#include <string>

namespace Viscoplastic
{
  /// Run a scene in as many passes as it takes. A run to the tolerance of a
  /// quantity of interest on adaptive meshes may take several: creep and slip
  /// depend on all meshes so far, which the estimate of a quantity neglects.
  /// Therefore each pass begins on the final mesh of the previous one. If the
  /// body creeps, whose displacement depends most on earlier meshes, a pass for
  /// any quantity but the work of friction ends as soon as its mesh changes.
  /// Each pass overwrites the files of the previous one. Arguments and result
  /// are those of ViscoplasticContact::run().
  template <int dim>
  std::string
  run_in_passes(const Parameters          &parameters,
                Console                   &console,
                const CommandLine::Restart restart);
} // namespace Viscoplastic
