// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>
#include <deal.II/base/types.h>

#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/laws/contact_laws.h>
#include <viscoplastic_contact/parameters/parameters.h>
#include <viscoplastic_contact/scene/exact_solution.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The boundary condition of one boundary id, with its data as functions of x
  /// and t.
  template <int dim>
  struct BoundaryCondition
  {
    /// Parse all entries, including those that the role and laws do not use.
    /// Throws ExcMessage naming the entry. Data that follow from @p solution,
    /// if there is one, must not be given.
    BoundaryCondition(const types::boundary_id  id,
                      const BoundaryParameters &parameters,
                      const ExactSolution<dim> *solution = nullptr);

    /// Set the data that follow from the solution and the normal.
    void
    derive_data();

    types::boundary_id id;
    BoundaryRole       role;
    /// The boundary of another body that is the foundation; displacements and
    /// the gap below are then relative to that body.
    std::optional<types::boundary_id> against;
    /// The laws of the role contact; null for other roles.
    const ContactLaw  *contact_law  = nullptr;
    const FrictionLaw *friction_law = nullptr;

    /// Role displacement: the prescribed components; absent ones are free.
    std::array<std::optional<Expression<dim>>, dim> displacement;
    /// Roles traction and displacement (free components): the given part of the
    /// traction F, and the pressure p, which adds -p nu. Absent where
    /// identically zero.
    std::optional<VectorExpression<dim>> traction;
    std::optional<Expression<dim>>       pressure;
    /// k_n and k_t of springs, stress per length, in the same roles; absent
    /// where identically zero.
    std::optional<Expression<dim>> normal_stiffness, tangential_stiffness;
    /// The gap g of unilateral contact; absent where identically zero.
    std::optional<Expression<dim>> given_gap;
    /// The factor k(x) of the pressure law of a compliant foundation.
    std::optional<Expression<dim>> given_compliance;
    PressureLaw                    pressure_law;
    /// d in u_nu = d of bilateral contact; in unilateral contact it is added to
    /// the gap. Absent where identically zero.
    std::optional<Expression<dim>> foundation_displacement;
    /// The foundation motion w, relative to which u slips; absent at rest.
    std::optional<VectorExpression<dim>> foundation_motion;
    /// The data of the friction law, in the order of its entries.
    std::vector<Expression<dim>> friction_data;
    /// S of the contact law `given normal stress'.
    std::optional<Expression<dim>> normal_stress;
    /// The factor of friction bounds as a function of the slip rate; absent
    /// where it is one.
    std::optional<Expression<1>> slip_rate_factor;
    /// The exact solution from which the data are computed; null if they are
    /// given.
    const ExactSolution<dim> *solution;
    /// The outward unit normal of a flat symmetry or contact boundary; if
    /// given, the direction into the foundation.
    Tensor<1, dim> normal;
    /// Whether `Foundation normal' is given; the boundary may then be curved.
    bool normal_is_given = false;
    /// Whether the boundary is curved and in contact with another body: normals
    /// are then those at its nodes, see SurfaceNormals.
    bool normal_varies = false;

    /// Whether u_nu is prescribed here.
    bool
    is_bilateral() const
    {
      return role == BoundaryRole::symmetry ||
             is_of_kind(ContactLaw::Kind::bilateral);
    }

    /// Whether sigma_nu = S is prescribed here.
    bool
    has_given_stress() const
    {
      return is_of_kind(ContactLaw::Kind::given_stress);
    }

    /// Whether contact opens and closes, on a rigid or a compliant foundation.
    bool
    is_unilateral() const
    {
      return is_of_kind(ContactLaw::Kind::unilateral);
    }

    /// Whether the foundation is compliant.
    bool
    has_normal_compliance() const
    {
      return contact_law != nullptr && contact_law->make;
    }

    /// The factor k of the pressure law. Throws ExcMessage where k is negative.
    double
    compliance(const Point<dim> &x) const;

    /// Whether the friction bound follows from the computed pressure.
    bool
    has_computed_pressure() const
    {
      return is_unilateral() && friction_law->follows_pressure();
    }

    /// Whether the friction bound is a given function of x and t, bound().
    bool
    has_given_bound() const
    {
      return has_friction() && !has_computed_pressure() && !slip_rate_factor;
    }

    /// The gap g + d of unilateral contact, a length.
    double
    gap(const Point<dim> &x, const double t) const
    {
      return (given_gap ? given_gap->value(x, t) : 0.) +
             (foundation_displacement ? foundation_displacement->value(x, t) :
                                        0.);
    }

    /// Whether nodes are contact points, with friction or unilateral contact.
    bool
    has_contact_points() const
    {
      return has_friction() || is_unilateral();
    }

    bool
    has_friction() const
    {
      return friction_law != nullptr && !friction_law->entries.empty();
    }

    /// Whether all data of the friction bound are identically zero.
    bool
    friction_vanishes() const
    {
      return has_friction() &&
             std::all_of(friction_data.begin(),
                         friction_data.end(),
                         [](const auto &datum) { return datum.is_zero(); });
    }

    /// Whether all of u is prescribed here by glued_displacement().
    bool
    is_glued() const
    {
      return friction_law != nullptr && friction_law->is_glued;
    }

    /// Whether a traction, pressure or normal stress is given.
    bool
    carries_load() const
    {
      return traction || pressure || normal_stress || has_derived_traction();
    }

    bool
    load_depends_on_time() const
    {
      return (traction && traction->depends_on_time()) ||
             (pressure && pressure->depends_on_time()) ||
             (normal_stress && normal_stress->depends_on_time()) ||
             has_derived_traction();
    }

    bool
    has_springs() const
    {
      return normal_stiffness || tangential_stiffness;
    }

    /// Return K = k_n nu nu + k_t (I - nu nu) at a point with this outward
    /// normal nu; springs add -K u to the force per area. Throws ExcMessage
    /// where a stiffness is negative.
    SymmetricTensor<2, dim>
    spring_stiffness(const Point<dim>     &x,
                     const Tensor<1, dim> &outward_normal) const;

    /// Return the given force per area at a point with this outward normal nu:
    /// F - p nu, or S nu; zero in directions in which u is prescribed.
    Tensor<1, dim>
    load(const Point<dim>     &x,
         const Tensor<1, dim> &outward_normal,
         const double          t) const;

    /// The tangential part of w(x,t) - w(x,0); zero for a foundation at rest.
    Tensor<1, dim>
    sliding(const Point<dim> &x, const double t) const
    {
      if (!foundation_motion)
        return {};
      const Tensor<1, dim> w =
        foundation_motion->vector(x, t) - foundation_motion->vector(x, 0.);
      return w - (w * normal) * normal;
    }

    /// Return the displacement d nu + sliding() of glued contact.
    Tensor<1, dim>
    glued_displacement(const Point<dim>     &x,
                       const Tensor<1, dim> &outward_normal,
                       const double          t) const
    {
      Tensor<1, dim> u = sliding(x, t);
      if (foundation_displacement)
        u += foundation_displacement->value(x, t) * outward_normal;
      return u;
    }

    /// Whether some displacement component is prescribed here.
    bool
    constrains() const
    {
      return role == BoundaryRole::clamped ||
             role == BoundaryRole::displacement || is_bilateral();
    }

    /// Whether all components of u are prescribed here.
    bool
    prescribes_all() const
    {
      bool all = true;
      for (const auto &component : displacement)
        all = all && component.has_value();
      return all || role == BoundaryRole::clamped || is_glued();
    }

    /// All expressions in x and t of the condition, friction data included.
    std::vector<const Expression<dim> *>
    data() const;

    /// Return the names of the entries that are given in @p parameters, from
    /// which this condition was made, but have no effect for its role and laws.
    std::vector<std::string>
    unused_entries(const BoundaryParameters &parameters) const;

    /// Return the part rho(x,t) of the friction bound rho + mu p that does not
    /// depend on a computed pressure p, and the friction coefficient mu(x,t).
    /// Throw ExcMessage where an entry is negative.
    double
    bound(const Point<dim> &x, const double t) const;

    double
    friction_coefficient(const Point<dim> &x, const double t) const;

    /// The factor f(v) of the friction bound at the slip rate v >= 0. Throws
    /// ExcMessage where it is negative.
    double
    bound_factor(const double slip_rate) const;

    bool
    friction_depends_on_time() const
    {
      return std::any_of(friction_data.begin(),
                         friction_data.end(),
                         [](const auto &datum) {
                           return datum.depends_on_time();
                         }) ||
             (normal_stress && normal_stress->depends_on_time());
    }

    bool
    friction_depends_on_position() const
    {
      return std::any_of(friction_data.begin(),
                         friction_data.end(),
                         [](const auto &datum) {
                           return datum.depends_on_position();
                         }) ||
             (normal_stress && normal_stress->depends_on_position());
    }

    /// Whether the data of friction or gap() depend on time.
    bool
    bound_depends_on_time() const
    {
      return friction_depends_on_time() ||
             (is_unilateral() &&
              ((given_gap && given_gap->depends_on_time()) ||
               (foundation_displacement &&
                foundation_displacement->depends_on_time())));
    }

  private:
    bool
    is_of_kind(const ContactLaw::Kind kind) const
    {
      return contact_law != nullptr && contact_law->kind == kind;
    }

    /// The sum of data of friction that do, or do not, multiply a pressure.
    double
    sum_of_friction(const Point<dim> &x,
                    const double      t,
                    const bool        of_pressure) const;

    /// Whether the traction is sigma nu of the exact solution.
    bool
    has_derived_traction() const
    {
      return solution &&
             (role == BoundaryRole::traction || role == BoundaryRole::free ||
              (role == BoundaryRole::displacement && !prescribes_all()));
    }
  };



  /// Return v_tau = v - v_nu nu.
  template <int dim>
  Tensor<1, dim>
  tangential(const Tensor<1, dim> &v, const Tensor<1, dim> &normal)
  {
    return v - (v * normal) * normal;
  }
} // namespace Viscoplastic
