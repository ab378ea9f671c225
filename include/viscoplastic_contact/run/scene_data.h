// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/parameters/parameter_file.h>

#include <mpi.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Viscoplastic
{
  /// What follows from the data of a scene and its mesh. Means are expressions
  /// of x and t, each component of a vector by itself, that can take the place
  /// of those of the parameter file; nothing for data that are their own means.
  /// Those over space are collective. They throw ExcMessage for what cannot be
  /// parsed.
  class SceneData
  {
  public:
    virtual ~SceneData() = default;

    /// The mean over the faces of a boundary, as an expression of t that agrees
    /// with it at the ends of all steps and is linear between them.
    virtual std::optional<std::string>
    over_boundary(const std::string &components,
                  const unsigned int id) const = 0;

    /// The mean over the cells of a material, or over all of them, likewise.
    virtual std::optional<std::string>
    over_body(const std::string                &components,
              const std::optional<unsigned int> material = {}) const = 0;

    /// The mean over the run, as an expression of x: by Gauss' rule with two
    /// points in each step where the datum is the same everywhere, else in
    /// eighths of each phase.
    virtual std::optional<std::string>
    over_time(const std::string &components) const = 0;

    /// The area of a boundary, in the plane its length. Collective.
    virtual double
    area(const unsigned int id) const = 0;

    /// `Material/Volumetric integration', or what `automatic' stands for.
    /// Collective.
    virtual VolumetricIntegration
    volumetric_integration() const = 0;

    /// The data of a scene on its first mesh. Collective.
    static std::unique_ptr<const SceneData>
    of(const Parameters &scene, const MPI_Comm communicator);
  };


  /// A number as a text that gives the same number.
  std::string
  exact(const double value);


  /// The function that is linear between these values, and constant before and
  /// linear after them, as an expression of t. Points on a line between others
  /// are left out.
  std::string
  piecewise_linear(const std::vector<double> &times,
                   const std::vector<double> &values);
} // namespace Viscoplastic
