// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <string>

namespace Viscoplastic
{
  using namespace dealii;

  /// Enters a subsection and leaves it on destruction, also after exceptions.
  class Subsection
  {
  public:
    Subsection(ParameterHandler &prm, const std::string &name)
      : prm(prm)
    {
      prm.enter_subsection(name);
    }

    ~Subsection()
    {
      prm.leave_subsection();
    }

    Subsection(const Subsection &) = delete;

  private:
    ParameterHandler &prm;
  };
} // namespace Viscoplastic
