// SPDX-License-Identifier: LGPL-2.1-or-later

#include <viscoplastic_contact/viscoplastic_law.h>

#include <cmath>
#include <vector>

namespace Viscoplastic
{
  // Each is defined in the file of its law.
  LawDescription
  maxwell_description();
  LawDescription
  perzyna_description();

  namespace
  {
    /**
     * The registry. It is a list, not a set of self-registering objects: a
     * linker drops object files of a static library that nobody refers to, and
     * with them laws would silently disappear.
     */
    const std::vector<LawDescription> &
    registered_laws()
    {
      static const std::vector<LawDescription> laws = {maxwell_description(),
                                                       perzyna_description()};
      return laws;
    }

    const std::string elastic_name = "elastic";



    /// Leaves the subsection also when a law refuses its parameters.
    class SubsectionGuard
    {
    public:
      SubsectionGuard(ParameterHandler &prm, const std::string &name)
        : prm(prm)
      {
        prm.enter_subsection(name);
      }

      ~SubsectionGuard()
      {
        prm.leave_subsection();
      }

      SubsectionGuard(const SubsectionGuard &) = delete;
      SubsectionGuard &
      operator=(const SubsectionGuard &) = delete;

    private:
      ParameterHandler &prm;
    };



    std::string
    refusal(const ParameterHandler &prm,
            const std::string      &law,
            const std::string      &entry,
            const std::string      &allowed)
    {
      return "The entry `" + entry + "' of the subsection `" + law + "' is " +
             prm.get(entry) + "; it must be " + allowed + ".";
    }
  } // namespace



  std::string
  viscoplastic_law_names()
  {
    std::string names = elastic_name;
    for (const LawDescription &law : registered_laws())
      names += "|" + law.name;
    return names;
  }



  std::string
  viscoplastic_law_help()
  {
    std::string help =
      elastic_name + ": G = 0, linear elasticity without viscosity.";
    for (const LawDescription &law : registered_laws())
      help += "\n\n" + law.name + ": " + law.help;
    return help;
  }



  void
  declare_viscoplastic_law_parameters(ParameterHandler &prm)
  {
    for (const LawDescription &law : registered_laws())
      {
        const SubsectionGuard guard(prm, law.name);
        law.declare(prm);
      }
  }



  std::unique_ptr<ViscoplasticLaw>
  make_viscoplastic_law(const std::string &name, ParameterHandler &prm)
  {
    if (name == elastic_name)
      return nullptr;

    for (const LawDescription &law : registered_laws())
      if (law.name == name)
        {
          const SubsectionGuard guard(prm, law.name);
          return law.make(prm);
        }

    AssertThrow(false,
                ExcMessage("There is no viscoplastic law `" + name +
                           "'; the laws are " + viscoplastic_law_names() +
                           "."));
    return nullptr;
  }



  double
  get_positive(const ParameterHandler &prm,
               const std::string      &law,
               const std::string      &entry)
  {
    const double value = prm.get_double(entry);
    AssertThrow(value > 0 && std::isfinite(value),
                ExcMessage(refusal(prm, law, entry, "positive and finite")));
    return value;
  }



  double
  get_non_negative(const ParameterHandler &prm,
                   const std::string      &law,
                   const std::string      &entry)
  {
    const double value = prm.get_double(entry);
    AssertThrow(value >= 0 && std::isfinite(value),
                ExcMessage(
                  refusal(prm, law, entry, "zero or positive, and finite")));
    return value;
  }
} // namespace Viscoplastic
