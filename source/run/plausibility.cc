// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/mesh/mesh_size.h>
#include <viscoplastic_contact/run/plausibility.h>
#include <viscoplastic_contact/scene/data_in_time.h>

#include <boost/property_tree/ptree.hpp>

#include <limits>

namespace Viscoplastic
{
  namespace
  {
    /// The largest stress that the data of a scene impose, and its origin.
    struct LargestStress
    {
      double      value = 0.;
      std::string origin;
      /// Whether a load causes the stress, rather than a friction bound.
      bool is_load = false;
      /// The time of the highest temperature, for a thermal stress; else 0.
      double t = 0.;
    };

    /// The range of a set of numbers, and the first time of the largest.
    struct ValueRange
    {
      double least   = std::numeric_limits<double>::infinity(),
             largest = -std::numeric_limits<double>::infinity(), t = 0.;

      void
      add(const double value, const double when = 0.)
      {
        if (value > largest)
          t = when;
        least   = std::min(least, value);
        largest = std::max(largest, value);
      }

      double
      farthest_from(const double value) const
      {
        return std::max(largest - value, value - least);
      }

      std::string
      text() const
      {
        return number(least) == number(largest) ?
                 number(least) :
                 number(least) + " to " + number(largest);
      }
    };

    /// Ranges over the cells of one material: moduli, and, where its law flows
    /// at a given stress, the times |sigma|/|G| and 2/r.
    template <int dim>
    struct MaterialRanges
    {
      const Material<dim> *material;
      ValueRange           youngs_modulus, poissons_ratio, time, limit;
    };



    /// The ranges of all materials at a uniaxial @p stress. Collective.
    template <int dim>
    std::vector<MaterialRanges<dim>>
    ranges_of_materials(const Discretization<dim> &discretization,
                        const LargestStress       &stress)
    {
      const Scene<dim>                &scene = discretization.scene();
      std::vector<MaterialRanges<dim>> result;
      for (const auto &material : scene.materials)
        if (!material->is_absent)
          result.push_back({material.get(), {}, {}, {}, {}});
      const auto            now = discretization.laws.at(stress.t);
      SymmetricTensor<2, 3> uniaxial;
      uniaxial[0][0]    = stress.value;
      const auto &cells = discretization.space.cells;
      for (std::size_t c = 0; c < cells.size(); ++c)
        {
          // Materials that are added later are included.
          const Material<dim> *material =
            &scene.lasting_material(cells[c]->material_id());
          auto &ranges =
            *std::find_if(result.begin(), result.end(), [&](const auto &one) {
              return one.material == material;
            });
          const Stiffness stiffness =
            scene.has_stages() ? material->stiffness(cells[c]->center()) :
                                 discretization.moduli(c);
          const double nu = stiffness.poissons_ratio();
          ranges.youngs_modulus.add(2. * (1. + nu) * stiffness.shear_modulus());
          ranges.poissons_ratio.add(nu);
          const ViscoplasticLaw *law = material->law.get();
          if (law == nullptr || stress.value == 0.)
            continue;
          Point<3> x;
          for (unsigned int d = 0; d < dim; ++d)
            x[d] = cells[c]->center()[d];
          const LawPoint point =
            now.law(c) ? now.point(c, 0) :
                         law->point(x,
                                    std::max(stress.t, material->added_at),
                                    now.temperature(c, 0));
          const auto   strain = stiffness.strain(uniaxial);
          const double rate =
            law->rate(uniaxial, strain, stiffness, point).norm();
          if (rate == 0.)
            continue;
          ranges.time.add(uniaxial.norm() / rate);
          if (const double r =
                law->relaxation_rate(uniaxial, strain, stiffness, point);
              r > 0.)
            ranges.limit.add(2. / r);
        }
      const MPI_Comm communicator = discretization.space.communicator;
      for (auto &ranges : result)
        for (ValueRange *range : {&ranges.youngs_modulus,
                                  &ranges.poissons_ratio,
                                  &ranges.time,
                                  &ranges.limit})
          {
            range->least   = Utilities::MPI::min(range->least, communicator);
            range->largest = Utilities::MPI::max(range->largest, communicator);
          }
      return result;
    }



    /// The range of a datum at some places and at about 20 steps.
    template <int dim>
    ValueRange
    range_of(const Expression<dim>         &datum,
             const std::vector<Point<dim>> &places,
             const TimeSchedule            &schedule)
    {
      ValueRange         result;
      const unsigned int n = schedule.n_steps(), stride = (n + 19) / 20;
      for (unsigned int i = 0; i < n + stride; i += stride)
        {
          const double t = i > 0 ? schedule.step(std::min(i, n)).t : 0.;
          for (const double value : values_at(datum, places, t))
            result.add(value, t);
        }
      return result;
    }



    template <int dim>
    LargestStress
    largest_given_stress(const Discretization<dim> &discretization)
    {
      const Scene<dim> &scene = discretization.scene();
      const auto       &triangulation =
        discretization.space.dof_handler.get_triangulation();
      const double size = body_diagonal(triangulation);
      // The softest material takes the strain; stiff parts move rigidly.
      double modulus = std::numeric_limits<double>::infinity();
      for (const auto &ranges : ranges_of_materials<dim>(discretization, {}))
        modulus = std::min(modulus, ranges.youngs_modulus.least);

      LargestStress load, bound;
      const auto    add = [&load](const double       value,
                               const std::string &origin,
                               const double       t = 0.) {
        if (value > load.value)
          load = {value, origin, true, t};
      };
      std::vector<Point<dim>> places = places_in_body(triangulation);
      const auto              range  = [&](const Expression<dim> &datum) {
        return range_of(datum, places, scene.schedule);
      };
      const auto largest = [&](const Expression<dim> &datum) {
        return range(datum).farthest_from(0.);
      };
      const auto largest_component = [&](const VectorExpression<dim> &datum,
                                         const unsigned int           n) {
        double result = 0.;
        for (unsigned int c = 0; c < n; ++c)
          result = std::max(result, largest(datum[c]));
        return result;
      };
      if (scene.initial_stress)
        add(largest_component(*scene.initial_stress,
                              stress_components<dim>().size()),
            "the initial stress");
      for (const auto &material : scene.materials)
        if (const auto &alpha = material->thermal_expansion)
          {
            const auto      &temperature = *scene.temperature;
            const ValueRange heat        = range(temperature.value);
            add(modulus * largest(*alpha) *
                  heat.farthest_from(temperature.reference.value_or(
                    values_at(temperature.value, places, 0.)[0])),
                "Young's modulus times the thermal strain of " + material->name,
                heat.t);
          }
      if (scene.body_force)
        add(largest_component(*scene.body_force, dim) * size,
            "the body force times the size of the body");
      for (const auto &[id, condition] : scene.boundary)
        {
          places                  = places_on_boundary(triangulation, id);
          const std::string where = " of " + scene.names.of("boundary", id);
          if (condition.traction)
            add(largest_component(*condition.traction, dim),
                "the traction" + where);
          if (condition.pressure)
            add(largest(*condition.pressure), "the pressure" + where);
          if (condition.normal_stress)
            add(largest(*condition.normal_stress), "the normal stress" + where);
          for (unsigned int i = 0; i < condition.friction_data.size(); ++i)
            if (!condition.friction_law->entries[i].of_pressure)
              if (const double value = largest(condition.friction_data[i]);
                  value > bound.value)
                bound = {value, "the friction bound" + where};
          // If contact may open, only displacements towards the body load it.
          double displacement = 0.;
          if (const auto &foundation = condition.foundation_displacement)
            displacement = condition.is_unilateral() ?
                             -range(*foundation).least :
                             largest(*foundation);
          for (const auto &component : condition.displacement)
            if (component)
              displacement = std::max(displacement, largest(*component));
          add(modulus * displacement / size,
              "Young's modulus times the displacement" + where +
                " over the size of the body");
        }
      return load.value > 0. ? load : bound;
    }



    /// Whether contact cannot balance the loads at time t: of the rigid motions
    /// that only contact prevents, the combination on which the loads do most
    /// work separates all contact points from their foundations. Collective.
    template <int dim>
    bool
    loads_pull_off(const Discretization<dim> &discretization, const double t)
    {
      const AdmissibleSpace<dim> &space = discretization.space;
      for (const auto &condition : discretization.scene().boundary)
        if (condition.second.has_friction() &&
            !condition.second.has_computed_pressure())
          return false; // friction bounds without pressure hold the body
      const Load<dim>   load   = discretization.loads.assemble(t);
      DistributedVector motion = space.owned_vector();
      for (const DistributedVector &free : space.motions_held_by_contact())
        motion.add(load.values * free, free);
      const ContactLayout &layout = discretization.face->layout();
      const Vector<double> x =
        discretization.face->restriction().gather(motion);
      double nearest = -std::numeric_limits<double>::infinity();
      for (const unsigned int o : layout.obstacles())
        nearest =
          std::max(nearest,
                   slip(layout.points[o],
                        layout.node_values(x, layout.points[o].node))[0]);
      return Utilities::MPI::max(nearest, space.communicator) <
             -1e-6 * motion.linfty_norm();
    }



    /// Print a material with its law at the given stress.
    template <int dim>
    void
    describe(const Scene<dim>          &scene,
             const MaterialRanges<dim> &ranges,
             const LargestStress       &stress,
             std::ostream              &out)
    {
      const auto &[material, modulus, ratio, time, limit] = ranges;
      const std::string stress_unit = scene.unit(Quantity::stress),
                        time_unit   = scene.unit(Quantity::time);
      out << material->name << ": "
          << (material->is_anisotropic() ? "anisotropic, in the mean " : "")
          << "E = " << modulus.text() << stress_unit
          << ", nu = " << ratio.text() << ", " << material->law_name;
      if (material->law)
        {
          const char *separator = " with ";
          const auto  written   = scene.parameters.entries_as_written();
          for (const auto &[name, entry] :
               written.get_child(boost::property_tree::ptree::path_type(
                 material->section + '/' + material->law_name, '/')))
            {
              out << separator << name << " = "
                  << entry.template get<std::string>("value");
              separator = ", ";
            }
          if (stress.value > 0.)
            out << "; at " << number(stress.value) << stress_unit << ", "
                << stress.origin << ", it "
                << (time.largest > 0. ? "relaxes stress within |sigma|/|G| = " +
                                          time.text() + time_unit :
                                        "does not flow");
          // The limit of the initial state does not include this material.
          if (std::isfinite(material->added_at) && limit.largest > 0.)
            out << "; stability limit 2/r there, once it is added: "
                << limit.text() << time_unit;
        }
      out << '\n';
    }



    /// Add sentences on a material whose data have wrong units.
    template <int dim>
    void
    add_wrong_units(const Scene<dim>          &scene,
                    const MaterialRanges<dim> &ranges,
                    const LargestStress       &stress,
                    std::vector<std::string>  &result)
    {
      const ValueRange  &modulus = ranges.youngs_modulus;
      const std::string &section = ranges.material->section;
      const auto         text    = [&](const double value) {
        return number(value) + scene.unit(Quantity::stress);
      };
      const std::string of_stress =
        text(stress.value) + " (" + stress.origin + ")";
      const double pascal = scene.parameters.units.stress.si;
      if (const double value =
            modulus.least * pascal < 1e3 ? modulus.least : modulus.largest;
          value * pascal < 1e3 || value * pascal > 1.3e12)
        result.push_back(
          "Young's modulus of '" + section + "' is " + text(value) + " (" +
          number(value * pascal) +
          " Pa in the SI); known materials have 1e4 Pa (gels), 1e6 Pa "
          "(rubber), "
          "1e10 Pa (rock), 2e11 Pa (steel), up to 1.2e12 Pa (diamond).");
      const double time = ranges.time.largest, end = scene.schedule.end_time();
      if (time > 0. && time < 1e-9 * end)
        result.push_back(
          "the law of '" + section + "' relaxes " + of_stress + " within " +
          number(time) + scene.unit(Quantity::time) + ", " +
          number(end / time) +
          " times shorter than the run; look at the units of "
          "its parameters" +
          (scene.temperature ? " and at the temperatures." : "."));
      if (stress.is_load && stress.value > 0.1 * modulus.largest)
        result.push_back(
          "the data reach " + of_stress + ", a strain of about " +
          number(std::round(100. * stress.value / modulus.largest)) +
          " % with Young's modulus of '" + section + "', " +
          text(modulus.largest) + "; small strains are assumed.");
    }
  } // namespace



  template <int dim>
  std::vector<std::string>
  implausible_data(const Discretization<dim> &discretization, std::ostream &out)
  {
    const Scene<dim>        &scene  = discretization.scene();
    const LargestStress      stress = largest_given_stress(discretization);
    std::vector<std::string> result;
    for (const auto &ranges : ranges_of_materials(discretization, stress))
      {
        describe(scene, ranges, stress, out);
        const std::string path = ranges.material->section + "/Young's modulus";
        if (stress.is_load && !ranges.material->is_anisotropic() &&
            scene.parameters.origin_of(path).empty())
          result.push_back("'" + path + "' is not given, so that it is " +
                           number(ranges.youngs_modulus.largest) +
                           scene.unit(Quantity::stress) +
                           ", its default, beside " + number(stress.value) +
                           scene.unit(Quantity::stress) + ", " + stress.origin +
                           ".");
        if (scene.parameters.units.are_declared())
          add_wrong_units(scene, ranges, stress, result);
      }
    for (const auto &[id, condition] : scene.boundary)
      if (stress.value == 0. && condition.is_unilateral() &&
          condition.foundation_displacement && !condition.given_gap)
        result.push_back(
          "'Boundary " + std::to_string(id) +
          "/Foundation displacement' is never negative, so that " +
          scene.names.of("boundary", id) + " is never pressed on the " +
          (condition.against ? "other body" : "foundation") +
          ", and nothing else loads the scene.");
    if (discretization.space.is_held_by_contact() && discretization.face)
      for (const double t :
           {scene.schedule.step(1).t, scene.schedule.end_time()})
        if (loads_pull_off(discretization, t))
          {
            result.push_back("the loads at t = " + number(t) +
                             scene.unit(Quantity::time) +
                             " pull the body off its foundation, and nothing "
                             "else holds it.");
            break;
          }
    return result;
  }



  VISCOPLASTIC_INSTANTIATE(implausible_data);
} // namespace Viscoplastic
