// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/types.h>

#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/results/run_summary.h>
#include <viscoplastic_contact/time_stepping/time_stepper.h>

#include <set>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// Records which effects of a scene have acted in a run, apart from those
  /// that sums and maxima (RunSummary) show.
  template <int dim>
  class ActingEffects
  {
  public:
    /// Record the effects that act in a step. Collective.
    void
    note(const Discretization<dim> &discretization,
         const AcceptedStep<dim>   &step);

    void
    note_change_of_mesh()
    {
      mesh_has_changed = true;
    }

    /// Return sentences on effects that never acted, with the entry that can be
    /// removed. @p run: the summary of the whole run.
    std::vector<std::string>
    that_never_acted(const Scene<dim> &scene, const RunSummary<dim> &run) const;

    template <typename Archive>
    void
    serialize(Archive &archive, const unsigned int)
    {
      archive &loads &mesh_has_changed &has_bound &foundation_has_moved
        &has_touched &has_opened &closes_between_nodes;
    }

  private:
    /// The boundaries whose loads have acted, see Load::acting.
    std::set<types::boundary_id> loads;
    bool                         mesh_has_changed = false;
    /// Whether a friction bound has been above zero somewhere.
    bool has_bound = false;
    /// Whether some obstacle point has been in contact, and some point open.
    bool has_touched = false, has_opened = false;
    /// Whether the gap has closed between nodes before any node touched.
    bool closes_between_nodes = false;
    bool foundation_has_moved = false;
  };
} // namespace Viscoplastic
