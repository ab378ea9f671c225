// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/parameters.h>

#include <map>

namespace Viscoplastic
{
  /**
   * A parameter file, read and checked as far as that is possible without a
   * mesh. Expressions stay texts here: their number of components depends on
   * the dimension, so Scene<dim> parses them.
   */
  class Parameters
  {
  public:
    /**
     * Read @p file. Subsections `Boundary <id>` are declared for the ids that
     * the file names. Throws ExcMessage or an exception of ParameterHandler.
     */
    explicit Parameters(const std::string &file);

    /// The structs below are bound to entries of the handler.
    Parameters(const Parameters &) = delete;
    Parameters &
    operator=(const Parameters &) = delete;

    const std::string  file;
    unsigned int       dimension = 2;
    GeometryParameters geometry;
    /// Of all cells, or of none where there are numbered materials.
    MaterialParameters material;
    StressParameters   stress;
    /// By material id of the cells.
    std::map<unsigned int, MaterialParameters> materials;
    LoadParameters                             loads;
    InitialStateParameters                     initial_state;
    std::map<unsigned int, BoundaryParameters> boundaries;
    TimeParameters                             time;
    SolverParameters                           solver;
    RefinementParameters                       refinement;
    OutputParameters                           output;

    /// The same with every entry, for law parameters and for the record.
    mutable ParameterHandler handler;

  private:
    void
    declare();

    /// The ids of `subsection Boundary <id>' and `Material <id>' in a file and
    /// in those that it includes decide what is declared.
    void
    find_numbered_subsections(const std::string &name,
                              const unsigned int depth);
  };
} // namespace Viscoplastic
