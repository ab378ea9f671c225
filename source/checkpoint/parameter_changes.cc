// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/spelling.h>
#include <viscoplastic_contact/checkpoint/parameter_changes.h>

#include <algorithm>

namespace Viscoplastic
{
  namespace
  {
    /// Whether an entry decides what the unknowns are and what they mean.
    bool
    is_fixed(const std::string &path)
    {
      const std::size_t slash   = path.find('/');
      const std::string section = path.substr(0, slash),
                        entry   = slash == std::string::npos ?
                                    "" :
                                    path.substr(slash + 1);
      const auto is_one_of = [&entry](const std::vector<std::string> &names) {
        return std::find(names.begin(), names.end(), entry) != names.end();
      };
      const std::string kind = section.substr(0, section.find(' '));
      // The coarse mesh is compared as such.
      if (section == "Geometry")
        return entry != "File";
      if (kind == "Material")
        return is_one_of({"Young's modulus",
                          "Poisson's ratio",
                          "Voigt matrix",
                          "Law",
                          "Thermal expansion",
                          "Added at",
                          "Removed at",
                          "Volumetric integration",
                          "Stress history"});
      // What is in the file counts.
      if (kind == "Table")
        return entry != "File";
      if (kind == "Boundary")
        return is_one_of({"Role",
                          "Contact law",
                          "Foundation normal",
                          "Friction law",
                          "Compliance",
                          "Compliance exponent",
                          "Normal stiffness",
                          "Tangential stiffness"});
      return section == "Initial state" || section == "Dimension" ||
             section == "Units" || section == "Supports" ||
             path == "Temperature/Reference temperature" ||
             path == "Mesh refinement/Strategy" || path == "Output/Points" ||
             path == "Output/Point fields" || path == "Output/Lines" ||
             path == "Output/Line fields" || path == "Output/Integrals" ||
             path == "Error control/Error bar" ||
             path == "Error control/Quantity";
    }



    /// Whether a run gets a tolerance, or loses the one that it has: meshes and
    /// schemes are others then. It may get another one.
    bool
    is_switched(const std::string &path,
                const std::string &old_value,
                const std::string &value)
    {
      return path == "Error control/Tolerance" &&
             (Utilities::string_to_double(old_value) > 0.) !=
               (Utilities::string_to_double(value) > 0.);
    }
  } // namespace



  ParameterChanges
  compare_parameters(const std::map<std::string, std::string> &old_values,
                     const std::map<std::string, std::string> &new_values)
  {
    ParameterChanges changes;
    const auto       quoted = [](const std::string &value) {
      return value.empty() ? "empty" : excerpt(value);
    };
    for (const auto &[path, value] : new_values)
      {
        const auto old = old_values.find(path);
        if (old == old_values.end())
          changes.forbidden.push_back("'" + path + "' is new");
        else if (old->second != value)
          {
            (is_fixed(path) || is_switched(path, old->second, value) ?
               changes.forbidden :
               changes.allowed)
              .push_back("'" + path + "' is " + quoted(value) + " (was " +
                         quoted(old->second) + ")");
            for (const std::string section : {"Boundary",
                                              "Material",
                                              "Loads",
                                              "Temperature",
                                              "Exact solution"})
              changes.of_data |= path.compare(0, section.size(), section) == 0;
          }
      }
    for (const auto &[path, value] : old_values)
      if (new_values.count(path) == 0)
        changes.forbidden.push_back("'" + excerpt(path) + "' is gone (was " +
                                    quoted(value) + ")");
    return changes;
  }
} // namespace Viscoplastic
