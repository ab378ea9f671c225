// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/study/study_runs.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

// What makes a run of the scene one of a study: its name, and the entries that
// are set for it.

namespace Viscoplastic
{
  namespace
  {
    const std::string generator_with_subdivisions =
      "subdivided_hyper_rectangle";



    /// Whether the scene itself says when its mesh changes, and by how much.
    bool
    is_adaptive(const Parameters &scene)
    {
      return scene.refinement.strategy != RefinementStrategy::none &&
             !scene.error_control.has_tolerance();
    }



    /// Numbers of cells by direction, from the arguments of a mesh generator.
    std::vector<int>
    subdivisions(const std::string &arguments)
    {
      return Utilities::string_to_int(
        Utilities::split_string_list(arguments.substr(0, arguments.find(':')),
                                     ','));
    }



    /// The arguments with @p factor times as many cells in each direction.
    std::string
    scale_subdivisions(const std::string &arguments, const double factor)
    {
      std::string result;
      for (const int n : subdivisions(arguments))
        result += (result.empty() ? "" : ", ") +
                  std::to_string(std::max<long>(1, std::lround(factor * n)));
      return result + ' ' + arguments.substr(arguments.find(':'));
    }
  } // namespace



  RunKey
  StudyRuns::scene_key() const
  {
    RunKey key;
    key.variant = {is_adaptive(scene) ? MeshStrategy::adaptive :
                                        MeshStrategy::uniform,
                   name_of(scene.time.scheme),
                   name_of(scene.stress.stress_history)};
    return key;
  }



  unsigned int
  StudyRuns::steps_per_mesh(const MeshStrategy strategy,
                            const unsigned int n_steps) const
  {
    return strategy != MeshStrategy::adaptive ? 0 :
           is_adaptive(scene)                 ? scene.refinement.every_n_steps :
                                                std::max(1u, n_steps / 10);
  }



  double
  StudyRuns::n_set_ups(const MeshStrategy strategy,
                       const double       n_steps,
                       const unsigned int n_planned) const
  {
    const double every = steps_per_mesh(strategy, n_planned);
    return every > 0. ? std::max(1., std::ceil(n_steps / every)) : 1.;
  }



  std::vector<StepsUntil>
  StudyRuns::phases_of(const RunKey &key) const
  {
    return scale_phases(phases, std::pow(2., key.time_level));
  }



  double
  StudyRuns::step_tolerance(const RunKey &key) const
  {
    const double order = key.variant.order();
    return scene.step_control.tolerance * std::pow(2., -order * key.time_level);
  }



  double
  StudyRuns::tolerance(const RunKey &key) const
  {
    return key.variant.strategy == MeshStrategy::tolerance ?
             scene.error_control.tolerance * std::pow(0.5, key.mesh_level) :
             0.;
  }



  int
  StudyRuns::coarsest_tolerance_level() const
  {
    return static_cast<int>(std::ceil(
      std::log2(scene.error_control.tolerance / largest_tolerance) - 1e-9));
  }



  int
  StudyRuns::n_coarser_meshes() const
  {
    int n = static_cast<int>(scene.geometry.global_refinements);
    if (scene.geometry.file.empty() &&
        scene.geometry.generator == generator_with_subdivisions)
      {
        const auto cells  = subdivisions(scene.geometry.arguments);
        int        fewest = *std::min_element(cells.begin(), cells.end());
        for (; fewest >= 2; fewest = (fewest + 1) / 2)
          ++n;
      }
    return n;
  }



  std::string
  StudyRuns::name(const RunKey &key) const
  {
    const auto add = [](const std::string &choice,
                        const std::string &of_scene) {
      std::string text = choice == of_scene ? "" : '_' + choice;
      for (char &c : text)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0)
          c = '_';
      return text;
    };
    std::ostringstream result;
    result << to_string(key.variant.strategy)
           << add(key.variant.scheme, name_of(scene.time.scheme))
           << add(key.variant.history, name_of(scene.stress.stress_history));
    if (key.variant.strategy == MeshStrategy::tolerance)
      result << '_' << tolerance(key);
    else
      result << "_h" << key.mesh_level << "_k" << key.time_level;
    return result.str() + (key.is_timing ? "_timing" : "");
  }



  std::vector<std::string>
  StudyRuns::discretization(const RunKey                  &key,
                            const std::vector<StepsUntil> &steps,
                            const double                   step_tolerance) const
  {
    std::vector<std::string> result;
    const auto set = [&result](const std::string &entry, const auto &value) {
      std::ostringstream assignment;
      assignment << entry << '=' << std::setprecision(12) << value;
      result.push_back(assignment.str());
    };
    set("Time/Scheme", key.variant.scheme);
    set("Material/Stress history", key.variant.history);
    if (scene.error_control.has_tolerance())
      {
        set("Error control/Tolerance", tolerance(key));
        // Where it depends on the scheme, which is set above.
        set("Time/Stiffness policy", name_of(scene.time.stiffness_policy));
      }
    if (key.variant.strategy == MeshStrategy::tolerance)
      return result;

    const bool adaptive = key.variant.strategy == MeshStrategy::adaptive;
    // Adaptive runs begin one level coarser: from a much coarser mesh,
    // refinement at singular points would leave the rest too coarse.
    const int level = adaptive && key.mesh_level > 0 ? key.mesh_level - 1 :
                                                       key.mesh_level,
              base  = static_cast<int>(scene.geometry.global_refinements),
              refinements = std::max(0, base + level);
    AssertThrow(-level <= n_coarser_meshes(),
                ExcMessage("The mesh of the scene cannot be made coarser by " +
                           std::to_string(-level) +
                           " levels: 'Geometry/Global refinements' = " +
                           std::to_string(base) + "."));
    set("Geometry/Global refinements", refinements);
    set("Time/Phases", write_phases(steps));
    if (scene.step_control.is_on())
      set("Step control/Tolerance", step_tolerance);
    // Runs have the steps that the study says, or none.
    else if (!may_subdivide &&
             scene.time.stiffness_policy == StiffnessPolicy::subdivide)
      set("Time/Stiffness policy", "refuse");
    if (base + level < 0)
      set("Geometry/Arguments",
          scale_subdivisions(scene.geometry.arguments,
                             std::pow(2., base + level)));
    if (!adaptive)
      {
        set("Mesh refinement/Strategy", "none");
        return result;
      }
    if (!is_adaptive(scene))
      {
        set("Mesh refinement/Strategy", "residual");
        set("Mesh refinement/Refinement fraction", 0.6);
        set("Mesh refinement/Coarsening fraction", 0.05);
        set("Mesh refinement/Every n steps",
            steps_per_mesh(key.variant.strategy, n_steps(steps)));
      }
    const double cells =
      n_cells *
      std::pow(2., static_cast<double>(scene.dimension) * key.mesh_level);
    set("Mesh refinement/Minimal level", std::min(refinements, base));
    set("Mesh refinement/Maximal level",
        std::max(refinements, base + key.mesh_level + 2));
    set("Mesh refinement/Cell budget", std::max<long>(1, std::lround(cells)));
    return result;
  }



  std::vector<std::string>
  StudyRuns::overrides_of(const RunKey &key) const
  {
    std::vector<std::string> result       = overrides;
    const std::string        place        = directory + name(key);
    const bool               is_reference = reference && key == *reference;
    for (const std::string &assignment :
         discretization(key, phases_of(key), step_tolerance(key)))
      result.push_back(assignment);
    for (const std::string &assignment :
         {"Output/Directory=" + place,
          std::string("Output/Reference fields=") +
            (is_reference ? "true" : "false"),
          std::string("Checkpoint/Wall time limit=0"),
          "Checkpoint/Directory=" + place + "/checkpoint",
          std::string("Error control/Two-level comparison=false")})
      result.push_back(assignment);
    // A scene without one of its effects may lack what it records.
    if (!has_outputs)
      for (const char *assignment : {"Output/Fields every=0",
                                     "Output/Fields interval=0",
                                     "Output/Point fields=",
                                     "Output/Lines=",
                                     "Output/Line fields=",
                                     "Output/Integrals=",
                                     "Checkpoint/Every n steps=0",
                                     "Checkpoint/Wall time interval=0"})
        result.emplace_back(assignment);
    if (is_compared(key))
      result.push_back("Exact solution/Reference directory=" + directory +
                       name(*reference));
    return result;
  }
} // namespace Viscoplastic
