// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/discretization/compatibility.h>
#include <viscoplastic_contact/mesh/mesh_size.h>
#include <viscoplastic_contact/run/announcer.h>

#include <thread>

namespace Viscoplastic
{
  namespace
  {
    /// Advise on the number of ranks, from a model of their speed-up and
    /// memory. Collective.
    template <int dim>
    void
    advise_on_ranks(const Discretization<dim> &discretization, Console &console)
    {
      SolverDemand       demand  = discretization.solver_demand();
      const unsigned int n_ranks = demand.n_ranks;
      const double       n_steps = discretization.scene().schedule.n_steps();
      const double       n_coarse =
        discretization.space.dof_handler.get_triangulation().n_cells(0);
      if (n_ranks > 1 && n_coarse >= 1e5)
        {
          console.remark(
            "Note: each of the " + std::to_string(n_ranks) +
            " ranks keeps all " + as_text(n_coarse) + " coarse cells, some " +
            number(1e-9 * n_ranks * bytes_of_coarse_cells(dim, n_coarse), 2) +
            " GB in all. Cells that 'Geometry/Global refinements' makes are "
            "shared among them.");
        }
      if (demand.choice == LinearSolver::direct)
        demand.choice = LinearSolver::automatic;
      const auto seconds = [&](const unsigned int n) {
        return expected_seconds(demand, n_steps, n);
      };
      const std::uint64_t n_most =
        std::max<std::uint64_t>(1, demand.n_dofs / least_dofs_of_rank);
      unsigned int best = std::clamp<std::uint64_t>(
        demand.n_dofs / dofs_worth_a_rank,
        1,
        std::max(n_ranks, std::thread::hardware_concurrency()));
      if (seconds(1) < seconds(best)) // by the direct solver
        best = 1;
      constexpr double short_run = 20., hardly = 0.75;
      const double     share = seconds(best) / seconds(n_ranks);
      if (seconds(n_ranks) < short_run || (share > hardly && n_ranks <= n_most))
        return;
      std::ostream &out = console.stream();
      out << "Ranks: ";
      if (share <= hardly)
        out << best << (best == 1 ? " is" : " are") << " expected to take "
            << number(share, 2) << " of the time of " << n_ranks << ", ";
      out << "more than " << n_most
          << " to lose again (a model; see doc/cluster.md)\n";
    }



    /// Warn of contradictory prescribed displacements. Collective.
    template <int dim>
    void
    warn_of_jumps(const AdmissibleSpace<dim> &space, Console &console)
    {
      const auto jump = first_jump(space);
      if (!jump)
        return;
      std::vector<std::string> names;
      for (const types::boundary_id id : jump->boundaries)
        names.push_back(space.scene.names.of("boundary", id));
      console.remark(
        "Warning: what is prescribed of displacements jumps by " +
        as_text(jump->size) + space.scene.unit(Quantity::length) + " at x = (" +
        as_text(jump->position) + "), where " + enumeration(names) +
        " meet (t = " + as_text(jump->t) + space.scene.unit(Quantity::time) +
        "). No displacement of finite energy does that: forces, energies and "
        "errors grow with each finer mesh, and no error bar tells their limit. "
        "Let the data agree where boundaries meet.");
    }
  } // namespace



  template <int dim>
  void
  announce_scene(const Scene<dim> &scene, Console &console)
  {
    std::ostream &out = console.stream();
    out << "viscoplastic_contact " << program_version << " (" << git_revision
        << "), " << scene.parameters.file << " on "
        << Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD)
        << " MPI rank(s)\nEffects:\n";
    for (const std::string &effect : scene.effects())
      out << "  " << effect << '\n';
    if (const auto changed = scene.changed_defaults(); !changed.empty())
      out << "Changed defaults: " << enumeration(changed) << '\n';
    for (const std::string &warning : scene.warnings)
      console.remark("Warning: " + warning);
    out << std::flush;
  }



  void
  announce_kinks(const KinksOfScene &found, Console &console)
  {
    constexpr std::size_t most  = 6;
    const auto           &kinks = found.kinks;
    std::ostream         &out   = console.stream();
    out << "Steps end at kinks and jumps in time of ";
    for (std::size_t i = 0; i < found.entries.size(); ++i)
      out << (i > 0 ? ", '" : "'") << found.entries[i] << '\'';
    out << ": t = ";
    for (std::size_t i = 0; i < std::min(most, kinks.size()); ++i)
      out << (i > 0 ? ", " : "") << kinks[i].t;
    if (kinks.size() > most)
      out << ", ..., " << kinks.back().t << " (" << kinks.size() << " times)";
    out << '\n';
  }



  template <int dim>
  void
  announce_equilibrium(const Scene<dim> &scene,
                       const State<dim> &initial,
                       Console          &console)
  {
    if (!scene.parameters.initial_state.equilibrate)
      return;
    const double largest_u0 = initial.u.linfty_norm();
    if (largest_u0 == 0.)
      return;
    console.stream()
      << "Equilibrium at t = 0: the body has moved by up to " << largest_u0
      << scene.unit(Quantity::length)
      << (scene.parameters.initial_state.reset_displacement ?
            "; displacements count from there\n" :
            ", which counts in all displacements ('Initial state/Reset "
            "displacement' lets them begin with zero)\n");
  }



  template <int dim>
  void
  announce_stage(const Scene<dim> &scene, Console &console)
  {
    const std::string absent = enumeration(scene.absent_materials());
    console.stream() << "From t = " << scene.stage_ends[scene.stage() - 1]
                     << scene.unit(Quantity::time) << " on "
                     << (absent.empty() ? "with all materials" :
                                          "without " + absent)
                     << '\n';
  }



  template <int dim>
  void
  announce_first_mesh(const Discretization<dim> &discretization,
                      Console                   &console)
  {
    const DoFHandler<dim> &dof_handler = discretization.space.dof_handler;
    std::ostream          &out         = console.stream();
    out << "Mesh: " << dof_handler.get_triangulation().n_global_active_cells()
        << " cells, " << dof_handler.n_dofs() << " degrees of freedom";
    if (discretization.face)
      for (const auto &[of_obstacles, name] :
           {std::make_pair(false, " friction points"),
            std::make_pair(true, " points of unilateral contact")})
        if (const auto n = discretization.face->n_global_points(of_obstacles);
            n > 0 || (!of_obstacles && discretization.scene().has_friction()))
          out << ", " << n << name;
    out << (discretization.mean_dilatation ? ", mean dilatation\n" : "\n");
    warn_of_jumps(discretization.space, console);
    advise_on_ranks(discretization, console);
  }



  template <int dim>
  void
  warn_of_held_faces(const Discretization<dim> &discretization,
                     Console                   &console)
  {
    // Faces of materials that are added later have no contact points yet.
    if (!discretization.face ||
        discretization.scene().contact_changes_with_stages())
      return;
    for (const types::boundary_id id : discretization.face->held_boundaries())
      console.remark(
        "Note: nothing slips or opens on " +
        discretization.scene().names.of("boundary", id) +
        ", although it has friction or unilateral contact: other conditions "
        "hold all of its nodes on the present mesh; refine it there, or release another boundary.");
  }



  VISCOPLASTIC_INSTANTIATE(announce_scene);
  VISCOPLASTIC_INSTANTIATE(announce_equilibrium);
  VISCOPLASTIC_INSTANTIATE(announce_stage);
  VISCOPLASTIC_INSTANTIATE(announce_first_mesh);
  VISCOPLASTIC_INSTANTIATE(warn_of_held_faces);
} // namespace Viscoplastic
