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



    /// Prints the parts of a summary.
    template <int dim>
    struct SummaryPrinter
    {
      std::ostream          &out;
      const Scene<dim>      &scene;
      const RunSummary<dim> &run;

      void
      row(const std::string &name, const std::string &value) const
      {
        // Names of places may be wider than the column.
        out << "  " << std::left << std::setw(25) << name << std::right << ' '
            << value << '\n';
      }

      std::string
      time(const double t) const
      {
        return number(t) + scene.unit(Quantity::time);
      }

      /// Print the quantities at the end of the run.
      void
      end() const
      {
        out << "At t = " << time(run.t) << ":\n";
        // Forces below this part of the largest are solver errors and print as
        // 0.
        constexpr double noise         = 1e-5;
        double           largest_force = 0.;
        for (const TableRow::Entry &entry : run.at_end)
          if (entry.quantity == Quantity::force)
            for (const double force : entry.values)
              largest_force = std::max(largest_force, std::abs(force));
        for (const TableRow::Entry &entry : run.at_end)
          {
            // The mesh may have changed in earlier passes only.
            if (entry.name == "adaptation_energy" && entry.values[0] == 0.)
              continue;
            std::vector<double> values = entry.values;
            for (double &value : values)
              if (entry.quantity == Quantity::force &&
                  std::abs(value) < noise * largest_force)
                value = 0.;
            row(scene.names.words(entry.name),
                with_unit(values,
                          scene.parameters.units.name(entry.quantity, dim)));
          }
        if (run.error_estimate)
          row("error estimate", number(*run.error_estimate));
      }

      /// Print a largest value unless it is zero.
      void
      largest(const std::string  &name,
              const Quantity      quantity,
              const Largest<dim> &largest) const
      {
        if (largest.value > 0.)
          row(name, with_time(quantity, largest));
      }

      std::string
      with_time(const Quantity quantity, const Largest<dim> &largest) const
      {
        return with_unit({largest.value},
                         scene.parameters.units.name(quantity, dim)) +
               " at t = " + time(largest.t);
      }

      std::string
      with_place(const Quantity quantity, const Largest<dim> &largest) const
      {
        return with_time(quantity, largest) + ", x = (" +
               as_text(largest.position, 3) + ")" +
               scene.unit(Quantity::length);
      }

      /// Print the largest values of the run.
      void
      largest_values() const
      {
        out << "Largest in the run:\n";
        row("displacement", with_place(Quantity::length, run.displacement));
        row("von Mises stress", with_place(Quantity::stress, run.von_mises));
        largest("contact pressure", Quantity::stress, run.pressure);
        if (scene.has_friction())
          row("slipping area",
              number(run.slip_area.value) + " of " + number(run.friction_area) +
                scene.unit(Quantity::area) +
                " at t = " + time(run.slip_area.t) +
                (run.slip_area.value > 0. && run.slip_area.t == 0. ?
                   ", into the initial equilibrium" :
                   ""));
        largest("slip rate", Quantity::velocity, run.slip_rate);
        largest("volume beyond the cap", Quantity::volume, run.capped_volume);
        if (run.stiffness.value > 0.)
          row("time step times r",
              with_place(Quantity::pure_number, run.stiffness));
      }

      /// Print the first touch or slip, unless it is in the first step.
      void
      first(const std::string &what, const FirstStep &first) const
      {
        if (first.n > 1)
          out << "First " << what << " between t = " << number(first.before)
              << " and " << time(first.t) << '\n';
      }

      /// Print how step control and the stability limit affected the steps.
      void
      steps() const
      {
        if (run.unchanged_steps > 0)
          out << "Steps in which nothing changed, without a solve: "
              << run.unchanged_steps << " of " << run.n_steps << '\n';
        if (run.steps)
          {
            out << "Steps: " << run.n_steps << " accepted";
            for (const auto &[n, what] :
                 {std::make_pair(run.steps->rejected,
                                 "rejected for their error"),
                  std::make_pair(run.steps->events,
                                 "rejected to resolve events of slip"),
                  std::make_pair(run.steps->failed, "that failed")})
              if (n > 0)
                out << ", " << n << ' ' << what;
            out << '\n';
            if (run.steps->unresolved > 0)
              out << "Note: " << run.steps->unresolved
                  << " steps of the smallest size have larger errors than "
                     "their tolerance allows: where the data jump, or because "
                     "'Smallest step' is too large.\n";
          }
        if (run.implicit_steps)
          out << "Steps by backward Euler, beyond the limit 2/r: "
              << *run.implicit_steps << " of " << run.n_steps << '\n';
      }

      /// Print an estimated error by its causes.
      void
      parts(const ErrorSummary &errors) const
      {
        const auto part = [&](const std::string &name, const double value) {
          row(name,
              number(value, 2) +
                (errors.size > 0. ?
                   " (" + number(100. * value / errors.size, 2) + " %)" :
                   ""));
        };
        const ErrorParts &largest = errors.largest;
        part("mesh", largest.space);
        if (largest.history > 0.)
          part("mesh, in the history", largest.history);
        if (scene.has_viscosity())
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

      /// Print an error against an exact solution.
      void
      error(const std::string &name,
            const double       value,
            const double       norm) const
      {
        if (norm > 0.)
          row("error of " + name,
              number(value) + " (" + number(100. * value / norm) + " % of it)");
      }

      void
      estimated_errors() const
      {
        out << "Estimated error in the energy norm, largest at t = "
            << time(run.errors->t) << ", and relative to the solution:\n";
        parts(*run.errors);
        if (!run.quantity.empty())
          {
            out << "Estimated error of " << scene.names.quantity(run.quantity)
                << ", largest at t = " << time(run.quantity_errors.t)
                << ", and relative to its largest value:\n";
            parts(run.quantity_errors);
          }
        if (!run.tolerance || run.has_zero_quantity() ||
            run.controlled_errors().relative() > *run.tolerance)
          return;
        out << "The tolerance of " << 100. * *run.tolerance << " % has been ";
        if (run.jump_position)
          out << "met by the estimate alone: prescribed displacements jump at "
                 "x = ("
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
    };
  } // namespace



  template <int dim>
  void
  RunSummary<dim>::print(std::ostream &out, const Scene<dim> &scene) const
  {
    const SummaryPrinter<dim> print{out, scene, *this};
    print.end();
    print.largest_values();
    print.first("touch", first_touch);
    print.first("slip", first_slip);
    print.steps();
    print.error("u in energy", largest_error.energy, largest_exact.energy);
    print.error("u in H1", largest_error.h1, largest_exact.h1);
    print.error("stress in L2", largest_error.stress, largest_exact.stress);
    print.error("multiplier in L2",
                largest_error.multiplier,
                largest_exact.multiplier);
    if (errors)
      print.estimated_errors();
  }



  void
  RunBill::print(std::ostream &out) const
  {
    double     rest = total;
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
    for (const RunPhase &phase : run_phases)
      {
        const auto found = seconds.find(phase.name);
        if (found == seconds.end() || (phase.name == "rate" && !has_viscosity))
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
      }
    print_line("rest", rest, "mesh, initial state, progress");
    print_line("whole run",
               total,
               earlier > 0. ?
                 "since the restart, " + number(earlier, 3) + " s before it" :
                 "");
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(RunSummary);
} // namespace Viscoplastic
