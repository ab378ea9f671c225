// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <viscoplastic_contact/discretization/admissible_space.h>
#include <viscoplastic_contact/discretization/state.h>

#include <vector>

namespace Viscoplastic
{
  /// The area of bilateral contact under tension: such contact cannot open, so
  /// tension shows that the model does not hold.
  template <int dim>
  class ContactTension
  {
  public:
    /// Collective.
    explicit ContactTension(const StressSpace<dim> &stress_space);

    /// The area of bilateral contact that is not glued.
    double
    area() const
    {
      return total_area;
    }

    /// The area where the normal stress (cell means) is tensile by more than a
    /// thousandth of the largest stress there (Frobenius norm). Collective.
    double
    tension_area(const State<dim> &state) const;

  private:
    struct Face
    {
      std::size_t    cell;
      Tensor<1, dim> normal;
      double         area;
    };

    const StressSpace<dim> &stress_space;
    std::vector<Face>       faces; // of owned cells
    double                  total_area;
  };



  /// How far two bodies slide along each other, and the part of a face with
  /// nothing opposite. Places opposite are those of the undeformed bodies,
  /// which holds as long as slides are small compared with a face.
  template <int dim>
  class InterfaceSlide
  {
  public:
    /// Keeps a reference to the argument. Collective.
    explicit InterfaceSlide(const AdmissibleSpace<dim> &space);

    /// The largest slide of a node over the width of its largest face, the root
    /// of the area (in the plane the length). Collective.
    double
    largest(const DistributedVector &ghosted_u) const;

    /// The part of each boundary with contact to another body whose nodes have
    /// nothing opposite; the same on all ranks.
    const std::map<types::boundary_id, double> &
    uncovered_shares() const
    {
      return shares;
    }

  private:
    struct Node
    {
      std::size_t    position; // of its first entry among the relevant ones
      Tensor<1, dim> normal;
      double         width;
    };

    const AdmissibleSpace<dim>          &space;
    std::vector<Node>                    nodes; // of this rank
    std::map<types::boundary_id, double> shares;
  };
} // namespace Viscoplastic
