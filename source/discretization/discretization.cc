// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/discretization/discretization.h>

#include <limits>

namespace Viscoplastic
{
  template <int dim>
  bool
  may_lock(const Scene<dim> &scene, const double max_nu)
  {
    for (const auto &material : scene.materials)
      if (material->law && material->law->deviatoric_flow())
        return true;
    return max_nu > 0.4;
  }



  template <int dim>
  bool
  uses_mean_dilatation(const Scene<dim> &scene, const double max_nu)
  {
    const VolumetricIntegration choice =
      scene.parameters.stress.volumetric_integration;
    return choice == VolumetricIntegration::automatic ?
             may_lock(scene, max_nu) :
             choice == VolumetricIntegration::mean_dilatation;
  }



  namespace
  {
    template <int dim>
    bool
    has_bilateral_contact(const Scene<dim> &scene)
    {
      return scene.on_any_boundary([](const auto &b) {
        return b.role == BoundaryRole::contact && b.is_bilateral() &&
               !b.is_glued();
      });
    }



    /// Return about how many steps a mesh is used. Runs to a tolerance take few
    /// but long steps: fronts that cross many nodes need twice the iterations
    /// on which the cost model is based.
    template <int dim>
    unsigned int
    expected_steps(const Scene<dim> &scene)
    {
      const Parameters &p = scene.parameters;
      return !scene.is_adaptive()            ? scene.schedule.n_steps() :
             p.error_control.has_tolerance() ? 8 :
                                               p.refinement.every_n_steps;
    }



    /// Return the solves per step: Heun's method also solves for its predictor.
    template <int dim>
    unsigned int
    solves_per_step(const Scene<dim> &scene)
    {
      return scene.has_viscosity() &&
                 scene.parameters.time.scheme == TimeScheme::heun ?
               2 :
               1;
    }
  } // namespace



  template <int dim>
  Discretization<dim>::Discretization(const DoFHandler<dim> &dof_handler,
                                      const Scene<dim>      &scene)
    : space(dof_handler, scene)
    , moduli(space)
    , mean_dilatation(uses_mean_dilatation(scene, moduli.max_poissons_ratio()))
    , stress_space(space,
                   moduli,
                   scene.has_irreversible_stress() &&
                     scene.keeps_history_at_points(),
                   mean_dilatation)
    , laws(stress_space)
    , loads(space)
    , springs(scene.has_springs() ? std::make_unique<Springs<dim>>(space) :
                                    nullptr)
    , tension(has_bilateral_contact(scene) ?
                std::make_unique<ContactTension<dim>>(stress_space) :
                nullptr)
    , face(scene.has_contact_points() ?
             std::make_unique<ContactFace<dim>>(space) :
             nullptr)
    , held_traction(HeldTraction<dim>::is_needed(scene) ?
                      std::make_unique<HeldTraction<dim>>(space) :
                      nullptr)
    , slide(scene.has_contact_pairs() ?
              std::make_unique<InterfaceSlide<dim>>(space) :
              nullptr)
    , n_steps(expected_steps(scene))
  {}



  template <int dim>
  void
  Discretization<dim>::assemble_matrix()
  {
    assemble_elastic_matrix(space, moduli, mean_dilatation, matrix);
    if (springs && space.is_held_by_springs())
      {
        // Rounding of the matrix resists rigid motions; springs must exceed it.
        double sum = 0.;
        for (std::size_t i = 0; i < space.owned.n_elements(); ++i)
          sum += matrix.diagonal(i);
        sum = Utilities::MPI::sum(sum, space.communicator);
        if (!(springs->total_stiffness() >
              10. * std::numeric_limits<double>::epsilon() * sum))
          refuse("The springs are so soft beside the body that the rigid "
                 "motions which they alone hold are lost in rounding. Let them "
                 "be stiffer, or prescribe displacements that hold the body.");
      }
    if (springs)
      springs->add_to(matrix);
    matrix.share_rows();
  }



  template <int dim>
  SolverDemand
  Discretization<dim>::solver_demand() const
  {
    SolverDemand demand;
    demand.choice  = scene().parameters.solver.linear_solver;
    demand.dim     = dim;
    demand.n_ranks = Utilities::MPI::n_mpi_processes(space.communicator);
    demand.max_poissons_ratio = moduli.max_poissons_ratio();
    demand.solves_per_step    = solves_per_step(scene());
    demand.n_solves           = n_steps * demand.solves_per_step;
    demand.n_dofs             = space.dof_handler.n_dofs();
    demand.n_face_dofs        = face_restriction().n_global_dofs();
    demand.has_friction       = scene().has_friction();
    demand.n_first_dofs       = space.n_first_dofs();
    return demand;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(Discretization);
  VISCOPLASTIC_INSTANTIATE(may_lock);
  VISCOPLASTIC_INSTANTIATE(uses_mean_dilatation);
} // namespace Viscoplastic
