// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/error/history_error.h>

#include <cmath>

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
    const auto now    = laws.at(state.t);
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
                          mean,
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



  template <int dim>
  Vector<double>
  history_if_refined(const StressSpace<dim> &stress_space,
                     const State<dim>       &state,
                     const Vector<double>   &squared_error)
  {
    const unsigned int                 n = stress_space.n_samples;
    Vector<double>                     result(squared_error.size());
    std::vector<SymmetricTensor<2, 3>> strains(n);
    for (unsigned int c = 0; c < stress_space.n_cells(); ++c)
      {
        const Stiffness &stiffness = stress_space.moduli(c);
        stress_space.strains(c, state.u.begin(), strains.data());
        double of_z = 0., of_stress = 0.; // squared norms
        for (unsigned int s = 0; s < n; ++s)
          {
            const SymmetricTensor<2, 3> &z = state.z[c * n + s];
            of_z +=
              stress_space.weight(c, s) * stiffness.complementary_square(z);
            of_stress +=
              stress_space.weight(c, s) *
              stiffness.complementary_square(stiffness.stress(strains[s]) + z);
          }
        const unsigned int i = stress_space.space.cells[c]->active_cell_index();
        if (of_z > 0.)
          result[i] =
            0.75 * squared_error[i] * of_z /
            Utilities::fixed_power<2>(std::sqrt(of_z) + std::sqrt(of_stress));
      }
    return result;
  }



  template double
  cell_mean_defect<2>(const LocalCells<2> &,
                      const FlowLaws<2> &,
                      const State<2> &);
  template double
  cell_mean_defect<3>(const LocalCells<3> &,
                      const FlowLaws<3> &,
                      const State<3> &);
  template Vector<double>
  history_if_refined<2>(const StressSpace<2> &,
                        const State<2> &,
                        const Vector<double> &);
  template Vector<double>
  history_if_refined<3>(const StressSpace<3> &,
                        const State<3> &,
                        const Vector<double> &);
} // namespace Viscoplastic
