// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/base/units.h>
#include <viscoplastic_contact/laws/viscoplastic_law.h>
#include <viscoplastic_contact/parameters/parameters.h>

#include <boost/property_tree/ptree_fwd.hpp>

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace Viscoplastic
{
  struct ParameterLine;

  /// One or several parameter files, read and checked as far as that is
  /// possible without a mesh. Expressions stay texts here: their number of
  /// components depends on the dimension, so Scene<dim> parses them. Numbers
  /// that have a unit in the files are numbers in the units of the scene here.
  class Parameters
  {
  public:
    /// Read @p files, of which later ones override earlier ones, and then the
    /// assignments `Section/Entry=value' of @p overrides. Subsections
    /// `Boundary 0', `Material 1' and so on are declared for the ids that these
    /// name. Without files everything has its default.
    ///
    /// Throws ExcMessage with a sentence that says where something unknown or
    /// wrong is, and what would be right.
    explicit Parameters(const std::vector<std::string> &files,
                        const std::vector<std::string> &overrides = {});

    explicit Parameters(const std::string &file);

    /// The structs below are bound to entries of the handler.
    Parameters(const Parameters &) = delete;
    Parameters &
    operator=(const Parameters &) = delete;

    /// The first of the files, which gives the scene its name.
    const std::string file;
    /// The shared libraries whose laws are known beside those of the program.
    std::vector<std::string>    shared_libraries;
    std::vector<LawDescription> laws;
    unsigned int                dimension = 2;
    UnitParameters              unit_names;
    /// The units in which all numbers are; not declared unless the scene does.
    Units              units;
    GeometryParameters geometry;
    /// The material of all cells; without meaning where there are numbered
    /// materials.
    MaterialParameters                         material;
    StressParameters                           stress;
    std::map<unsigned int, MaterialParameters> materials;
    SupportParameters                          supports;
    LoadParameters                             loads;
    TemperatureParameters                      temperature;
    InitialStateParameters                     initial_state;
    ExactSolutionParameters                    exact_solution;
    std::map<unsigned int, BoundaryParameters> boundaries;
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

    /// A parameter file with every entry, numbers with the units that they have
    /// in the files: the record of a run.
    void
    print(std::ostream &out) const;

    /// Everything that is declared, as declared_entries() returns it, with
    /// values as they are in the files.
    boost::property_tree::ptree
    entries_as_written() const;

    /// The entries whose numbers have units in the files, by their paths, with
    /// these numbers in the units of the scene.
    std::map<std::string, std::string>
    entries_with_units() const;

    /// A message in which values of entries are replaced by what the files have
    /// for them, with their units.
    std::string
    quote_as_written(const std::string &sentence) const;

    /// Where an entry, given by its path, has been set last, as messages name
    /// it: file and line, or the assignment. Empty if it has its default.
    std::string
    origin_of(const std::string &path) const
    {
      const auto origin = origins.find(path);
      return origin == origins.end() ? "" : origin->second;
    }

    /// All entries again, from which laws read their parameters.
    mutable ParameterHandler handler;

  private:
    /// Load what must be there before entries can be declared.
    void
    load_shared_libraries(const std::vector<ParameterLine> &lines);

    void
    declare();

    /// Give the entries their values.
    void
    read(const std::vector<ParameterLine> &lines);

    /// Numbered materials replace the one for all cells.
    void
    check_material(const std::vector<ParameterLine> &lines) const;

    /// Replace choices `automatic' by what they stand for. Throws ExcMessage if
    /// entries contradict `Error control/Tolerance'.
    void
    resolve_automatic_choices();

    /// Make the name of the mesh file independent of the working directory.
    void
    locate_mesh_file(const std::vector<ParameterLine> &lines);

    /// By path of the entry, where its value comes from; see origin_of().
    std::map<std::string, std::string> origins;
    /// The values of the files that have units in them, by path.
    std::map<std::string, std::string> as_written;
  };
} // namespace Viscoplastic
