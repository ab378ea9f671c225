// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// The pressure of a deformable foundation at a penetration w > 0, which is p
  /// = k phi(w) with k >= 0, phi(0) = 0, and a nondecreasing slope phi' > 0.
  struct PressureLaw
  {
    /// p, dp/dw and int_0^w p as functions of (k, w); w as one of (k, p).
    std::function<double(double, double)> force, slope, energy, penetration;
  };

  /// p = k w^m with m >= 1 (Oden and Martins, Comput. Methods Appl. Mech. Eng.
  /// 52, 1985).
  PressureLaw
  power_pressure(double exponent);


  /// Return the element with this name, or null if there is none.
  template <typename Named>
  const Named *
  find_named(const std::vector<Named> &list, const std::string &name)
  {
    for (const Named &one : list)
      if (one.name == name)
        return &one;
    return nullptr;
  }


  /// An entry of a law in the section of a boundary: a nonnegative expression
  /// or, if it has a default value, a number not below `least`.
  struct LawEntry
  {
    std::string name, help;
    /// Whether its term in the friction bound is multiplied by the pressure.
    bool        of_pressure   = false;
    std::string default_value = {};
    double      least         = 0.;

    bool
    is_number() const
    {
      return !default_value.empty();
    }
  };

  /// The common part of contact laws and friction laws.
  struct LawOfBoundary
  {
    /// The name in parameter files, its meaning, and the name in output.
    std::string           name, help, words;
    std::vector<LawEntry> entries = {};

    bool
    has(const std::string &entry) const
    {
      return find_named(entries, entry) != nullptr;
    }
  };

  /// A contact condition in normal direction. For a deformable foundation, the
  /// entries are k(x) and the numbers from which make() makes the pressure law.
  struct ContactLaw : LawOfBoundary
  {
    enum class Kind
    {
      bilateral,    // u_nu = d
      given_stress, // sigma_nu = S
      unilateral    // u_n <= g + d, or p(u_n - g - d) if deformable
    };
    Kind                                                    kind;
    std::function<PressureLaw(const std::vector<double> &)> make = {};
  };

  /// A friction law with the bound rho(x,t), the sum of its entries, of which
  /// those with `of_pressure` are multiplied by the pressure. Without entries
  /// there is no friction.
  struct FrictionLaw : LawOfBoundary
  {
    /// No slip whatever the force: rho = infinity.
    bool is_glued = false;

    bool
    follows_pressure() const
    {
      return std::any_of(entries.begin(), entries.end(), [](const auto &one) {
        return one.of_pressure;
      });
    }
  };

  /// All laws, in the order in which parameter files list their names.
  const std::vector<ContactLaw> &
  contact_laws();

  const std::vector<FrictionLaw> &
  friction_laws();

  /// Return "not given" and the names of the laws, separated by bars.
  template <typename Law>
  std::string
  names_of(const std::vector<Law> &laws)
  {
    std::string names = "not given";
    for (const Law &law : laws)
      names += '|' + law.name;
    return names;
  }

  /// Return the entries of all laws without repetitions. Laws that share
  /// entries must have them in the same order.
  template <typename Law>
  std::vector<LawEntry>
  entries_of(const std::vector<Law> &laws)
  {
    std::vector<LawEntry> result;
    for (const Law &law : laws)
      for (const LawEntry &entry : law.entries)
        if (find_named(result, entry.name) == nullptr)
          result.push_back(entry);
    return result;
  }
} // namespace Viscoplastic
