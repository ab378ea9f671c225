// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/index_set.h>

#include <viscoplastic_contact/base/types.h>
#include <viscoplastic_contact/contact/contact_layout.h>

#include <vector>

namespace Viscoplastic
{
  /// The restriction R of distributed vectors to the contact face, and its
  /// transpose. Each entry of a face vector is a degree of freedom that this
  /// rank owns, so that nothing but the constructor communicates.
  class FaceRestriction
  {
  public:
    FaceRestriction() = default;

    /// @p dofs: the global degree of freedom of each entry of a face vector;
    /// @p owned: the degrees of freedom of this rank. Collective.
    FaceRestriction(ContactLayout                        face,
                    std::vector<types::global_dof_index> dofs,
                    const IndexSet                      &owned);

    const ContactLayout &
    face() const
    {
      return contact_layout;
    }

    /// Add a foundation piece to an obstacle, see NormalCompliance::add().
    void
    add_compliance(const unsigned int point,
                   const double       factor,
                   const PressureLaw &law)
    {
      contact_layout.points[point].compliance.add(factor, law);
    }

    /// The number of entries of face vectors on all ranks together.
    types::global_dof_index
    n_global_dofs() const
    {
      return numbers.size();
    }

    /// The global numbers of this rank's entries, a contiguous range.
    const IndexSet &
    global_numbers() const
    {
      return numbers;
    }

    /// The global degree of freedom of each entry.
    const std::vector<types::global_dof_index> &
    dofs() const
    {
      return global_dofs;
    }

    /// The position of each entry's degree of freedom among those that this
    /// rank owns.
    const std::vector<unsigned int> &
    positions() const
    {
      return owned_positions;
    }

    /// The face vector R v.
    Vector<double>
    gather(const DistributedVector &v) const;

    /// Set the entries of @p v on the face to those of @p x.
    void
    set(const Vector<double> &x, DistributedVector &v) const;

    /// v := v + factor R^T x.
    void
    add(const double          factor,
        const Vector<double> &x,
        DistributedVector    &v) const;

    /// Apply the projectors of a truncation, node by node; nothing happens if
    /// it has none.
    void
    project(const FaceTruncation &truncation, DistributedVector &v) const
    {
      if (!truncation.projector.empty())
        apply(truncation, &FaceTruncation::project, v);
    }

    /// Apply the function of FaceTruncation of the same name, if it has tilts.
    void
    tilt_equations(const FaceTruncation &truncation, DistributedVector &v) const
    {
      if (!truncation.tilt.empty())
        apply(truncation, &FaceTruncation::tilt_equations, v);
    }

    void
    tilt_motions(const FaceTruncation &truncation, DistributedVector &v) const
    {
      if (!truncation.tilt.empty())
        apply(truncation, &FaceTruncation::tilt_motions, v);
    }

    /// y := y + R^T springs R x.
    void
    add_springs(const FaceTruncation    &truncation,
                const DistributedVector &x,
                DistributedVector       &y) const;

  private:
    template <typename Function>
    void
    apply(const FaceTruncation &truncation,
          const Function        function,
          DistributedVector    &v) const
    {
      Vector<double> on_face = gather(v);
      (truncation.*function)(contact_layout, on_face);
      set(on_face, v);
    }

    ContactLayout                        contact_layout;
    std::vector<types::global_dof_index> global_dofs;
    std::vector<unsigned int>            owned_positions;
    IndexSet                             numbers;
  };
} // namespace Viscoplastic
