// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// How a foundation that gives way presses at the penetration w > 0: by p =
  /// k phi(w) with k >= 0, phi(0) = 0, and a slope phi' > 0 that does not fall.
  struct PressureLaw
  {
    /// p, dp/dw and int_0^w p for k and w; w for k and p.
    std::function<double(double, double)> force, slope, energy, penetration;
  };

  /// p = k w^m with m >= 1 (Oden and Martins, Comput. Methods Appl. Mech. Eng.
  /// 52, 1985).
  PressureLaw
  power_pressure(double exponent);


  /// What has a name in a list; null if nothing has it.
  template <typename Named>
  const Named *
  find_named(const std::vector<Named> &list, const std::string &name)
  {
    for (const Named &one : list)
      if (one.name == name)
        return &one;
    return nullptr;
  }


  /// An entry of a law in the section of a boundary: an expression that must
  /// not be negative, or, if it has a default, a number.
  struct LawEntry
  {
    std::string name, help;
    /// Whether what it adds to a friction bound is multiplied by the pressure.
    bool        of_pressure   = false;
    std::string default_value = {};
    double      least         = 0.;

    bool
    is_number() const
    {
      return !default_value.empty();
    }
  };

  /// What contact laws and friction laws have.
  struct LawOfBoundary
  {
    /// As in parameter files; what it means; what a run calls it.
    std::string           name, help, words;
    std::vector<LawEntry> entries = {};

    bool
    has(const std::string &entry) const
    {
      return find_named(entries, entry) != nullptr;
    }
  };

  /// What acts along the normal of a boundary in contact. Where the foundation
  /// gives way, entries are k(x) and the numbers of which make() makes the
  /// pressure.
  struct ContactLaw : LawOfBoundary
  {
    enum class Kind
    {
      bilateral,    // u_nu = d
      given_stress, // sigma_nu = S
      unilateral    // u_n <= g + d, or p(u_n - g - d) where it gives way
    };
    Kind                                                    kind;
    std::function<PressureLaw(const std::vector<double> &)> make = {};
  };

  /// What acts along the face: friction with the bound rho, the sum of the
  /// entries, functions of x and t, those times the pressure that are
  /// `of_pressure'. No friction without entries.
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

  /// All of them, in the order of their names in parameter files.
  const std::vector<ContactLaw> &
  contact_laws();

  const std::vector<FrictionLaw> &
  friction_laws();

  /// "not given", and the names of laws, with bars between.
  template <typename Law>
  std::string
  names_of(const std::vector<Law> &laws)
  {
    std::string names = "not given";
    for (const Law &law : laws)
      names += '|' + law.name;
    return names;
  }

  /// The entries of laws; those that share some have them in the same order.
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
