// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/units.h>
#include <viscoplastic_contact/laws/viscoplastic_law.h>
#include <viscoplastic_contact/parameters/parameters.h>

#include <boost/property_tree/ptree_fwd.hpp>

#include <map>
#include <string>
#include <vector>

namespace Viscoplastic
{
  struct ParameterLine;

  /// The parameters of a scene from one or several files, checked as far as is
  /// possible without a mesh. Expressions are kept as texts: their number of
  /// components depends on the dimension, so Scene<dim> parses them. Numbers
  /// with units are converted to the units of the scene.
  class Parameters
  {
  public:
    /// Read @p files, of which later ones override earlier ones, and then the
    /// assignments `Section/Entry=value' of @p overrides. Subsections `Boundary
    /// 0', `Material 1' and so on are declared for the ids that occur in them.
    /// Without files, all entries have their defaults.
    ///
    /// Throws ExcMessage with a sentence that names the line of an unknown or
    /// wrong entry, and what would be right.
    explicit Parameters(const std::vector<std::string> &files,
                        const std::vector<std::string> &overrides = {});

    explicit Parameters(const std::string &file);

    /// The handler refers to the structs below.
    Parameters(const Parameters &) = delete;

    /// The first of the files, after which the scene is named.
    const std::string file;
    /// The shared libraries with additional laws.
    std::vector<std::string>    shared_libraries;
    std::vector<LawDescription> laws;
    unsigned int                dimension = 2;
    UnitParameters              unit_names;
    /// The units of all numbers; not declared unless the scene does so.
    Units              units;
    GeometryParameters geometry;
    /// The material of all cells; unused if there are numbered materials.
    MaterialParameters                         material;
    StressParameters                           stress;
    std::map<unsigned int, MaterialParameters> materials;
    SupportParameters                          supports;
    LoadParameters                             loads;
    TemperatureParameters                      temperature;
    InitialStateParameters                     initial_state;
    ExactSolutionParameters                    exact_solution;
    std::map<unsigned int, BoundaryParameters> boundaries;
    std::map<unsigned int, TableParameters>    tables;
    TimeParameters                             time;
    StepControlParameters                      step_control;
    SolverParameters                           solver;
    ErrorControlParameters                     error_control;
    RefinementParameters                       refinement;
    OutputParameters                           output;
    CheckpointParameters                       checkpoint;
    StudyParameters                            study;

    /// The value of every entry, by `Section/Subsection/Entry'.
    std::map<std::string, std::string>
    values() const;

    /// Print a parameter file with every entry and the units of numbers in the
    /// files: the record of a run.
    void
    print(std::ostream &out, const bool is_explained = false) const;

    /// Return all entries like declared_entries(), but with values as in the
    /// files.
    boost::property_tree::ptree
    entries_as_written() const;

    /// Return the entries with units in the files by their paths, with values
    /// converted to the units of the scene.
    std::map<std::string, std::string>
    entries_with_units() const;

    /// Replace values of entries in a message by their text in the files.
    std::string
    quote_as_written(const std::string &sentence) const;

    /// Return where an entry, given by its path, was set last, for messages:
    /// file and line, or the assignment. Empty if it has its default.
    std::string
    origin_of(const std::string &path) const
    {
      const auto origin = origins.find(path);
      return origin == origins.end() ? "" : origin->second;
    }

    /// The handler of all entries, from which laws read their parameters.
    mutable ParameterHandler handler;

  private:
    /// Load the laws, which have to be known before entries are declared.
    void
    load_shared_libraries(const std::vector<ParameterLine> &lines);

    void
    declare_scene();

    void
    declare_run();

    /// Give the entries their values.
    void
    read(const std::vector<ParameterLine> &lines);

    /// Make the entry `File' of a section absolute, so that the record of the
    /// run does not depend on the working directory; return it.
    std::string
    locate_file(const std::string                &section,
                const std::vector<ParameterLine> &lines);

    /// Let expressions use the tables. Throws ExcMessage with the line of the
    /// parameter file, and that of the table, if a table is invalid.
    void
    read_tables(const std::vector<ParameterLine> &lines);

    /// Throw if `Material' has entries that numbered materials replace.
    void
    check_material(const std::vector<ParameterLine> &lines) const;

    /// Throw if a material has the default of a number with a unit: in units
    /// that the scene chooses it means nothing.
    void
    check_defaults_of_materials() const;

    /// Replace choices `automatic' by their meaning in this scene. Throws
    /// ExcMessage if entries contradict `Error control/Tolerance'.
    void
    resolve_automatic_choices();

    /// Where values come from, by path of the entry; see origin_of().
    std::map<std::string, std::string> origins;
    /// The values in the files that contain units, by path of the entry.
    std::map<std::string, std::string> as_written;
  };
} // namespace Viscoplastic
