// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/run_summary.h>

#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  namespace
  {
    std::string
    number(const double value)
    {
      std::ostringstream text;
      text << std::setprecision(5) << value;
      return text.str();
    }



    template <int dim>
    std::string
    components(const Tensor<1, dim> &vector)
    {
      std::string text = number(vector[0]);
      for (unsigned int d = 1; d < dim; ++d)
        text += "; " + number(vector[d]);
      return text;
    }



    void
    print_row(std::ostream      &out,
              const std::string &name,
              const std::string &value)
    {
      out << "  " << std::left << std::setw(26) << name << std::right << value
          << '\n';
    }
  } // namespace



  template <int dim>
  void
  RunSummary<dim>::print(std::ostream &out) const
  {
    out << "At t = " << number(t) << ":\n";
    if (friction_force)
      print_row(out, "friction force", components(*friction_force));
    for (const auto &[id, force] : reactions)
      print_row(out,
                "reaction of boundary " + std::to_string(id),
                components(force));
    print_row(out, "external work", number(external_work));
    print_row(out, "stored energy", number(stored_energy));
    if (viscous_dissipation)
      print_row(out, "viscous dissipation", number(*viscous_dissipation));
    if (friction_dissipation)
      print_row(out, "friction dissipation", number(*friction_dissipation));
    if (adaptation_energy)
      print_row(out, "energy from new meshes", number(*adaptation_energy));
    print_row(out, "energy balance defect", number(energy_balance_defect));
    if (error_estimate)
      print_row(out, "error estimate", number(*error_estimate));

    const auto with_time = [](const Largest &largest) {
      return number(largest.value) + " at t = " + number(largest.t);
    };
    out << "Largest in the run:\n";
    print_row(out, "displacement", with_time(displacement));
    print_row(out, "von Mises stress", with_time(von_mises));
    if (friction_force)
      print_row(out,
                "slipping area",
                number(slip_area.value) + " of " + number(friction_area) +
                  " at t = " + number(slip_area.t));
    if (capped_volume.value > 0.)
      print_row(out, "volume beyond the cap", with_time(capped_volume));
    const auto error =
      [&](const std::string &name, const double value, const double norm) {
        if (norm > 0.)
          print_row(out,
                    "error of " + name,
                    number(value) + " (" + number(100. * value / norm) +
                      " % of the exact solution)");
      };
    error("u in energy", largest_error.energy, largest_exact.energy);
    error("u in H1", largest_error.h1, largest_exact.h1);
    error("stress in L2", largest_error.stress, largest_exact.stress);
    error("multiplier in L2",
          largest_error.multiplier,
          largest_exact.multiplier);
  }



  void
  print_seconds(std::ostream                        &out,
                const std::map<std::string, double> &seconds,
                const double                         first_set_up,
                const double                         total,
                const bool                           has_viscosity,
                const bool                           has_friction)
  {
    // In this order; phases without a text follow under their own names.
    const std::vector<std::pair<std::string, std::string>> texts{
      {"set-up", "spaces, matrix, factorisation or multigrid"},
      {"rate", "viscosity: flow of the law in all cells"},
      {"load", "loads and prescribed displacements"},
      {"contact",
       has_friction ? "friction and elasticity together: all solves" :
                      "elasticity: linear solves"},
      {"estimate", "adaptivity: error estimate"},
      {"adaptation", "adaptivity: new meshes with their set-up"},
      {"balance", "energies, reactions, statistics.csv"},
      {"output", "fields for ParaView"},
      {"checkpoint", "checkpoints"}};
    std::map<std::string, double> remaining(seconds);
    double                        rest = total;

    const auto print_phase =
      [&](const std::string &name, const double time, const std::string &text) {
        std::ostringstream digits;
        digits << std::fixed << std::setprecision(3) << time;
        out << "  " << std::left << std::setw(12) << name << std::right
            << std::setw(9) << digits.str() << std::setw(5)
            << std::lround(total > 0. ? 100. * time / total : 0.) << " %"
            << (text.empty() ? "" : "  ") << text << '\n';
        rest -= time;
      };
    out << "Seconds by phase:\n";
    if (!has_viscosity)
      remaining.erase("rate");
    if (remaining.count("set-up") > 0)
      remaining["set-up"] = first_set_up;
    for (const auto &[name, text] : texts)
      {
        const auto phase = remaining.find(name);
        if (phase == remaining.end())
          continue;
        print_phase(name, phase->second, text);
        remaining.erase(phase);
      }
    for (const auto &[name, time] : remaining)
      print_phase(name, time, "");
    const double others = rest;
    print_phase("rest", others, "mesh, initial state, progress");
    print_phase("whole run", total, "");
  }



  template struct RunSummary<2>;
  template struct RunSummary<3>;
} // namespace Viscoplastic
