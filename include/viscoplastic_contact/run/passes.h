// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/run/viscoplastic_contact.h>

#include <string>

namespace Viscoplastic
{
  /// Estimate the size of a scene's solution by a run without files on its
  /// first mesh, with at most eight steps a phase. The argument stays in use.
  template <int dim>
  PilotRun
  pilot_run(const Parameters &parameters);

  /// Run a scene in as many passes as it takes. To the tolerance of a quantity
  /// of interest on adaptive meshes that may be several: what creeps or slips
  /// remembers each mesh, as the estimate of a quantity does not, so that the
  /// mesh a pass has come to is the first one of the next. The displacement of
  /// a body that creeps remembers most, and a pass that needs another mesh ends
  /// at once. Each pass writes its files over those of the one before: the pass
  /// that turns out to be right is the run. Arguments and the result are those
  /// of ViscoplasticContact::run().
  template <int dim>
  std::string
  run_in_passes(const Parameters          &parameters,
                Console                   &console,
                const CommandLine::Restart restart);
} // namespace Viscoplastic
