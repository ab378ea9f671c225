// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/contact_face.h>
#include <viscoplastic_contact/discretization/contact_limits.h>
#include <viscoplastic_contact/discretization/elasticity.h>
#include <viscoplastic_contact/discretization/flow_laws.h>
#include <viscoplastic_contact/discretization/held_traction.h>
#include <viscoplastic_contact/discretization/loads.h>
#include <viscoplastic_contact/discretization/springs.h>
#include <viscoplastic_contact/discretization/stress_space.h>
#include <viscoplastic_contact/linear_solvers/solver_choice.h>
#include <viscoplastic_contact/scene/scene.h>

#include <memory>

namespace Viscoplastic
{
  /// Whether full integration may lock: with laws whose flow is deviatoric, or
  /// where the largest Poisson's ratio is @p max_nu > 0.4.
  template <int dim>
  bool
  may_lock(const Scene<dim> &scene, const double max_nu);

  /// Whether the volumetric strain is the mean over each cell: as the scene
  /// says, or may_lock() if it says `automatic'.
  template <int dim>
  bool
  uses_mean_dilatation(const Scene<dim> &scene, const double max_nu);



  /// A scene on one mesh: all that depends on the mesh but neither on the state
  /// nor on the solution of steps. Members are declared in order of dependence.
  /// Constructed anew for each mesh.
  template <int dim>
  class Discretization
  {
  public:
    /// Set up all but the matrix, the most expensive part. Throws ExcMessage if
    /// the scene does not fit the mesh. Collective.
    Discretization(const DoFHandler<dim> &dof_handler, const Scene<dim> &scene);

    /// Assemble the matrix. Collective. Throws ExcMessage if springs are too
    /// soft.
    void
    assemble_matrix();

    const Scene<dim> &
    scene() const
    {
      return space.scene;
    }

    /// The face for solvers: null if nothing could slip or open, also if other
    /// conditions hold all nodes of these boundaries.
    const ContactFace<dim> *
    slipping_face() const
    {
      return face_restriction().n_global_dofs() > 0 ? face.get() : nullptr;
    }

    /// The restriction to the contact points, which may be none.
    const FaceRestriction &
    face_restriction() const
    {
      return face ? face->restriction() : no_face;
    }

    /// The sizes from which the linear solver of this mesh is chosen (see
    /// solver_choice.h).
    SolverDemand
    solver_demand() const;

    /// V_h, with its boundary conditions.
    AdmissibleSpace<dim> space;
    ElasticModuli<dim>   moduli;
    bool                 mean_dilatation;
    /// Q_h, the space of stresses.
    StressSpace<dim> stress_space;
    FlowLaws<dim>    laws;
    Loads<dim>       loads;
    /// The springs between body and ground; null if there are none.
    std::unique_ptr<Springs<dim>> springs;
    /// Tension at bilateral contact; null if there is none.
    std::unique_ptr<ContactTension<dim>> tension;
    /// The contact points; null without friction and unilateral contact.
    std::unique_ptr<ContactFace<dim>> face;
    /// The traction of glued and bilateral interfaces; null if there are none.
    std::unique_ptr<HeldTraction<dim>> held_traction;
    /// The sliding of interfaces; null without contact between bodies.
    std::unique_ptr<InterfaceSlide<dim>> slide;
    /// The expected number of time steps on this mesh.
    unsigned int n_steps;
    /// The matrix of a(.,.) with that of springs, in nodal frames.
    DistributedMatrix matrix;

  private:
    const FaceRestriction no_face;
  };
} // namespace Viscoplastic
