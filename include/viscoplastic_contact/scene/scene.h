// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/distributed/tria.h>

#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/parameters/parameter_file.h>
#include <viscoplastic_contact/parameters/time_schedule.h>
#include <viscoplastic_contact/scene/boundary_condition.h>
#include <viscoplastic_contact/scene/exact_solution.h>
#include <viscoplastic_contact/scene/material.h>
#include <viscoplastic_contact/scene/quantity_of_interest.h>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /**
   * What is simulated: the body, its material, the roles of its boundary, the
   * loads and the time steps, as functions of x and t and free of any
   * discretization. The members that a scene does not need are empty.
   */
  template <int dim>
  class Scene
  {
  public:
    /// Throws ExcMessage with a sentence for the user.
    explicit Scene(const Parameters &parameters);

    /**
     * Hold the roles and materials against the mesh: each boundary id has a
     * role and exists, symmetry and contact pieces are flat (sets their
     * normals), each material id has a material. Makes the materials that the
     * mesh has. Collective.
     */
    void
    inspect(const parallel::distributed::Triangulation<dim> &triangulation);

    /// The effects that this scene has, for the user.
    std::vector<std::string>
    effects() const;

    /// Known after inspect(), like the effects.
    const Material<dim> &
    material(const types::material_id id) const
    {
      return *material_of_id.at(id);
    }

    /// Whether errors are measured against a known solution.
    bool
    measures_errors() const
    {
      return exact_solution ||
             !parameters.exact_solution.reference_directory.empty();
    }

    /// Whether there is a G: laws, or the source of a manufactured solution.
    bool
    has_viscosity() const;

    /// Whether all steps are of backward Euler; known with the mesh, as the
    /// viscosity is.
    bool
    is_implicit() const
    {
      return has_viscosity() &&
             parameters.time.scheme == TimeScheme::backward_euler;
    }

    /// Whether steps beyond the stability limit are of backward Euler, and the
    /// others not.
    bool
    is_implicit_beyond_the_limit() const
    {
      return has_viscosity() && !is_implicit() &&
             parameters.time.stiffness_policy ==
               StiffnessPolicy::backward_euler;
    }

    /// Whether a source makes the exact solution one of the scene.
    bool
    has_source() const
    {
      return exact_solution && exact_solution->makes_data &&
             exact_solution->has_own_stress();
    }

    /// Whether there is z = sigma - E eps(u): from viscosity, or from initial
    /// data.
    bool
    has_irreversible_stress() const
    {
      return has_viscosity() || initial_displacement || initial_stress;
    }

    bool
    has_friction() const;

    /// Whether the error of time steps is estimated: of z, and of slip that may
    /// turn.
    bool
    has_time_error() const
    {
      return has_viscosity() || (dim == 3 && has_friction());
    }

    bool
    has_contact() const;

    bool
    has_moving_foundation() const;

    /// Whether neither loads nor friction bounds depend on time.
    bool
    has_constant_loads_and_bounds() const;

    bool
    is_adaptive() const
    {
      return parameters.refinement.strategy != RefinementStrategy::none;
    }

    const Parameters &parameters;
    TimeSchedule      schedule;
    /// The exact solution; null if none is known.
    std::unique_ptr<ExactSolution<dim>>                  exact_solution;
    std::map<types::boundary_id, BoundaryCondition<dim>> boundary;
    /// The materials that some cell has.
    std::vector<std::unique_ptr<const Material<dim>>> materials;
    /// b, u0, sigma0; absent where identically zero.
    std::optional<VectorExpression<dim>> body_force;
    std::optional<VectorExpression<dim>> initial_displacement, initial_stress;
    /// Points whose displacement is recorded.
    std::vector<Point<dim>> output_points;
    /// That of `Error control/Quantity'; absent if there is none.
    std::optional<QuantityOfInterest> quantity;
    /// What is allowed but should be known, a sentence each.
    std::vector<std::string> warnings;

  private:
    void
    inspect_boundary_ids(const std::set<types::boundary_id> &ids) const;

    void
    inspect_flatness(
      const parallel::distributed::Triangulation<dim> &triangulation);

    /// Entries of boundaries without effect.
    void
    inspect_unused_entries();

    /// Pieces with prescribed displacement that touch Gamma_3.
    void
    inspect_junctions(
      const parallel::distributed::Triangulation<dim> &triangulation);

    void
    make_materials(const std::set<types::material_id> &ids);

    /// What follows from an exact solution, and refuse it from elsewhere.
    void
    derive_data();

    std::map<types::material_id, const Material<dim> *> material_of_id;
  };


  /// The six (four in plane strain) stress components in the order of the
  /// parameter file: xx, yy, zz, xy (, xz, yz).
  template <int dim>
  constexpr std::array<std::pair<unsigned int, unsigned int>, dim == 2 ? 4 : 6>
  stress_components()
  {
    if constexpr (dim == 2)
      return {{{0, 0}, {1, 1}, {2, 2}, {0, 1}}};
    else
      return {{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
  }
} // namespace Viscoplastic
