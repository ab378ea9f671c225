// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/laws/contact_laws.h>
#include <viscoplastic_contact/parameters/parameters.h>

namespace Viscoplastic
{
  namespace
  {
    using BoundaryEntries = std::vector<BoundaryEntry>;



    template <typename Law>
    BoundaryEntry
    choice_of_law(const std::string      &name,
                  const std::string      &where,
                  const std::vector<Law> &laws,
                  const std::string      &default_law = "")
    {
      std::string help;
      for (const Law &law : laws)
        help += (help.empty() ? " `" : "; `") + law.name + "': " + law.help;
      return {name,
              "For the role contact, what acts " + where + ':' + help + '.' +
                default_law,
              "not given",
              std::make_shared<Patterns::Selection>(names_of(laws))};
    }



    template <typename Law>
    BoundaryEntries
    entries_of_laws(const std::vector<Law> &laws)
    {
      BoundaryEntries result;
      for (const LawEntry &entry : entries_of(laws))
        {
          result.push_back({entry.name, entry.help, entry.default_value});
          if (entry.is_number())
            result.back().pattern =
              std::make_shared<Patterns::Double>(entry.least);
        }
      return result;
    }



    BoundaryEntries
    joined(const std::vector<BoundaryEntries> &lists)
    {
      BoundaryEntries result;
      for (const BoundaryEntries &list : lists)
        result.insert(result.end(), list.begin(), list.end());
      return result;
    }
  } // namespace



  const std::vector<BoundaryEntry> &
  boundary_entries()
  {
    static const std::vector<BoundaryEntry> entries = joined(
      {{{"Displacement",
         "For the role displacement: components as expressions of position and "
         "t separated by semicolons; the word `free' leaves a component free. "
         "Unit: length."},
        {"Traction",
         "For the role traction, and for the role displacement in its free "
         "components: F(x,t), components separated by semicolons. Unit: "
         "stress."},
        {"Pressure",
         "As Traction, and added to it: p(x,t), which presses on the body "
         "where it is positive. F = -p nu on the faces of the mesh. Unit: "
         "stress."},
        {"Normal stiffness",
         "k_n(x) >= 0 of springs between the piece and the ground, beside "
         "traction and pressure and for the same roles: sigma nu = F - p nu - "
         "k_n u_nu nu - k_t u_tau. Ground that moves by d adds k d to the "
         "traction. Unit: stress/length."},
        {"Tangential stiffness",
         "k_t(x) >= 0 of these springs along the piece. Unit: stress/length."},
        choice_of_law(
          "Contact law",
          "along the normal",
          contact_laws(),
          " Where it is not given, it is that of the paper for the friction "
          "law: given normal stress for coulomb, otherwise bilateral."),
        {"Against",
         "For the role contact: the boundary of another body, by its name or "
         "number, that takes the place of the rigid foundation; it has the "
         "role free or traction. Displacements are then relative to it, and "
         "the initial distance is added to the gap. Give it to the side with "
         "the finer mesh, or to the smaller one. Empty for a rigid "
         "foundation."},
        {"Gap",
         "g(x,t) of unilateral contact and normal compliance: how far the "
         "undeformed body is from the foundation, measured along `Foundation "
         "normal'. Unit: length."},
        {"Foundation normal",
         "For unilateral contact and normal compliance: the direction from the "
         "body into the foundation, components separated by commas. Where it "
         "is empty, it is the outward normal of the piece, which has to be "
         "flat unless another body is opposite.",
         "",
         std::make_shared<Patterns::List>(Patterns::Double())}},
       entries_of_laws(contact_laws()),
       BoundaryEntries{
         choice_of_law("Friction law", "along the face", friction_laws())},
       entries_of_laws(friction_laws()),
       {{"Slip rate factor",
         "f(v) >= 0, by which the friction bound of tresca and coulomb is "
         "multiplied: an expression of the slip rate v (length over time) of "
         "the step before, such as `0.6 + 0.4*exp(-v/0.01)'. At t = 0, v is "
         "zero. Unit: 1.",
         "1"},
        {"Normal stress",
         "S(x,t) of given normal stress, negative in compression. Unit: "
         "stress."},
        {"Foundation displacement",
         "d(x,t) of bilateral contact: u_nu = d, nu pointing out of the body, "
         "so that d < 0 presses. In unilateral contact and normal compliance "
         "it is added to the gap. Along the face: `Foundation motion'. Unit: "
         "length.",
         "0"},
        {"Foundation motion",
         "w(x,t): how far the foundation has moved along its face since t = 0, "
         "e.g. `20*t; 0' for a conveyor. Slip is relative to it; its normal "
         "part does not count. Empty for a foundation at rest. Unit: "
         "length."}}});
    return entries;
  }



  BoundaryParameters::BoundaryParameters()
  {
    for (const BoundaryEntry &entry : boundary_entries())
      entries[entry.name] = entry.default_value;
  }
} // namespace Viscoplastic
