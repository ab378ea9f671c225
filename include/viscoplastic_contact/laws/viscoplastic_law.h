// SPDX-License-Identifier: LGPL-2.1-or-later

#pragma once

#include <deal.II/base/parameter_handler.h>
#include <deal.II/base/point.h>
#include <deal.II/base/symmetric_tensor.h>

#include <viscoplastic_contact/base/expression.h>
#include <viscoplastic_contact/laws/stiffness.h>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  using namespace dealii;

  /// The subsection of the parameter file that a law is made from.
  struct LawSection
  {
    /// The handler, inside the subsection.
    const ParameterHandler &prm;

    /// The name of the section in messages, such as "Material 2/norton".
    std::string path;

    /// The dimension of the scene: in 2 dimensions there is no z.
    unsigned int dim;
  };



  /// A number in a law, such as a viscosity: an expression of x, y, (z,) t and
  /// the temperature T of the parameter file, with the range that it must have
  /// everywhere.
  class LawParameter
  {
  public:
    enum class Range
    {
      positive,
      non_negative,
      non_positive,
      at_least_one,
      poissons_ratio, // larger than -1 and smaller than 1/2
      any             // finite
    };

    /// Read @p entry of the section. Throws ExcMessage if it cannot be parsed,
    /// or is constant and out of range.
    LawParameter(const LawSection  &section,
                 const std::string &entry,
                 const Range        range);

    /// Return the value. Throws ExcMessage naming entry, value, range, place
    /// and time if it is out of range.
    double
    value(const Point<3> &x,
          const double    t,
          const double    temperature = 0.) const;

    bool
    depends_on_position() const
    {
      return expression->depends_on_position();
    }

    bool
    depends_on_time() const
    {
      return expression->depends_on_time();
    }

    bool
    depends_on_temperature() const
    {
      return expression->depends_on_additional_variable();
    }

    /// The name with its section, such as "Material 2/norton/Exponent".
    const std::string &
    get_name() const
    {
      return name;
    }

    const std::string &
    get_text() const
    {
      return text;
    }

  private:
    std::string name, text;
    Range       range;
    // Shared, since lists of parameters are copied.
    std::shared_ptr<const Expression<3>> expression;
  };



  /// The parameters of a law at a point.
  using LawParameters = std::array<double, 8>;

  /// History variables of a law at a point are stored as the independent
  /// components of a symmetric tensor. These are zero, the initial values.
  inline const SymmetricTensor<2, 3> no_history;

  /// The place (z = 0 in 2D) and time at which a law is evaluated, and the
  /// values of its parameters there, in the order of its constructor. Behind
  /// these there may be derived values, see ViscoplasticLaw::prepare(). The
  /// temperature is 0 in scenes without temperature. `history` points to
  /// history variables that the LawPoint does not own.
  struct LawPoint
  {
    Point<3>                     x;
    double                       t = 0;
    LawParameters                parameters{};
    double                       temperature = 0.;
    const SymmetricTensor<2, 3> *history     = &no_history;
  };

  /// States at several points of one body, such as those of a cell.
  struct LawStates
  {
    unsigned int                 n; // of each of these:
    const SymmetricTensor<2, 3> *stress, *strain;
    const LawPoint              *point;
    const Stiffness             &stiffness;
  };



  /// G at a state, the relaxation rate r, and whether the stress is beyond the
  /// cap of the law.
  struct Flow
  {
    SymmetricTensor<2, 3> rate;
    double                relaxation_rate = 0.;
    bool                  is_beyond_cap   = false;
  };



  /// The function G of the constitutive equation (1.1),
  ///
  ///     sigma' = E eps(u') + G(t, sigma, eps(u)),
  ///
  /// also the rate of the irreversible stress z = sigma - E eps(u). Beside z a
  /// law may remember up to six scalars alpha at each point, its history
  /// variables, with rates of their own,
  ///
  ///     alpha' = H(t, sigma, eps(u), alpha),
  ///
  /// on which G may depend. A law knows no mesh and has no state: all its
  /// functions are const and depend on their arguments only, so cells can be
  /// visited in any order and by several threads. G must be Lipschitz in stress
  /// and strain, (2.8).
  ///
  /// A new law is one file: in a shared library that the parameter file names,
  /// or in source/laws with one line in the list of
  /// source/laws/viscoplastic_law.cc, see doc/adding_a_law.md.
  class ViscoplasticLaw
  {
  public:
    virtual ~ViscoplasticLaw() = default;

    /// Return the point with the values of the parameters there. This evaluates
    /// expressions: keep the result where they do not change.
    virtual LawPoint
    point(const Point<3> &x,
          const double    t,
          const double    temperature = 0.) const;

    /// Whether point() differs from place to place at the same temperature.
    virtual bool
    depends_on_position() const;

    /// Whether a parameter is an expression of the temperature.
    virtual bool
    has_parameters_of_temperature() const;

    /// Whether G depends on the temperature: to be overridden by a law that
    /// uses point.temperature itself.
    virtual bool
    depends_on_temperature() const
    {
      return has_parameters_of_temperature();
    }

    /// Whether the temperature that the law depends on has to be absolute.
    virtual bool
    needs_absolute_temperature() const
    {
      return false;
    }

    /// Whether point() has to be called again at each time.
    virtual bool
    depends_on_time() const;

    /// Throw ExcMessage if the law is incompatible with this elastic tensor,
    /// e.g. if a long-term modulus is beyond the elastic one.
    virtual void
    check(const Stiffness & /*stiffness*/, const LawPoint & /*point*/) const
    {}

    /// Return G, stress per time. The strain excludes thermal strain.
    virtual SymmetricTensor<2, 3>
    rate(const SymmetricTensor<2, 3> &stress,
         const SymmetricTensor<2, 3> &strain,
         const Stiffness             &stiffness,
         const LawPoint              &point) const = 0;

    /// The partial derivatives of G.
    struct Tangents
    {
      /// dG/dsigma, 1/time.
      SymmetricTensor<4, 3> stress;
      /// dG/deps, stress/time.
      SymmetricTensor<4, 3> strain;
    };

    /// The derivatives of rate(). Where G has a kink, one of the one-sided
    /// derivatives, as a semismooth Newton method needs it.
    virtual Tangents
    tangents(const SymmetricTensor<2, 3> &stress,
             const SymmetricTensor<2, 3> &strain,
             const Stiffness             &stiffness,
             const LawPoint              &point) const = 0;

    /// The number of history variables: the first components of point.history.
    /// They are zero when the material begins to exist.
    const unsigned int n_history_variables;

    /// Return H = d alpha/dt in the components of the history variables.
    virtual SymmetricTensor<2, 3>
    history_rate(const SymmetricTensor<2, 3> &stress,
                 const SymmetricTensor<2, 3> &strain,
                 const Stiffness             &stiffness,
                 const LawPoint              &point) const;

    /// Backward Euler for the history variables at a given stress: the alpha
    /// that solves
    ///
    ///     alpha = point.history + k H(t, sigma, eps, alpha).
    ///
    /// The default is Newton's method with finite differences. Throws
    /// ExcMessage if there is no convergence.
    virtual SymmetricTensor<2, 3>
    history_after_step(const SymmetricTensor<2, 3> &stress,
                       const SymmetricTensor<2, 3> &strain,
                       const double                 k,
                       const Stiffness             &stiffness,
                       const LawPoint              &point) const;

    /// Return G with the history variables after a step of backward Euler from
    /// those of the point to this stress and strain.
    SymmetricTensor<2, 3>
    step_rate(const SymmetricTensor<2, 3> &stress,
              const SymmetricTensor<2, 3> &strain,
              const double                 k,
              const Stiffness             &stiffness,
              const LawPoint              &point) const
    {
      if (n_history_variables == 0)
        return rate(stress, strain, stiffness, point);
      const SymmetricTensor<2, 3> history =
        history_after_step(stress, strain, k, stiffness, point);
      LawPoint after = point;
      after.history  = &history;
      return rate(stress, strain, stiffness, after);
    }

    /// The derivatives of step_rate(); by default tangents(), or central
    /// differences for a law with history variables.
    virtual Tangents
    step_tangents(const SymmetricTensor<2, 3> &stress,
                  const SymmetricTensor<2, 3> &strain,
                  const double                 k,
                  const Stiffness             &stiffness,
                  const LawPoint              &point) const;

    /// Whether step_tangents() and tangents() depend on the point and k alone:
    /// G and H are affine in stress, strain and history.
    virtual bool
    has_constant_tangents() const
    {
      return false;
    }

    /// Whether the tangent of a step of backward Euler (algorithmic_tangent())
    /// is symmetric at all states, as it is for flow that has a potential. If
    /// not, the linear systems of a step are solved by GMRES as well.
    virtual bool
    has_symmetric_tangents() const
    {
      return false;
    }

    /// The slopes of a flow rule along the deviator, whose strain rate is 3/2
    /// f(sigma_eq) dev(stress)/sigma_eq.
    struct FlowSlopes
    {
      /// f/sigma_eq and df/dsigma_eq, 1/(stress time).
      double secant, tangent;
    };

    /// Return the slopes if f is convex and depends only on the von Mises
    /// stress sigma_eq and the point: backward Euler is then one equation for
    /// sigma_eq (radial return). Returns nothing for other flow.
    virtual std::optional<FlowSlopes>
    radial_flow(const double /*sigma_eq*/, const LawPoint & /*point*/) const
    {
      return {};
    }

    /// The rate r >= 0, 1/time, at which stress relaxes at fixed strain: at
    /// least the largest eigenvalue of -dG/dsigma at this stress, or of -d(G,
    /// H)/d(sigma, alpha) with history variables. Forward Euler is stable for
    /// time steps up to 2/r. A law whose rate may jump to a larger value within
    /// one step returns the larger one.
    virtual double
    relaxation_rate(const SymmetricTensor<2, 3> &stress,
                    const SymmetricTensor<2, 3> &strain,
                    const Stiffness             &stiffness,
                    const LawPoint              &point) const = 0;

    /// Whether the flow preserves volume. Such a flow locks volumetrically on
    /// quadrilaterals and hexahedra whatever Poisson's ratio is, so mean
    /// dilatation is the default then.
    virtual bool
    deviatoric_flow() const = 0;

    /// Return the strain A such that the flow dissipates the power -G : A. It
    /// is E^-1 sigma unless part of the energy is stored elsewhere. Not used
    /// for laws with history variables, which dissipate what they do not store.
    virtual SymmetricTensor<2, 3>
    driving_strain(const SymmetricTensor<2, 3> &stress,
                   const SymmetricTensor<2, 3> &strain,
                   const Stiffness             &stiffness,
                   const LawPoint              &point) const;

    /// Whether stored_energy() is other than 1/2 sigma : E^-1 sigma, and so
    /// driving_strain() other than E^-1 sigma.
    virtual bool
    has_own_energy() const
    {
      return false;
    }

    /// Stored energy, per volume.
    virtual double
    stored_energy(const SymmetricTensor<2, 3> &stress,
                  const SymmetricTensor<2, 3> &strain,
                  const Stiffness             &stiffness,
                  const LawPoint              &point) const;

    /// Whether the law is continued linearly beyond a cap on the stress, as a
    /// power must be to be Lipschitz.
    virtual bool
    has_cap() const
    {
      return false;
    }

    virtual bool
    is_beyond_cap(const SymmetricTensor<2, 3> & /*stress*/,
                  const LawPoint & /*point*/) const
    {
      return false;
    }

    /// Evaluate rate(), relaxation_rate() and is_beyond_cap() at all points of
    /// a cell. A step calls this once per cell; PointwiseLaw and RadialLaw
    /// implement it without virtual calls at each point.
    virtual void
    flow(const LawStates &states, Flow *result) const;

    /// What the user should know of this law at the start of a run, such as
    /// its cap; may be empty.
    virtual std::string
    announcement() const
    {
      return "";
    }

  protected:
    /// Store values derived from the parameters behind these in the point.
    virtual void
    prepare(LawPoint & /*point*/) const
    {}

    /// Points will hold the values of the parameters in this order.
    explicit ViscoplasticLaw(std::vector<LawParameter> parameters,
                             const unsigned int        n_history_variables = 0);

    const std::vector<LawParameter> parameters;
  };



  /// ViscoplasticLaw::flow() point by point. For a class that is final the
  /// calls are not virtual, and are inlined.
  template <typename Law>
  void
  flow_at_points(const Law &law, const LawStates &states, Flow *result)
  {
    for (unsigned int i = 0; i < states.n; ++i)
      {
        const SymmetricTensor<2, 3> &stress = states.stress[i],
                                    &strain = states.strain[i];
        const LawPoint &point               = states.point[i];
        result[i].rate = law.rate(stress, strain, states.stiffness, point);
        result[i].relaxation_rate =
          law.relaxation_rate(stress, strain, states.stiffness, point);
        result[i].is_beyond_cap = law.is_beyond_cap(stress, point);
      }
  }



  /// The derivative, with respect to stress, of the strain rate
  /// 3/2 f dev(stress)/sigma_eq of a flow along the deviator, where f depends
  /// on the von Mises stress sigma_eq. @p secant is f/sigma_eq and @p tangent
  /// is df/dsigma_eq, both 1/(stress time): along the deviator the strain rate
  /// grows with the tangent; across it, it only turns.
  SymmetricTensor<4, 3>
  flow_tangent(const SymmetricTensor<2, 3> &stress,
               const double                 secant,
               const double                 tangent);



  /// The entry of the registry for a law: name, help text, parameters and
  /// constructor.
  struct LawDescription
  {
    /// The value of the entry `Law`, and the name of the law's subsection.
    std::string name;

    /// The manual entry: formula, meaning, units, reference.
    std::string help;

    /// Declares the entries of the law; called inside its subsection.
    std::function<void(ParameterHandler &)> declare;

    /// Reads and checks these entries.
    std::function<std::unique_ptr<ViscoplasticLaw>(const LawSection &)> make;
  };

  /// The laws of the program. The functions below also accept lists with laws
  /// of shared libraries.
  const std::vector<LawDescription> &
  built_in_laws();

  /// The allowed values of the entry `Law` as for Patterns::Selection:
  /// `elastic` and the laws, separated by `|`.
  std::string
  viscoplastic_law_names(
    const std::vector<LawDescription> &laws = built_in_laws());

  /// The manual entries of `elastic` and all laws, one paragraph each.
  std::string
  viscoplastic_law_help(
    const std::vector<LawDescription> &laws = built_in_laws());

  /// Declares one subsection per law inside the current subsection.
  void
  declare_viscoplastic_law_parameters(
    ParameterHandler                  &prm,
    const std::vector<LawDescription> &laws = built_in_laws());

  /// The law of this name, with the parameters of its subsection of the
  /// current subsection, which @p section names in messages; @p dim is the
  /// dimension of the scene. Null for `elastic`: a body without viscosity has
  /// no law object and no irreversible stress. Throws ExcMessage for an unknown
  /// name and for parameters outside their range.
  std::unique_ptr<ViscoplasticLaw>
  make_viscoplastic_law(
    const std::string                 &name,
    ParameterHandler                  &prm,
    const std::string                 &section = "Material",
    const unsigned int                 dim     = 3,
    const std::vector<LawDescription> &laws    = built_in_laws());
} // namespace Viscoplastic
