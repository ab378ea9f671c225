// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/error/history_error.h>

namespace Viscoplastic
{
  template <int dim>
  double
  cell_mean_defect(const LocalCells<dim> &cells,
                   const FlowLaws<dim>   &laws,
                   const State<dim>      &state)
  {
    const StressSpace<dim> &stress_space = laws.stress_space;
    const MPI_Comm          communicator = stress_space.space.communicator;
    Assert(stress_space.n_samples == 1, ExcInternalError());
    const auto now    = laws.at(state.t, state.history);
    double     square = 0.;
    fail_together(communicator, [&] {
      for (unsigned int c = 0; c < stress_space.n_cells(); ++c)
        {
          const ViscoplasticLaw *law = now.law(c);
          if (law == nullptr)
            continue;
          const auto    &cell    = cells.cells[c];
          const auto    &weights = cells.shapes[cell.shape].weights;
          const LawPoint point   = now.point(c, 0);
          const auto     strains =
            cells.strains(cell, cells.displacements(cell, state.u.begin()));
          SymmetricTensor<2, 3> mean;
          for (unsigned int q = 0; q < strains.size(); ++q)
            mean += strains[q] * (weights[q] / stress_space.volume(c));
          const auto tangents =
            law->tangents(cell.stiffness.stress(mean) + state.z[c],
                          now.mechanical(mean, c, 0),
                          cell.stiffness,
                          point);
          for (unsigned int q = 0; q < strains.size(); ++q)
            {
              const SymmetricTensor<2, 3> change = strains[q] - mean;
              square +=
                weights[q] * cell.stiffness.complementary_square(
                               tangents.stress * cell.stiffness.stress(change) +
                               tangents.strain * change);
            }
        }
    });
    return std::sqrt(Utilities::MPI::sum(square, communicator));
  }



  VISCOPLASTIC_INSTANTIATE(cell_mean_defect);
} // namespace Viscoplastic
