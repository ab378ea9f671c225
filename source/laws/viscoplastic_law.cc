// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/lac/vector.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/subsection.h>
#include <viscoplastic_contact/laws/viscoplastic_law.h>

#include <algorithm>
#include <utility>

// The registry, one line a law: the file source/laws/<name>.cc defines
// <name>_description(). It is a list, not a set of self-registering objects: a
// linker drops object files of a static library that nobody refers to, and with
// them laws would silently disappear.
// clang-format off
#define VISCOPLASTIC_LAWS(LAW) \
  LAW(maxwell)                 \
  LAW(zener)                   \
  LAW(perzyna)                 \
  LAW(norton)                  \
  LAW(burgers)                 \
  LAW(lubby2)                  \
  LAW(parsed)
// clang-format on

namespace Viscoplastic
{
#define DECLARE_LAW(name) LawDescription name##_description();
  VISCOPLASTIC_LAWS(DECLARE_LAW)
#undef DECLARE_LAW

  namespace
  {
    const std::string elastic_name = "elastic";
  } // namespace



  const std::vector<LawDescription> &
  built_in_laws()
  {
#define DESCRIBE_LAW(name) name##_description(),
    static const std::vector<LawDescription> laws = {
      VISCOPLASTIC_LAWS(DESCRIBE_LAW)};
#undef DESCRIBE_LAW
    return laws;
  }



  LawParameter::LawParameter(const LawSection  &section,
                             const std::string &entry,
                             const Range        range)
    : name(section.path + "/" + entry)
    , text(section.prm.get(entry))
    , range(range)
  {
    // In a plane scene, z is refused like any unknown symbol.
    if (section.dim == 2)
      Expression<2>(text, name, "x,y,T");
    expression = std::make_shared<Expression<3>>(text, name, "x,y,z,T");
    if (!depends_on_position() && !depends_on_time() &&
        !depends_on_temperature())
      value(Point<3>(), 0.);
  }



  double
  LawParameter::value(const Point<3> &x,
                      const double    t,
                      const double    temperature) const
  {
    const double value = expression->value(x, t, temperature);

    const auto check = [&](const bool holds, const std::string &allowed) {
      if (!holds)
        refuse(
          "'" + name + "' is " + as_text(value) +
          (depends_on_position() || depends_on_time() ?
             " at x = (" + as_text(x) + "), t = " + as_text(t) :
             "") +
          (depends_on_temperature() ? " for T = " + as_text(temperature) : "") +
          "; it must be " + allowed + ".");
    };
    switch (range)
      {
        case Range::positive:
          check(value > 0, "positive");
          break;
        case Range::non_negative:
          check(value >= 0, "zero or positive");
          break;
        case Range::non_positive:
          check(value <= 0, "zero or negative");
          break;
        case Range::at_least_one:
          check(value >= 1, "at least 1");
          break;
        case Range::poissons_ratio:
          check(value > -1 && value < 0.5,
                "larger than -1 and smaller than 0.5");
          break;
        case Range::any:
          break;
      }
    return value;
  }



  ViscoplasticLaw::ViscoplasticLaw(std::vector<LawParameter> parameters_,
                                   const unsigned int n_history_variables)
    : n_history_variables(n_history_variables)
    , parameters(std::move(parameters_))
  {
    AssertIndexRange(parameters.size(), LawPoint().parameters.size() + 1);
    if (n_history_variables > no_history.n_independent_components)
      refuse("A law has " + std::to_string(n_history_variables) +
             " history variables; six are the most.");
  }



  LawPoint
  ViscoplasticLaw::point(const Point<3> &x,
                         const double    t,
                         const double    temperature) const
  {
    LawPoint result{x, t, {}, temperature, &no_history};
    for (unsigned int i = 0; i < parameters.size(); ++i)
      result.parameters[i] = parameters[i].value(x, t, temperature);
    prepare(result);
    return result;
  }



  bool
  ViscoplasticLaw::depends_on_position() const
  {
    return std::any_of(parameters.begin(),
                       parameters.end(),
                       std::mem_fn(&LawParameter::depends_on_position));
  }



  bool
  ViscoplasticLaw::has_parameters_of_temperature() const
  {
    return std::any_of(parameters.begin(),
                       parameters.end(),
                       std::mem_fn(&LawParameter::depends_on_temperature));
  }



  bool
  ViscoplasticLaw::depends_on_time() const
  {
    return std::any_of(parameters.begin(),
                       parameters.end(),
                       std::mem_fn(&LawParameter::depends_on_time));
  }



  void
  ViscoplasticLaw::flow(const LawStates &states, Flow *result) const
  {
    flow_at_points(*this, states, result);
  }



  SymmetricTensor<2, 3>
  ViscoplasticLaw::history_rate(const SymmetricTensor<2, 3> & /*stress*/,
                                const SymmetricTensor<2, 3> & /*strain*/,
                                const Stiffness & /*stiffness*/,
                                const LawPoint & /*point*/) const
  {
    return {};
  }



  SymmetricTensor<2, 3>
  ViscoplasticLaw::history_after_step(const SymmetricTensor<2, 3> &stress,
                                      const SymmetricTensor<2, 3> &strain,
                                      const double                 k,
                                      const Stiffness             &stiffness,
                                      const LawPoint              &point) const
  {
    const unsigned int    n     = n_history_variables;
    LawPoint              there = point;
    SymmetricTensor<2, 3> alpha = *point.history;
    there.history               = &alpha;
    const auto increment        = [&] {
      return k * history_rate(stress, strain, stiffness, there);
    };
    const auto residual = [&] { return alpha - *point.history - increment(); };
    SymmetricTensor<2, 3> F = residual();
    for (unsigned int iteration = 0; iteration < 50 && std::isfinite(F.norm());
         ++iteration)
      {
        // Differences have the scale of each variable, or the common scale of
        // all if a variable is zero.
        const SymmetricTensor<2, 3> from = alpha;
        const double scale = from.norm() + point.history->norm() + F.norm();
        if (F.norm() <= 1e-14 * scale)
          return alpha;
        FullMatrix<double> jacobian(n, n);
        Vector<double>     right_side(n), step(n);
        for (unsigned int j = 0; j < n; ++j)
          {
            const double own = std::fabs(from.access_raw_entry(j)) +
                               std::fabs(F.access_raw_entry(j)),
                         h = 1e-6 * (own > 0. ? own : scale);
            alpha.access_raw_entry(j) += h;
            const SymmetricTensor<2, 3> change = residual() - F;
            alpha                              = from;
            for (unsigned int i = 0; i < n; ++i)
              jacobian(i, j) = change.access_raw_entry(i) / h;
            right_side[j] = -F.access_raw_entry(j);
          }
        jacobian.gauss_jordan();
        jacobian.vmult(step, right_side);
        const double before = F.norm();
        for (double share = 1.; share > 1e-6; share *= 0.5)
          {
            for (unsigned int i = 0; i < n; ++i)
              alpha.access_raw_entry(i) =
                from.access_raw_entry(i) + share * step[i];
            F = residual();
            if (F.norm() < before)
              break;
          }
        if (!(F.norm() < before)) // stagnation
          {
            if (before <= 1e-10 * scale)
              return from;
            break;
          }
      }
    refuse("The history variables of a step of backward Euler cannot be found; "
           "take shorter steps.");
  }



  ViscoplasticLaw::Tangents
  ViscoplasticLaw::step_tangents(const SymmetricTensor<2, 3> &stress,
                                 const SymmetricTensor<2, 3> &strain,
                                 const double                 k,
                                 const Stiffness             &stiffness,
                                 const LawPoint              &point) const
  {
    if (n_history_variables == 0)
      return tangents(stress, strain, stiffness, point);
    Tangents   result;
    const auto differentiate = [&](SymmetricTensor<4, 3>       &derivative,
                                   const SymmetricTensor<2, 3> &at,
                                   const double                 least,
                                   const auto                  &G) {
      const double h = 1e-5 * std::max(at.norm(), least);
      for (unsigned int j = 0; j < 6; ++j)
        {
          SymmetricTensor<2, 3> left = at, right = at;
          left.access_raw_entry(j) -= h;
          right.access_raw_entry(j) += h;
          // A raw shear entry stands for two tensor entries: halve the slope.
          const SymmetricTensor<2, 3> slope =
            (G(right) - G(left)) / ((j < 3 ? 2. : 4.) * h);
          for (unsigned int i = 0; i < 6; ++i)
            derivative.access_raw_entry(6 * i + j) = slope.access_raw_entry(i);
        }
    };
    differentiate(result.stress,
                  stress,
                  1e-6 * stiffness.largest_deviatoric_eigenvalue(),
                  [&](const SymmetricTensor<2, 3> &there) {
                    return step_rate(there, strain, k, stiffness, point);
                  });
    differentiate(result.strain,
                  strain,
                  1e-6,
                  [&](const SymmetricTensor<2, 3> &there) {
                    return step_rate(stress, there, k, stiffness, point);
                  });
    return result;
  }



  SymmetricTensor<2, 3>
  ViscoplasticLaw::driving_strain(const SymmetricTensor<2, 3> &stress,
                                  const SymmetricTensor<2, 3> & /*strain*/,
                                  const Stiffness &stiffness,
                                  const LawPoint & /*point*/) const
  {
    return stiffness.strain(stress);
  }



  double
  ViscoplasticLaw::stored_energy(const SymmetricTensor<2, 3> &stress,
                                 const SymmetricTensor<2, 3> & /*strain*/,
                                 const Stiffness &stiffness,
                                 const LawPoint & /*point*/) const
  {
    return 0.5 * (stress * stiffness.strain(stress));
  }



  SymmetricTensor<4, 3>
  flow_tangent(const SymmetricTensor<2, 3> &stress,
               const double                 secant,
               const double                 tangent)
  {
    SymmetricTensor<2, 3> n      = deviator(stress);
    const double          length = n.norm(), across = 1.5 * secant;
    double                more_along = 0.;
    if (length > 0.)
      {
        n /= length;
        more_along = 1.5 * (tangent - secant);
      }
    // By components, in a tenth of the time of operators.
    SymmetricTensor<4, 3> result;
    double *const         entry = result.begin_raw();
    const double *const   x     = n.begin_raw();
    for (unsigned int i = 0; i < 6; ++i)
      for (unsigned int j = 0; j < 6; ++j)
        entry[6 * i + j] = more_along * (x[i] * x[j]);
    for (unsigned int i = 0; i < 3; ++i)
      {
        for (unsigned int j = 0; j < 3; ++j)
          entry[6 * i + j] -= across / 3.;
        entry[7 * i] += across;
        entry[7 * (3 + i)] += 0.5 * across;
      }
    return result;
  }



  std::string
  viscoplastic_law_names(const std::vector<LawDescription> &laws)
  {
    std::string names = elastic_name;
    for (const LawDescription &law : laws)
      names += "|" + law.name;
    return names;
  }



  std::string
  viscoplastic_law_help(const std::vector<LawDescription> &laws)
  {
    std::string help =
      elastic_name + ": G = 0, linear elasticity without viscosity.";
    for (const LawDescription &law : laws)
      help += "\n\n" + law.name + ": " + law.help;
    return help;
  }



  void
  declare_viscoplastic_law_parameters(ParameterHandler                  &prm,
                                      const std::vector<LawDescription> &laws)
  {
    for (const LawDescription &law : laws)
      {
        const Subsection subsection(prm, law.name);
        law.declare(prm);
      }
  }



  std::unique_ptr<ViscoplasticLaw>
  make_viscoplastic_law(const std::string                 &name,
                        ParameterHandler                  &prm,
                        const std::string                 &section,
                        const unsigned int                 dim,
                        const std::vector<LawDescription> &laws)
  {
    if (name == elastic_name)
      return nullptr;

    for (const LawDescription &law : laws)
      if (law.name == name)
        {
          const Subsection subsection(prm, law.name);
          return law.make({prm, section + "/" + law.name, dim});
        }

    refuse("There is no viscoplastic law `" + name + "'; the laws are " +
           viscoplastic_law_names(laws) + ".");
  }
} // namespace Viscoplastic
