// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/lac/solver_gmres.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/contact/contact_points.h>
#include <viscoplastic_contact/laws/backward_euler.h>
#include <viscoplastic_contact/time_stepping/nonsymmetric_correction.h>

namespace Viscoplastic
{
  namespace
  {
    /// The algorithmic tangents minus E at the samples.
    template <int dim>
    std::vector<SymmetricTensor<4, 3>>
    flow_tangents(const FlowLaws<dim>      &laws,
                  const NewtonIterate<dim> &at,
                  const StepProblem<dim>   &problem)
    {
      const StressSpace<dim> &stress_space = laws.stress_space;
      const unsigned int      n            = stress_space.n_samples;
      const auto now = laws.at(problem.time_step.t, problem.old.state.history);
      std::vector<SymmetricTensor<4, 3>> result(stress_space.n_cells() * n);
      std::vector<SymmetricTensor<2, 3>> strain(n);
      fail_together(stress_space.space.communicator, [&] {
        for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
          if (const ViscoplasticLaw *law = now.law(c))
            {
              const Stiffness            &stiffness = stress_space.moduli(c);
              const SymmetricTensor<4, 3> E         = stiffness.tensor();
              stress_space.strains(c, at.ghosted_u.begin(), strain.data());
              for (unsigned int s = 0; s < n; ++s)
                result[c * n + s] =
                  algorithmic_tangent(*law,
                                      stiffness.stress(strain[s]) +
                                        at.z[c * n + s],
                                      now.mechanical(strain[s], c, s),
                                      problem.time_step.k,
                                      stiffness,
                                      now.point(c, s)) -
                  E;
            }
      });
      return result;
    }
  } // namespace



  template <int dim>
  bool
  have_symmetric_tangents(const FlowLaws<dim> &laws, const double t)
  {
    const auto now    = laws.at(t);
    bool       result = true;
    for (std::size_t c = 0; c < laws.stress_space.n_cells(); ++c)
      if (const ViscoplasticLaw *law = now.law(c))
        result &= law->has_symmetric_tangents();
    return Utilities::MPI::min(result ? 1 : 0,
                               laws.stress_space.space.communicator);
  }



  /// P (a_C + springs) P on vectors of the truncated space.
  template <int dim>
  struct NonsymmetricCorrection<dim>::Operator
  {
    const NonsymmetricCorrection             &step;
    const std::vector<SymmetricTensor<4, 3>> &flow; // C - E
    const FaceTruncation                     &truncation;
    mutable DistributedVector                 ghosted;

    void
    vmult(DistributedVector &y, const DistributedVector &x) const
    {
      const StressSpace<dim> &stress_space = step.stress_space;
      const unsigned int      n            = stress_space.n_samples;
      step.d.matrix.vmult(y, x);
      step.space.to_cartesian(x, ghosted);
      IrreversibleStress                 stress(flow.size());
      std::vector<SymmetricTensor<2, 3>> strain(n);
      for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
        {
          stress_space.strains(c, ghosted.begin(), strain.data());
          for (unsigned int s = 0; s < n; ++s)
            stress[c * n + s] = -1. * (flow[c * n + s] * strain[s]);
        }
      add_irreversible_load(stress_space, stress, y);
      if (step.face)
        {
          const FaceRestriction &restriction = step.face->restriction();
          restriction.add_springs(truncation, x, y);
          restriction.project(truncation, y);
        }
      step.space.restrict_to_unknowns(y);
    }
  };



  /// An approximate inverse for the symmetric matrix, by its solver.
  template <int dim>
  struct NonsymmetricCorrection<dim>::Preconditioner
  {
    const NonsymmetricCorrection &step;
    const FaceTruncation         &truncation;
    unsigned int                 &iterations; // of its own

    void
    vmult(DistributedVector &y, const DistributedVector &x) const
    {
      // GMRES controls the error; the preconditioner may be inaccurate.
      constexpr double tolerance = 0.1;
      y                          = 0.;
      if (!step.face)
        {
          iterations += step.solver.solve(x, y, tolerance).iterations;
          return;
        }
      iterations +=
        solve_truncated(*step.solver.begin(x, y),
                        step.face->layout(),
                        truncation,
                        /* is_kept = */ false,
                        Vector<double>(step.face->layout().n_dofs()),
                        tolerance,
                        std::numeric_limits<double>::max());
    }
  };



  template <int dim>
  NonsymmetricCorrection<dim>::NonsymmetricCorrection(
    const Discretization<dim> &discretization,
    const StepProblem<dim>    &problem,
    BulkSolver                &solver)
    : d(discretization)
    , problem(problem)
    , stress_space(d.stress_space)
    , space(d.space)
    , face(d.slipping_face())
    , solver(solver)
  {}



  template <int dim>
  FaceTruncation
  NonsymmetricCorrection<dim>::truncation(const ContactState &contact) const
  {
    if (!face)
      return {};
    const ContactLayout      &layout = face->layout();
    std::vector<Tensor<2, 3>> inverse(layout.n_nodes());
    for (unsigned int node = 0; node < layout.n_nodes(); ++node)
      inverse[node] = invert(solver.face_matrix().diagonal_block(node));
    return make_truncation(layout, contact, inverse);
  }



  template <int dim>
  DistributedVector
  NonsymmetricCorrection<dim>::residual(NewtonIterate<dim> &iterate) const
  {
    DistributedVector r(problem.load.values), product(r);
    d.matrix.vmult(product, iterate.u);
    r -= product;
    add_irreversible_load(stress_space, iterate.z, r);
    space.restrict_to_unknowns(r);
    if (face)
      {
        Vector<double> force(face->layout().n_dofs());
        fit_multipliers(face->layout(),
                        face->restriction().gather(r),
                        iterate.contact,
                        force);
        face->restriction().add(-1., force, r);
      }
    return r;
  }



  template <int dim>
  double
  NonsymmetricCorrection<dim>::dual_norm(const DistributedVector &r) const
  {
    DistributedVector v(r);
    v = 0.;
    if (!face)
      {
        solver.solve(r, v, 0.1);
        return std::sqrt(std::max(0., v * r));
      }
    // The part that begin() has solved for in the bulk, and the rest.
    const auto solve = solver.begin(r, v);
    return std::hypot(solve->energy_norm(),
                      solve->dual_norm(
                        Vector<double>(face->layout().n_dofs())));
  }



  template <int dim>
  NewtonIterate<dim>
  NonsymmetricCorrection<dim>::move(const NewtonIterate<dim> &from,
                                    const DistributedVector  &w,
                                    const double              share) const
  {
    NewtonIterate<dim> to(from);
    to.u.add(share, w);
    if (face)
      {
        const ContactLayout &layout = face->layout();
        DistributedVector    change(to.u);
        change -= problem.old_u();
        const Vector<double> x = face->restriction().gather(change);
        Vector<double>       stop(x.size());
        for (const unsigned int p : layout.friction_points())
          {
            const ContactLayout::Point &point = layout.points[p];
            Tensor<1, 2>               &s     = to.contact.slip[p];
            const Tensor<1, 3> values = layout.node_values(x, point.node);
            if (to.contact.sticks[p])
              continue;
            const Tensor<1, 2> before = s;
            s                         = to.contact.slip_with(point, p, values);
            if (to.contact.bound[p] == 0.)
              continue;
            if (before * s <= 0. && layout.has_plain_friction(point.node))
              {
                layout.add_node_values(
                  layout.node_points(point.node).size() == 1 ?
                    motion_with_slip(point, to.contact.foundation_step[p]) -
                      values :
                    -1. * motion_with_slip(point, s),
                  point.node,
                  stop);
                s = Tensor<1, 2>();
              }
            to.contact.sticks[p] = s.norm() == 0.;
          }
        for (const unsigned int o : layout.rigid(layout.obstacles()))
          if (!to.contact.sticks[o])
            {
              const ContactLayout::Point &point = layout.points[o];
              Tensor<1, 2>               &s     = to.contact.slip[o];
              s                                 = to.contact.slip_with(point,
                                       o,
                                       layout.node_values(x, point.node));
              const double beyond               = to.contact.penetration(o);
              if (beyond <= 0.)
                continue;
              layout.add_node_values(-beyond / point.map[0].norm_square() *
                                       point.map[0],
                                     point.node,
                                     stop);
              s[0]                 = to.contact.gap(o);
              to.contact.sticks[o] = true;
            }
        for (const unsigned int o : layout.compliant(layout.obstacles()))
          {
            const ContactLayout::Point &point = layout.points[o];
            to.contact.set_slip(point,
                                o,
                                layout.node_values(x, point.node) +
                                  layout.node_values(stop, point.node));
          }
        face->restriction().add(1., stop, to.u);
      }
    space.to_cartesian(to.u, to.ghosted_u);
    return to;
  }



  template <int dim>
  typename NonsymmetricCorrection<dim>::Result
  NonsymmetricCorrection<dim>::correct(const double           reduction,
                                       const StressForStrain &z_for,
                                       NewtonIterate<dim>    &iterate) const
  {
    const FaceTruncation    truncation = this->truncation(iterate.contact);
    const DistributedVector r          = residual(iterate);
    const double            before     = dual_norm(r);
    DistributedVector       w(r), right_side(r);
    w = 0.;
    if (face)
      face->restriction().project(truncation, right_side);
    Result result{0., 0};
    if (right_side.l2_norm() > 0.)
      {
        const auto       flow = flow_tangents(d.laws, iterate, problem);
        ReductionControl control(100, 0., reduction);
        try
          {
            SolverFGMRES<DistributedVector>(control).solve(
              Operator{*this, flow, truncation, space.ghosted_vector()},
              w,
              right_side,
              Preconditioner{*this, truncation, result.iterations});
          }
        catch (const SolverControl::NoConvergence &)
          {
            // The last iterate is taken if it reduces the residual.
          }
        result.iterations = std::max(result.iterations, control.last_step());
        for (double share = 1.; share > 0.1; share *= 0.5)
          {
            NewtonIterate<dim> trial = move(iterate, w, share);
            double             after;
            try
              {
                trial.z = z_for(trial.ghosted_u, iterate.z);
                after   = dual_norm(residual(trial));
              }
            catch (const ExceptionBase &)
              {
                continue; // too far: the law has no solution there
              }
            if (after <= (1. - 0.1 * share) * before)
              {
                iterate      = std::move(trial);
                result.share = share;
                break;
              }
          }
      }
    return result;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(NonsymmetricCorrection);
  VISCOPLASTIC_INSTANTIATE(have_symmetric_tangents);
} // namespace Viscoplastic
