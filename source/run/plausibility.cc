// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/mesh/mesh_size.h>
#include <viscoplastic_contact/run/plausibility.h>
#include <viscoplastic_contact/scene/sample_places.h>

#include <boost/property_tree/ptree.hpp>

#include <limits>

namespace Viscoplastic
{
  namespace
  {
    /// The range of a set of numbers.
    struct ValueRange
    {
      double least   = std::numeric_limits<double>::infinity(),
             largest = -std::numeric_limits<double>::infinity();

      void
      add(const double value)
      {
        least   = std::min(least, value);
        largest = std::max(largest, value);
      }

      /// Combine the ranges of all ranks. Collective.
      void
      join(const MPI_Comm communicator)
      {
        least   = Utilities::MPI::min(least, communicator);
        largest = Utilities::MPI::max(largest, communicator);
      }

      std::string
      text() const
      {
        return number(least) == number(largest) ?
                 number(least) :
                 number(least) + " to " + number(largest);
      }
    };



    double
    youngs_modulus(const Stiffness &stiffness)
    {
      return 2. * (1. + stiffness.poissons_ratio()) * stiffness.shear_modulus();
    }



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
          ranges.youngs_modulus.add(youngs_modulus(stiffness));
          ranges.poissons_ratio.add(stiffness.poissons_ratio());
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
      const MPI_Comm communicator =
        discretization.space.dof_handler.get_communicator();
      for (auto &ranges : result)
        for (ValueRange *range : {&ranges.youngs_modulus,
                                  &ranges.poissons_ratio,
                                  &ranges.time,
                                  &ranges.limit})
          range->join(communicator);
      return result;
    }



    /// Return the largest initial overlap of two bodies at nodes of a boundary.
    /// Collective.
    template <int dim>
    double
    largest_overlap(const AdmissibleSpace<dim>   &space,
                    const BoundaryCondition<dim> &condition)
    {
      const MortarRows &rows   = space.mortar_rows.at(condition.id);
      double            result = 0.;
      for (const auto &node : space.boundary_nodes())
        if (rows.count(node.first_dof / dim) == 1)
          {
            const auto &coupling = space.coupling_at(node.first_dof);
            const auto  apart    = space.normal_at(node.first_dof, condition) *
                                 (coupling.opposite - node.position) +
                               coupling.bulge +
                               condition.gap(node.position, 0.);
            result = std::max(result, -apart);
          }
      return Utilities::MPI::max(result, space.communicator);
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



    /// Extrema of data at some places and at about 20 steps.
    template <int dim>
    class DataSampler
    {
    public:
      DataSampler(const std::vector<Point<dim>> &places,
                  const Scene<dim>              &scene)
        : places(places)
      {
        const unsigned int n      = scene.schedule.n_steps();
        const unsigned int stride = (n + 19) / 20;
        times.push_back(0.);
        for (unsigned int i = stride; i < n + stride; i += stride)
          times.push_back(scene.schedule.step(std::min(i, n)).t);
      }

      /// Return the least value of a datum, at most zero.
      double
      least(const Expression<dim> &datum) const
      {
        double result = 0.;
        for (const double t : times)
          for (const double value : values_at(datum, places, t))
            result = std::min(result, value);
        return result;
      }

      /// Return the largest absolute value; @p when: set to its first time.
      double
      largest(const Expression<dim> &datum, double *const when = nullptr) const
      {
        double result = 0.;
        for (const double t : times)
          for (const double value : values_at(datum, places, t))
            if (std::abs(value) > result)
              {
                result = std::abs(value);
                if (when != nullptr)
                  *when = t;
              }
        return result;
      }

      /// Return the largest deviation from a value, or from the value at t = 0
      /// if there is no such value.
      double
      largest_deviation(const Expression<dim>       &datum,
                        const std::optional<double> &from) const
      {
        double     result = 0.;
        const auto start  = values_at(datum, places, 0.);
        for (const double t : times)
          {
            const auto now = values_at(datum, places, t);
            for (std::size_t i = 0; i < now.size(); ++i)
              result =
                std::max(result, std::abs(now[i] - from.value_or(start[i])));
          }
        return result;
      }

      double
      largest(const VectorExpression<dim> &datum,
              const unsigned int           n_components) const
      {
        double result = 0.;
        for (unsigned int c = 0; c < n_components; ++c)
          result = std::max(result, largest(datum[c]));
        return result;
      }

    private:
      const std::vector<Point<dim>> places;
      std::vector<double>           times;
    };
  } // namespace



  template <int dim>
  LargestStress
  largest_given_stress(const Discretization<dim> &discretization)
  {
    const Scene<dim> &scene = discretization.scene();
    const auto       &triangulation =
      discretization.space.dof_handler.get_triangulation();
    const double size =
      body_diagonal(discretization.space.dof_handler.get_triangulation());
    ValueRange modulus;
    for (const auto &ranges : ranges_of_materials<dim>(discretization, {}))
      modulus.add(ranges.youngs_modulus.least);

    const DataSampler<dim> body(places_in_body(triangulation), scene);
    LargestStress          load, bound;
    const auto             add = [&](const double       value,
                         const std::string &origin,
                         const bool         is_load,
                         const double       t = 0.) {
      if (LargestStress &largest = is_load ? load : bound;
          value > largest.value)
        largest = {value, origin, is_load, t};
    };
    if (scene.initial_stress)
      add(body.largest(*scene.initial_stress, stress_components<dim>().size()),
          "the initial stress",
          true);
    double hottest = 0.;
    if (scene.temperature)
      body.largest(scene.temperature->value, &hottest);
    for (const auto &material : scene.materials)
      if (const auto &alpha = material->thermal_expansion)
        add(modulus.least * body.largest(*alpha) *
              body.largest_deviation(scene.temperature->value,
                                     scene.temperature->reference),
            "Young's modulus times the thermal strain of " + material->name,
            true,
            hottest);
    if (scene.body_force)
      add(body.largest(*scene.body_force, dim) * size,
          "the body force times the size of the body",
          true);
    for (const auto &[id, condition] : scene.boundary)
      {
        const DataSampler<dim> here(places_on_boundary(triangulation, id),
                                    scene);
        const std::string      where = " of " + scene.names.of("boundary", id);
        if (condition.traction)
          add(here.largest(*condition.traction, dim),
              "the traction" + where,
              true);
        for (const auto &[datum, name] :
             {std::make_pair(&condition.pressure, "the pressure"),
              std::make_pair(&condition.normal_stress, "the normal stress")})
          if (*datum)
            add(here.largest(**datum), name + where, true);
        for (unsigned int i = 0; i < condition.friction_data.size(); ++i)
          if (!condition.friction_law->entries[i].of_pressure)
            add(here.largest(condition.friction_data[i]),
                "the friction bound" + where,
                false);
        // If contact may open, only displacements towards the body load it.
        const auto &foundation   = condition.foundation_displacement;
        double      displacement = !foundation ? 0. :
                                   condition.is_unilateral() ?
                                                 -here.least(*foundation) :
                                                 here.largest(*foundation);
        for (const auto &component : condition.displacement)
          if (component)
            displacement = std::max(displacement, here.largest(*component));
        // The softest material takes the strain; stiff parts move rigidly.
        add(modulus.least * displacement / size,
            "Young's modulus times the displacement" + where +
              " over the size of the body",
            true);
      }
    return load.value > 0. ? load : bound;
  }



  template <int dim>
  void
  describe_materials(const Discretization<dim> &discretization,
                     const LargestStress       &stress,
                     std::ostream              &out)
  {
    const Parameters &parameters = discretization.scene().parameters;
    const std::string stress_unit =
                        parameters.units.suffix(Quantity::stress, dim),
                      time_unit = parameters.units.suffix(Quantity::time, dim);
    const auto entries          = parameters.entries_as_written();
    for (const auto &[material, modulus, ratio, time, limit] :
         ranges_of_materials(discretization, stress))
      {
        out << material->name
            << (material->is_anisotropic() ? ": anisotropic, in the mean E = " :
                                             ": E = ")
            << modulus.text() << stress_unit << ", nu = " << ratio.text()
            << ", " << material->law_name;
        if (!material->law)
          {
            out << '\n';
            continue;
          }
        bool is_first = true;
        for (const auto &[name, entry] :
             entries.get_child(boost::property_tree::ptree::path_type(
               material->section + '/' + material->law_name, '/')))
          {
            out << (is_first ? " with " : ", ") << name << " = "
                << entry.template get<std::string>("value");
            is_first = false;
          }
        if (stress.value > 0.)
          {
            out << "; at " << number(stress.value) << stress_unit << ", "
                << stress.origin << ", it ";
            if (time.largest > 0.)
              out << "relaxes stress within |sigma|/|G| = " << time.text()
                  << time_unit;
            else
              out << "does not flow";
            // The limit of the initial state does not include this material.
            if (std::isfinite(material->added_at) && limit.largest > 0.)
              out << "; stability limit 2/r there, once it is added: "
                  << limit.text() << time_unit;
          }
        out << '\n';
      }
  }



  namespace
  {
    /// Add sentences on implausible moduli, times and strains.
    template <int dim>
    void
    add_implausible_in_si(const Scene<dim>                       &scene,
                          const std::vector<MaterialRanges<dim>> &ranges,
                          const LargestStress                    &stress,
                          std::vector<std::string>               &result)
    {
      const Units &units     = scene.parameters.units;
      const auto   with_unit = [&units](const double value) {
        return number(value) + units.suffix(Quantity::stress, dim);
      };
      const auto in_si = [](const double value, const std::string &unit) {
        return number(value) + ' ' + unit + " in the SI";
      };
      for (const auto &[material, modulus, ratio, time, limit] : ranges)
        {
          // The range is from soft gels to diamond, which has 1.2e12 Pa.
          constexpr double least = 1e3, largest = 1.3e12;
          const double     unit = units.stress.si;
          if (modulus.least * unit < least || modulus.largest * unit > largest)
            {
              const double value =
                modulus.least * unit < least ? modulus.least : modulus.largest;
              result.push_back(
                "Young's modulus of '" + material->section + "' is " +
                with_unit(value) + " (" + in_si(value * unit, "Pa") +
                "); known materials have 1e4 Pa (gels), 1e6 Pa (rubber), 1e10 Pa "
                "(rock), 2e11 Pa (steel), up to 1.2e12 Pa (diamond).");
            }
          // A relaxation so much shorter than the run suggests wrong units.
          constexpr double at_once = 1e-9;
          const double     end     = scene.schedule.end_time();
          if (time.largest > 0. && time.largest < at_once * end)
            result.push_back(
              "the law of '" + material->section + "' relaxes " +
              with_unit(stress.value) + " (" + stress.origin + ") within " +
              number(time.largest) + units.suffix(Quantity::time, dim) + ", " +
              number(end / time.largest) +
              " times shorter than the run; look at the units of its parameters" +
              (scene.temperature ? " and at the temperatures." : "."));
          if (stress.is_load && stress.value > 0.1 * modulus.largest)
            result.push_back(
              "the data reach " + with_unit(stress.value) + " (" +
              stress.origin + "), a strain of about " +
              number(std::round(100. * stress.value / modulus.largest)) +
              " % with Young's modulus of '" + material->section + "', " +
              with_unit(modulus.largest) + "; small strains are assumed.");
        }
    }
  } // namespace



  template <int dim>
  std::vector<std::string>
  implausible_data(const Discretization<dim> &discretization,
                   const LargestStress       &stress)
  {
    const Scene<dim>        &scene      = discretization.scene();
    const Parameters        &parameters = scene.parameters;
    const Units             &units      = parameters.units;
    std::vector<std::string> result;
    const auto               with_unit = [&units](const double value) {
      return number(value) + units.suffix(Quantity::stress, dim);
    };
    const auto ranges = ranges_of_materials(discretization, stress);
    for (const auto &one : ranges)
      if (const std::string path = one.material->section + "/Young's modulus";
          stress.is_load && !one.material->is_anisotropic() &&
          parameters.origin_of(path).empty())
        result.push_back("'" + path + "' is not given, so that it is " +
                         with_unit(one.youngs_modulus.largest) +
                         ", its default, beside " + with_unit(stress.value) +
                         ", " + stress.origin + ".");
    const double size =
      body_diagonal(discretization.space.dof_handler.get_triangulation());
    for (const auto &[id, condition] : scene.boundary)
      {
        if (stress.value == 0. && condition.is_unilateral() &&
            condition.foundation_displacement && !condition.given_gap)
          result.push_back(
            "'Boundary " + std::to_string(id) +
            "/Foundation displacement' is never negative, so that " +
            scene.names.of("boundary", id) + " is never pressed on the " +
            (condition.against ? "other body" : "foundation") +
            ", and nothing else loads the scene.");
        const DataSampler<dim> here(
          places_on_boundary(
            discretization.space.dof_handler.get_triangulation(), id),
          scene);
        for (unsigned int i = 0; i < condition.friction_data.size(); ++i)
          if (const LawEntry &entry = condition.friction_law->entries[i];
              entry.of_pressure)
            if (const double largest = here.largest(condition.friction_data[i]);
                largest > 5.)
              result.push_back("'Boundary " + std::to_string(id) + '/' +
                               entry.name + "' is up to " + number(largest) +
                               "; is it one of percent?");
        if (!condition.is_unilateral() ||
            !(condition.against || condition.given_gap))
          continue;
        const double overlap =
          condition.against ? largest_overlap(discretization.space, condition) :
                              -here.least(*condition.given_gap);
        if (overlap > 0.05 * size)
          result.push_back(
            scene.names.of("boundary", id) + " overlaps the " +
            (condition.against ? "other body" : "foundation") + " by " +
            number(overlap) + units.suffix(Quantity::length, dim) + ", " +
            number(std::round(100. * overlap / size)) + " % of the size of " +
            (condition.against ? "both" : "the body") +
            (condition.against ?
               "; small strains are assumed, of two bodies, not of one." :
               "; small strains are assumed."));
      }
    if (discretization.space.is_held_by_contact() && discretization.face)
      for (const double t :
           {scene.schedule.step(1).t, scene.schedule.end_time()})
        if (loads_pull_off(discretization, t))
          {
            result.push_back("the loads at t = " + number(t) +
                             units.suffix(Quantity::time, dim) +
                             " pull the body off its foundation, and nothing "
                             "else holds it.");
            break;
          }
    if (units.are_declared())
      add_implausible_in_si(scene, ranges, stress, result);
    return result;
  }



  VISCOPLASTIC_INSTANTIATE(largest_given_stress);
  VISCOPLASTIC_INSTANTIATE(describe_materials);
  VISCOPLASTIC_INSTANTIATE(implausible_data);
} // namespace Viscoplastic
