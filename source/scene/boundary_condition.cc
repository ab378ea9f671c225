// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/scene/boundary_condition.h>

namespace Viscoplastic
{
  namespace
  {
    std::string
    entry(const types::boundary_id id, const std::string &name)
    {
      return "Boundary " + std::to_string(id) + "/" + name;
    }



    /// Throws ExcMessage listing @p choices, separated by |, unless the entry
    /// is given. The first choice, which means `not given', is not listed.
    void
    require_given(const types::boundary_id id,
                  const std::string       &name,
                  const bool               is_given,
                  std::string              choices)
    {
      choices.replace(choices.rfind('|'), 1, " or ");
      choices.erase(0, choices.find('|') + 1);
      if (!is_given)
        refuse("'" + entry(id, name) + "' is missing; it must be " +
               Utilities::replace_in_string(choices, "|", ", ") + ".");
    }



    /// The given contact law; by default the one that the paper combines with
    /// the friction law: given normal stress for Coulomb's, else bilateral.
    const ContactLaw *
    contact_law_of(const types::boundary_id id,
                   const std::string       &name,
                   const FrictionLaw       &friction)
    {
      using Kind                         = ContactLaw::Kind;
      const bool        follows_pressure = friction.follows_pressure();
      const ContactLaw *given            = find_named(contact_laws(), name);
      if (given == nullptr)
        return find_named(contact_laws(),
                          follows_pressure ? "given normal stress" :
                                             "bilateral");
      const ContactLaw &law = *given;
      const auto refuse_if  = [&](const bool when, const std::string &reason) {
        if (when)
          refuse("'" + entry(id, "Contact law") + "' is " + law.name +
                 ", but " + reason);
      };
      refuse_if(law.kind == Kind::bilateral && follows_pressure,
                "'Friction law' = " + friction.name +
                  " needs a pressure: that of unilateral contact, or a given "
                  "normal stress.");
      refuse_if(
        law.kind == Kind::given_stress && !follows_pressure,
        "with 'Friction law' other than coulomb that is a load: use the "
        "role traction with a 'Pressure'.");
      refuse_if(law.kind == Kind::unilateral && friction.is_glued,
                "what is glued cannot open; leave one of them out.");
      return &law;
    }



    /// Return the unit vector in the direction of a list of components.
    template <int dim>
    Tensor<1, dim>
    given_direction(const std::string &text, const std::string &entry)
    {
      const std::vector<double> components =
        Utilities::string_to_double(Utilities::split_string_list(text, ','));
      Tensor<1, dim> result;
      if (components.size() != dim)
        refuse("'" + entry + "' needs " + std::to_string(dim) +
               " components separated by commas, but '" + excerpt(text) +
               "' has " + std::to_string(components.size()) + ".");
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = components[d];
      if (!(result.norm() > 0.))
        refuse("'" + entry + "' is zero; give a direction.");
      return result / result.norm();
    }



    template <int dim>
    std::array<std::optional<Expression<dim>>, dim>
    given_components(const std::string &text, const std::string &entry)
    {
      const auto parts = Utilities::split_string_list(text, ';');
      if (parts.size() != dim)
        refuse("'" + entry + "' needs " + std::to_string(dim) +
               " components separated by semicolons, but '" + excerpt(text) +
               "' has " + std::to_string(parts.size()) + ".");
      std::array<std::optional<Expression<dim>>, dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        if (parts[d] != "free")
          result[d].emplace(parts[d], entry);
      return result;
    }



    /// Return the components that the exact solution prescribes: all, or those
    /// that are not `free'.
    template <int dim>
    std::array<std::optional<Expression<dim>>, dim>
    derived_components(const std::string        &text,
                       const std::string        &entry,
                       const ExactSolution<dim> &solution)
    {
      std::vector<std::string> parts(dim, "exact");
      if (!Utilities::trim(text).empty())
        parts = Utilities::split_string_list(text, ';');
      if (parts.size() != dim ||
          !std::all_of(parts.begin(), parts.end(), [](const std::string &part) {
            return part == "exact" || part == "free";
          }))
        refuse("'" + entry + "' is '" + excerpt(text) +
               "', but with 'Exact solution/Data' = solution it can only be "
               "left out, or be a list of `exact' and `free' for the " +
               std::to_string(dim) + " components.");
      std::array<std::optional<Expression<dim>>, dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        if (parts[d] == "exact")
          result[d].emplace(
            [&solution, d](const Point<dim> &x, const double t) {
              return solution.displacement(x, t)[d];
            },
            "Exact solution/Displacement");
      return result;
    }



    /// Whether the entry @p name has an effect with this role and these laws.
    template <int dim>
    bool
    uses(const BoundaryCondition<dim> &condition, const std::string &name)
    {
      const bool is_contact = condition.role == BoundaryRole::contact;
      if (name == "Contact law" || name == "Friction law")
        return is_contact;
      if (name == "Displacement")
        return condition.role == BoundaryRole::displacement;
      if (name == "Traction" || name == "Pressure" ||
          name == "Normal stiffness" || name == "Tangential stiffness")
        return condition.role == BoundaryRole::traction ||
               (condition.role == BoundaryRole::displacement &&
                !condition.prescribes_all());
      if (name == "Slip rate factor")
        return condition.has_friction();
      if (name == "Normal stress")
        return condition.has_given_stress();
      if (name == "Gap" || name == "Foundation normal")
        return condition.is_unilateral();
      if (name == "Foundation displacement")
        return is_contact &&
               (condition.is_bilateral() || condition.is_unilateral());
      if (name == "Against")
        return is_contact && !condition.has_given_stress();
      if (name == "Foundation motion")
        return condition.has_friction() || condition.is_glued();
      return is_contact && (condition.contact_law->has(name) ||
                            condition.friction_law->has(name));
    }



    /// Reads the entries of a condition whose role and laws are known. Unused
    /// entries are parsed as well, so that errors in them are found before the
    /// role changes.
    template <int dim>
    struct EntryReader
    {
      const BoundaryCondition<dim> &condition;
      const BoundaryParameters     &given;

      const std::string &
      text(const std::string &name) const
      {
        return given.entries.at(name);
      }

      bool
      has(const std::string &name) const
      {
        return !Utilities::trim(text(name)).empty();
      }

      std::optional<Expression<dim>>
      scalar(const std::string &name, const bool is_needed = true) const
      {
        std::optional<Expression<dim>> result;
        const bool                     is_used = uses(condition, name);
        if (has(name))
          result.emplace(text(name), entry(condition.id, name));
        else if (is_used && is_needed)
          refuse("'" + entry(condition.id, name) + "' is missing; the " +
                 (condition.friction_law->has(name) ?
                    "friction law " + condition.friction_law->name :
                    "contact law " + condition.contact_law->name) +
                 " needs it.");
        if (!is_used)
          result.reset();
        return result;
      }

      /// Absent where identically zero.
      std::optional<Expression<dim>>
      nonzero_scalar(const std::string &name,
                     const bool         is_needed = false) const
      {
        auto result = scalar(name, is_needed);
        if (result && result->is_zero())
          result.reset();
        return result;
      }

      /// Absent where identically zero.
      std::optional<Expression<dim>>
      stiffness(const std::string &name) const
      {
        auto result = nonzero_scalar(name);
        refuse_time(result, name, "springs do", "traction");
        return result;
      }

      void
      refuse_time(const std::optional<Expression<dim>> &datum,
                  const std::string                    &name,
                  const std::string                    &what,
                  const std::string                    &instead) const
      {
        if (datum && datum->depends_on_time())
          refuse("'" + entry(condition.id, name) + "' depends on time; " +
                 what + " not become stiffer or softer, let the " + instead +
                 " depend on time.");
      }

      std::optional<VectorExpression<dim>>
      vector(const std::string &name) const
      {
        auto result =
          optional_vector<dim>(text(name), dim, entry(condition.id, name));
        if (!uses(condition, name))
          result.reset();
        return result;
      }

      std::array<std::optional<Expression<dim>>, dim>
      displacement() const
      {
        const std::string name    = entry(condition.id, "Displacement");
        const bool        is_used = uses(condition, "Displacement");
        if (!is_used && !has("Displacement"))
          return {};
        auto result = condition.solution ?
                        derived_components<dim>(text("Displacement"),
                                                name,
                                                *condition.solution) :
                        given_components<dim>(text("Displacement"), name);
        if (!is_used)
          return {};
        if (!std::any_of(result.begin(), result.end(), [](const auto &one) {
              return one.has_value();
            }))
          refuse(
            "'" + name +
            "' prescribes nothing; a boundary that is free in all directions "
            "has the role free, or traction with a load or springs.");
        return result;
      }
    };
  } // namespace



  template <int dim>
  BoundaryCondition<dim>::BoundaryCondition(
    const types::boundary_id  id,
    const BoundaryParameters &parameters,
    const ExactSolution<dim> *solution)
    : id(id)
    , role(parameters.role)
    , solution(solution)
  {
    const EntryReader<dim> read{*this, parameters};
    require_given(id,
                  "Role",
                  role != BoundaryRole::not_given,
                  choices<BoundaryRole>);
    if (role == BoundaryRole::contact)
      {
        friction_law = find_named(friction_laws(), read.text("Friction law"));
        require_given(id,
                      "Friction law",
                      friction_law != nullptr,
                      names_of(friction_laws()));
        contact_law =
          contact_law_of(id, read.text("Contact law"), *friction_law);
        if (solution && is_unilateral())
          refuse("'" + entry(id, "Contact law") + "' is " + contact_law->name +
                 ", for which 'Exact solution/Data' = solution makes no data; "
                 "use 'Data' = scene.");
      }

    if (solution)
      for (const char *name : {"Traction", "Pressure", "Normal stress"})
        if (read.has(name))
          refuse("'" + entry(id, name) +
                 "' is given, but 'Exact solution/Data' = solution makes it; "
                 "leave one of them out.");
    displacement = read.displacement();
    if (role == BoundaryRole::traction && !solution && !read.has("Traction") &&
        !read.has("Pressure") && !read.has("Normal stiffness") &&
        !read.has("Tangential stiffness"))
      refuse("'" + entry(id, "Traction") +
             "' is missing, and so are 'Pressure' and stiffnesses of springs; "
             "a boundary without load has the role free.");
    traction             = read.vector("Traction");
    pressure             = read.nonzero_scalar("Pressure");
    normal_stiffness     = read.stiffness("Normal stiffness");
    tangential_stiffness = read.stiffness("Tangential stiffness");
    for (const LawEntry &one : entries_of(friction_laws()))
      if (auto datum = read.scalar(one.name))
        friction_data.push_back(std::move(*datum));
    slip_rate_factor.emplace(read.text("Slip rate factor"),
                             entry(id, "Slip rate factor"),
                             "v");
    if (slip_rate_factor->depends_on_time())
      refuse(
        "'" + entry(id, "Slip rate factor") +
        "' depends on t, but only the slip rate v is known there; 'Friction "
        "bound' and 'Friction coefficient' may depend on place and time.");
    if (!uses(*this, "Slip rate factor") ||
        (!slip_rate_factor->depends_on_position() &&
         slip_rate_factor->value(Point<1>(), 0.) == 1.))
      slip_rate_factor.reset();
    if (solution && slip_rate_factor)
      refuse("'" + entry(id, "Slip rate factor") +
             "' is given, for which 'Exact solution/Data' = solution makes no "
             "data; use 'Data' = scene.");
    normal_stress =
      read.scalar("Normal stress", /* is_needed = */ solution == nullptr);
    given_gap = read.nonzero_scalar("Gap");
    std::vector<double> numbers;
    for (const LawEntry &one : entries_of(contact_laws()))
      if (!one.is_number())
        {
          if (auto k = read.scalar(one.name))
            {
              read.refuse_time(k, one.name, "a foundation does", "gap");
              given_compliance = std::move(k);
            }
        }
      else if (uses(*this, one.name))
        numbers.push_back(Utilities::string_to_double(read.text(one.name)));
    if (has_normal_compliance())
      pressure_law = contact_law->make(numbers);
    if (read.has("Foundation normal"))
      {
        normal          = given_direction<dim>(read.text("Foundation normal"),
                                      entry(id, "Foundation normal"));
        normal_is_given = is_unilateral();
      }
    foundation_displacement =
      read.nonzero_scalar("Foundation displacement", /* is_needed = */ true);
    foundation_motion = read.vector("Foundation motion");
    // Slip is caused only by changes of the foundation motion in time.
    if (foundation_motion && !foundation_motion->depends_on_time())
      foundation_motion.reset();
  }



  template <int dim>
  std::vector<std::string>
  BoundaryCondition<dim>::unused_entries(
    const BoundaryParameters &parameters) const
  {
    std::vector<std::string> names;
    for (const auto &[name, help, default_value, pattern] : boundary_entries())
      {
        const std::string &text = parameters.entries.at(name);
        // Values that are the default or change nothing are not reported.
        const std::string nothing =
          name == "Contact law"                           ? "bilateral" :
          name == "Friction law"                          ? "none" :
          name == "Against" || name == "Slip rate factor" ? default_value :
                                                            "0";
        if (!Utilities::trim(text).empty() && text != default_value &&
            text != nothing && !uses(*this, name))
          names.push_back(name);
      }
    return names;
  }



#define INSTANTIATE(dim)                                                    \
  template BoundaryCondition<dim>::BoundaryCondition(                       \
    const types::boundary_id,                                               \
    const BoundaryParameters &,                                             \
    const ExactSolution<dim> *);                                            \
  template std::vector<std::string> BoundaryCondition<dim>::unused_entries( \
    const BoundaryParameters &) const;

  INSTANTIATE(2)
  INSTANTIATE(3)
#undef INSTANTIATE
} // namespace Viscoplastic
