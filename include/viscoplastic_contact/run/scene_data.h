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
  /// Means of the data of a scene over space or time, and properties of its
  /// mesh. Means are expressions of x and t, by component of a vector, which
  /// can replace those of the parameter file; absent if data equal their means.
  /// Means over space are collective. Throws ExcMessage for unparsable data.
  class SceneData
  {
  public:
    virtual ~SceneData() = default;

    /// The mean over a boundary, as an expression of t that is exact at the
    /// ends of all steps and linear between them.
    virtual std::optional<std::string>
    over_boundary(const std::string &components,
                  const unsigned int id) const = 0;

    /// The mean over the cells of a material, or over all cells, likewise.
    virtual std::optional<std::string>
    over_body(const std::string                &components,
              const std::optional<unsigned int> material = {}) const = 0;

    /// The mean over the run, as an expression of x. Data that are uniform in
    /// space are integrated by two Gauss points per step, others by two Gauss
    /// points in each of up to eight parts of a phase.
    virtual std::optional<std::string>
    over_time(const std::string &components) const = 0;

    /// The area of a boundary; in 2D its length. Collective.
    virtual double
    area(const unsigned int id) const = 0;

    /// `Material/Volumetric integration', with `automatic' resolved.
    /// Collective.
    virtual VolumetricIntegration
    volumetric_integration() const = 0;

    /// Return the data of a scene on its first mesh. Collective.
    static std::unique_ptr<const SceneData>
    of(const Parameters &scene, const MPI_Comm communicator);
  };


  /// Return the function of t that interpolates these values linearly as an
  /// expression; constant before the first time and linear after the last.
  /// Points on a line between others are left out.
  std::string
  piecewise_linear(const std::vector<double> &times,
                   const std::vector<double> &values);
} // namespace Viscoplastic
