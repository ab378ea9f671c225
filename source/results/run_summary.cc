// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/results/run_summary.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <regex>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    void
    print_row(std::ostream      &out,
              const std::string &name,
              const std::string &value)
    {
      // Names of places may be wider than the column.
      out << "  " << std::left << std::setw(25) << name << std::right << ' '
          << value << '\n';
    }


    /// Return numbers with a unit, with an SI prefix chosen for large or small
    /// ones: 0.2 mm for 0.0002 m.
    std::string
    with_unit(const std::vector<double> &values, std::string unit)
    {
      double largest = 0., scale = 1.;
      for (const double value : values)
        largest = std::max(largest, std::abs(value));
      static const std::regex  prefixed("([numkMGTP]?)(m|N|J|Pa)(/.*)?");
      static const std::string prefixes[]{
        "n", "u", "m", "", "k", "M", "G", "T", "P"};
      constexpr int n_prefixes = std::size(prefixes);
      std::smatch   match;
      if (largest > 0. && (largest < 1. || largest >= 1e4) &&
          std::regex_match(unit, match, prefixed))
        {
          int which =
            std::find(prefixes, prefixes + n_prefixes, match[1]) - prefixes;
          const int last = match[2] == "m" ? 4 : n_prefixes - 1;
          for (; which > 0 && largest / scale < 1.; --which)
            scale *= 1e-3;
          for (; which < last && largest / scale >= 1e3; ++which)
            scale *= 1e3;
          unit = prefixes[which] + match[2].str() + match[3].str();
        }
      std::string text;
      for (const double value : values)
        text += (text.empty() ? "" : "; ") + number(value / scale);
      return text + (unit.empty() ? "" : ' ' + unit);
    }



    std::string
    with_unit_of_time(const double t, const Units &units)
    {
      return number(t) + units.suffix(Quantity::time);
    }



    /// Print the quantities at the end of the run.
    template <int dim>
    void
    print_end(std::ostream          &out,
              const Units           &units,
              const PlaceNames      &names,
              const RunSummary<dim> &run)
    {
      out << "At t = " << with_unit_of_time(run.t, units) << ":\n";
      // Forces below this part of the largest are solver errors and print as 0.
      constexpr double noise         = 1e-5;
      double           largest_force = 0.;
      for (const StatisticsRow::Entry &entry : run.at_end)
        if (entry.quantity == Quantity::force)
          for (const double force : entry.values)
            largest_force = std::max(largest_force, std::abs(force));
      for (const StatisticsRow::Entry &entry : run.at_end)
        {
          // The mesh may have changed in earlier passes only.
          if (entry.name == "adaptation_energy" && entry.values[0] == 0.)
            continue;
          std::vector<double> values = entry.values;
          for (double &value : values)
            if (entry.quantity == Quantity::force &&
                std::abs(value) < noise * largest_force)
              value = 0.;
          print_row(out,
                    names.words(entry.name),
                    with_unit(values, units.name(entry.quantity, dim)));
        }
      if (run.error_estimate)
        print_row(out, "error estimate", number(*run.error_estimate));
    }



    /// Print the largest values of the run.
    template <int dim>
    void
    print_largest(std::ostream          &out,
                  const Units           &units,
                  const RunSummary<dim> &run)
    {
      const auto at_time = [&](const Largest &largest,
                               const Quantity quantity) {
        return with_unit({largest.value}, units.name(quantity, dim)) +
               " at t = " + with_unit_of_time(largest.t, units);
      };
      const auto with_place = [&](const Largest    &largest,
                                  const Quantity    quantity,
                                  const Point<dim> &position) {
        return at_time(largest, quantity) + ", x = (" + as_text(position, 3) +
               ")" + units.suffix(Quantity::length, dim);
      };
      out << "Largest in the run:\n";
      print_row(out,
                "displacement",
                with_place(run.displacement,
                           Quantity::length,
                           run.displacement_position));
      print_row(out,
                "von Mises stress",
                with_place(run.von_mises,
                           Quantity::stress,
                           run.von_mises_position));
      if (run.pressure.value > 0.)
        print_row(out,
                  "contact pressure",
                  at_time(run.pressure, Quantity::stress));
      if (run.has_friction)
        print_row(out,
                  "slipping area",
                  number(run.slip_area.value) + " of " +
                    number(run.friction_area) +
                    units.suffix(Quantity::area, dim) +
                    " at t = " + with_unit_of_time(run.slip_area.t, units) +
                    (run.slip_area.value > 0. && run.slip_area.t == 0. ?
                       ", into the initial equilibrium" :
                       ""));
      if (run.slip_rate.value > 0.)
        print_row(out, "slip rate", at_time(run.slip_rate, Quantity::velocity));
      if (run.capped_volume.value > 0.)
        print_row(out,
                  "volume beyond the cap",
                  at_time(run.capped_volume, Quantity::volume));
      if (run.stiffness.value > 0.)
        print_row(out,
                  "time step times r",
                  with_place(run.stiffness,
                             Quantity::pure_number,
                             run.critical_position));
    }



    /// Print the first touch and slip, unless they are in the first step.
    template <int dim>
    void
    print_first(std::ostream          &out,
                const Units           &units,
                const RunSummary<dim> &run)
    {
      const auto print = [&](const std::string &what, const FirstStep &first) {
        if (first.n > 1)
          out << "First " << what << " between t = " << number(first.before)
              << " and " << with_unit_of_time(first.t, units) << '\n';
      };
      print("touch", run.first_touch);
      print("slip", run.first_slip);
    }



    /// Print how step control and the stability limit affected the steps.
    template <int dim>
    void
    print_steps(std::ostream &out, const RunSummary<dim> &run)
    {
      if (run.unchanged_steps > 0)
        out << "Steps in which nothing changed, without a solve: "
            << run.unchanged_steps << " of " << run.n_steps << '\n';
      if (run.steps)
        {
          std::string text = std::to_string(run.n_steps) + " accepted";
          const auto  add = [&](const unsigned int n, const std::string &what) {
            if (n > 0)
              text += ", " + std::to_string(n) + ' ' + what;
          };
          add(run.steps->rejected, "rejected for their error");
          add(run.steps->events, "rejected to resolve events of slip");
          add(run.steps->failed, "that failed");
          out << "Steps: " << text << '\n';
          if (run.steps->unresolved > 0)
            out << "Note: " << run.steps->unresolved
                << " steps of the smallest size have larger errors than their "
                   "tolerance allows: where the data jump, or because "
                   "'Smallest step' is too large.\n";
        }
      if (run.implicit_steps)
        out << "Steps by backward Euler, beyond the limit 2/r: "
            << *run.implicit_steps << " of " << run.n_steps << '\n';
    }



    /// Print an estimated error by its causes.
    template <int dim>
    void
    print_parts(std::ostream          &out,
                const RunSummary<dim> &run,
                const ErrorSummary    &errors)
    {
      const auto part = [&](const std::string &name, const double value) {
        print_row(out,
                  name,
                  number(value, 2) +
                    (errors.size > 0. ?
                       " (" + number(100. * value / errors.size, 2) + " %)" :
                       ""));
      };
      const ErrorParts &largest = errors.largest;
      part("mesh", largest.space);
      if (largest.history > 0.)
        part("mesh, in the history", largest.history);
      if (run.has_viscosity)
        part("time steps", largest.time);
      if (largest.friction > 0.)
        part("friction bounds and turns", largest.friction);
      if (largest.transfer > 0.)
        part("changes of the mesh", largest.transfer);
      part("iterations", largest.algebraic);
      if (largest.initial > 0.)
        part("initial data", largest.initial);
      part(largest.history > 0. && !largest.history_adds ?
             "sum, of meshes by squares" :
             "sum",
           largest.total());
    }



    template <int dim>
    void
    print_errors(std::ostream          &out,
                 const Units           &units,
                 const PlaceNames      &names,
                 const RunSummary<dim> &run)
    {
      const auto error =
        [&](const std::string &name, const double value, const double norm) {
          if (norm > 0.)
            print_row(out,
                      "error of " + name,
                      number(value) + " (" + number(100. * value / norm) +
                        " % of it)");
        };
      const SolutionNorms &errors = run.largest_error,
                          &exact  = run.largest_exact;
      error("u in energy", errors.energy, exact.energy);
      error("u in H1", errors.h1, exact.h1);
      error("stress in L2", errors.stress, exact.stress);
      error("multiplier in L2", errors.multiplier, exact.multiplier);
      if (!run.errors)
        return;

      out << "Estimated error in the energy norm, largest at t = "
          << with_unit_of_time(run.errors->t, units)
          << ", and relative to the solution:\n";
      print_parts(out, run, *run.errors);
      if (!run.quantity.empty())
        {
          out << "Estimated error of " << names.quantity(run.quantity)
              << ", largest at t = "
              << with_unit_of_time(run.quantity_errors.t, units)
              << ", and relative to its largest value:\n";
          print_parts(out, run, run.quantity_errors);
        }
      if (run.tolerance && !run.has_zero_quantity() &&
          run.controlled_errors().relative() <= *run.tolerance)
        {
          out << "The tolerance of " << 100. * *run.tolerance << " % has been ";
          if (run.jump_position)
            out << "met by the estimate alone: prescribed displacements jump "
                   "at x = ("
                << *run.jump_position
                << "), as a warning says, and no error bar tells the true "
                   "error.\n";
          else if (run.has_coarse_curves)
            out << "met by the estimate alone: the mesh is too coarse for the "
                   "curved faces in contact to find each other; take more "
                   "'Geometry/Global refinements'.\n";
          else
            out << "kept.\n";
        }
    }
  } // namespace



  template <int dim>
  void
  RunSummary<dim>::print(std::ostream     &out,
                         const Units      &units,
                         const PlaceNames &names) const
  {
    print_end(out, units, names, *this);
    print_largest(out, units, *this);
    print_first(out, units, *this);
    print_steps(out, *this);
    print_errors(out, units, names, *this);
  }



  void
  RunBill::print(std::ostream &out) const
  {
    std::map<std::string, double> remaining(seconds);
    double                        rest = total;

    const auto print_line =
      [&](const std::string &name, const double time, const std::string &text) {
        std::ostringstream digits;
        digits << std::fixed << std::setprecision(3) << time;
        out << "  " << std::left << std::setw(14) << name << std::right
            << std::setw(9) << digits.str() << std::setw(5)
            << std::lround(total > 0. ? 100. * time / total : 0.) << " %"
            << (text.empty() ? "" : "  ") << text << '\n';
        rest -= time;
      };
    out << "This scene paid, in seconds and as a share of the run:\n";
    if (!has_viscosity)
      remaining.erase("rate");
    for (const RunPhase &phase : run_phases)
      {
        const auto found = remaining.find(phase.name);
        if (found == remaining.end())
          continue;
        print_line(phase.effect,
                   found->second - (phase.name == "contact" ? friction() : 0.),
                   phase.text);
        if (phase.name == "contact" && plain_solves)
          print_line("friction",
                     friction(),
                     *plain_solves > 0. ?
                       "active set; with it, solves take " +
                         number(solves / *plain_solves, 3) + " times as long" :
                       "active set");
        remaining.erase(found);
      }
    // Phases that are not in the list, under their own names.
    for (const auto &[name, time] : remaining)
      print_line(name, time, "");
    print_line("rest", double(rest), "mesh, initial state, progress");
    print_line("whole run",
               total,
               earlier > 0. ?
                 "since the restart, " + number(earlier, 3) + " s before it" :
                 "");
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(RunSummary);
} // namespace Viscoplastic
