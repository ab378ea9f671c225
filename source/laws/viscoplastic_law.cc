// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/base/subsection.h>
#include <viscoplastic_contact/laws/viscoplastic_law.h>

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

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
    // A z in a plane scene gets the message of any unknown symbol.
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
      if (holds)
        return;
      std::ostringstream message;
      message << "'" << name << "' is " << value;
      if (depends_on_position() || depends_on_time())
        message << " at x = (" << x << "), t = " << t;
      if (depends_on_temperature())
        message << " for T = " << temperature;
      message << "; it must be " << allowed << ".";
      AssertThrow(false, ExcMessage(message.str()));
    };
    switch (range)
      {
        case Range::positive:
          check(value > 0, "positive");
          break;
        case Range::non_negative:
          check(value >= 0, "zero or positive");
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



  ViscoplasticLaw::ViscoplasticLaw(std::vector<LawParameter> parameters_)
    : parameters(std::move(parameters_))
  {
    AssertIndexRange(parameters.size(), LawPoint().parameters.size() + 1);
  }



  LawPoint
  ViscoplasticLaw::point(const Point<3> &x,
                         const double    t,
                         const double    temperature) const
  {
    LawPoint result{x, t, {}, temperature};
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
                       [](const LawParameter &p) {
                         return p.depends_on_position();
                       });
  }



  bool
  ViscoplasticLaw::has_parameters_of_temperature() const
  {
    return std::any_of(parameters.begin(),
                       parameters.end(),
                       [](const LawParameter &p) {
                         return p.depends_on_temperature();
                       });
  }



  bool
  ViscoplasticLaw::depends_on_time() const
  {
    return std::any_of(parameters.begin(),
                       parameters.end(),
                       [](const LawParameter &p) {
                         return p.depends_on_time();
                       });
  }



  void
  ViscoplasticLaw::flow(const LawStates &states, Flow *result) const
  {
    flow_at_points(*this, states, result);
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
    SymmetricTensor<4, 3>       result = 1.5 * secant * deviator_tensor<3>();
    const SymmetricTensor<2, 3> s      = deviator(stress);
    const double                length = s.norm();
    if (length > 0)
      result +=
        1.5 * (tangent - secant) * outer_product(s / length, s / length);
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

    AssertThrow(false,
                ExcMessage("There is no viscoplastic law `" + name +
                           "'; the laws are " + viscoplastic_law_names(laws) +
                           "."));
    return nullptr;
  }
} // namespace Viscoplastic
