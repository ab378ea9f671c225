// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/error/volumetric_locking.h>

#include <numeric>

namespace Viscoplastic
{
  namespace
  {
    /// Diagonal deviators of unit norm, one for each pair of axes.
    template <int dim>
    std::vector<SymmetricTensor<2, 3>>
    unit_deviators()
    {
      std::vector<SymmetricTensor<2, 3>> result;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = i + 1; j < dim; ++j)
          {
            result.emplace_back();
            result.back()[i][i] = std::sqrt(0.5);
            result.back()[j][j] = -std::sqrt(0.5);
          }
      return result;
    }
  } // namespace



  template <int dim>
  VolumetricLocking
  volumetric_locking(
    const LocalCells<dim>                                &cells,
    const std::vector<typename LocalCells<dim>::Strains> &strains_of_cells,
    const FlowLaws<dim>                                  &laws,
    const State<dim>                                     &state,
    const double                                          defect)
  {
    const StressSpace<dim> &stress_space = laws.stress_space;
    const MPI_Comm          communicator = stress_space.space.communicator;
    const bool              at_points    = stress_space.n_samples > 1;
    const auto              deviators    = unit_deviators<dim>();
    const auto              now          = laws.at(state.t, state.history);
    std::vector<double>     squares(cells.cells.size());
    double                  rate = 0., deviators_square = 0.;
    fail_together(communicator, [&] {
      for (unsigned int c = 0; c < stress_space.n_cells(); ++c)
        {
          const auto &cell = cells.cells[c];
          if (!cell.is_present)
            continue;
          const Stiffness &stiffness = cell.stiffness;
          const double     two_mu = stiffness.smallest_deviatoric_eigenvalue(),
                       bulk       = stiffness.bulk_modulus();
          const auto &weights     = cells.shapes[cell.shape].weights;
          const auto &strains     = strains_of_cells[c];
          double      mean_trace = 0., mean_z = 0.;
          for (unsigned int q = 0; q < strains.size(); ++q)
            {
              mean_trace += weights[q] * trace(strains[q]);
              if (at_points)
                mean_z +=
                  weights[q] * trace(state.z[c * stress_space.n_samples + q]);
            }
          mean_trace /= stress_space.volume(c);
          mean_z /= stress_space.volume(c);
          const ViscoplasticLaw *law = now.law(c);
          const bool             flows =
            at_points && law != nullptr && law->deviatoric_flow();
          double       largest = 0.; // pressure
          unsigned int at      = 0;
          for (unsigned int q = 0; q < strains.size(); ++q)
            {
              const double dilatation = trace(strains[q]);
              deviators_square += weights[q] * two_mu *
                                  std::max(0.,
                                           strains[q] * strains[q] -
                                             dilatation * dilatation / 3.);
              double pressure = bulk * (dilatation - mean_trace);
              if (at_points && !state.z.empty())
                pressure +=
                  (trace(state.z[c * stress_space.n_samples + q]) - mean_z) /
                  3.;
              squares[c] += weights[q] * pressure * pressure / two_mu;
              if (std::abs(pressure) > largest)
                {
                  largest = std::abs(pressure);
                  at      = q;
                }
            }
          if (!flows || squares[c] == 0.)
            continue;
          // Tangents cost more than all the rest: evaluate those of one point.
          const auto tangents =
            law->tangents(stiffness.stress(strains[at]) +
                            state.z[c * stress_space.n_samples + at],
                          now.mechanical(strains[at], c, at),
                          stiffness,
                          now.point(c, at));
          for (const SymmetricTensor<2, 3> &deviator : deviators)
            rate += squares[c] * two_mu / deviators.size() *
                    stiffness.complementary_square(
                      SymmetricTensor<2, 3>(tangents.stress * deviator));
        }
    });
    rate             = Utilities::MPI::sum(rate, communicator);
    deviators_square = Utilities::MPI::sum(deviators_square, communicator);
    const double pressures_square =
      Utilities::MPI::sum(std::accumulate(squares.begin(), squares.end(), 0.),
                          communicator);
    // The factor is 3/2 in a single mode, but locked bodies, which hardly bend,
    // show less of their curvatures.
    constexpr double calibration = 2.5;
    // Bodies at rest under a pressure have deviators by rounding only.
    const double factor = deviators_square > 1e-20 * pressures_square ?
                            calibration * defect / deviators_square :
                            0.;
    for (double &square : squares)
      square *= factor;
    return {cells.by_active_index(squares), std::sqrt(factor * rate)};
  }



  VISCOPLASTIC_INSTANTIATE(volumetric_locking);
} // namespace Viscoplastic
