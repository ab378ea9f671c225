// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/console.h>
#include <viscoplastic_contact/discretization/discretization.h>
#include <viscoplastic_contact/scene/kinks_in_time.h>

#include <set>
#include <string>

namespace Viscoplastic
{
  /// Tells the user what is simulated: the effects of a scene, the size of its
  /// mesh, the linear solver, and warnings about them. Warnings that may recur
  /// on later meshes are printed once.
  template <int dim>
  class Announcer
  {
  public:
    explicit Announcer(Console &console)
      : console(console)
    {}

    void
    announce(const Scene<dim> &scene);

    /// Announce the kinks and jumps of data at which steps will end.
    void
    announce(const KinksOfScene &found);

    /// Announce how far the body has moved into equilibrium at t = 0.
    void
    announce_equilibrium(const Scene<dim> &scene, const State<dim> &initial);

    /// Announce the stage of construction that begins.
    void
    announce_stage(const Scene<dim> &scene);

    /// Announce the first mesh and warn of what no mesh can cure; of each mesh,
    /// name contact boundaries whose nodes are all held otherwise. Collective.
    void
    announce(const Discretization<dim> &discretization);

    /// Announce that the mesh was too coarse for step @p n, by a factor of @p
    /// excess, and has been refined.
    void
    announce_refinement(const unsigned int             n,
                        const double                   excess,
                        const types::global_cell_index n_cells);

    /// Announce the linear solver once; @p name is empty before its first use.
    void
    announce_solver(const std::string &name)
    {
      if (name.empty() || name == solver)
        return;
      solver = name;
      console.stream() << "Linear solver: " << solver << std::endl;
    }

  private:
    /// Advise on the number of ranks, from a model of their speed-up and
    /// memory. Collective.
    void
    advise_on_ranks(const Discretization<dim> &discretization);

    /// Warn of contradictory prescribed displacements. Collective.
    void
    warn_of_jumps(const AdmissibleSpace<dim> &space);

    void
    warn_of_held_faces(const Discretization<dim> &discretization);

    Console                     &console;
    std::string                  solver;
    bool                         has_announced_mesh = false;
    std::set<types::boundary_id> held_faces;
  };
} // namespace Viscoplastic
