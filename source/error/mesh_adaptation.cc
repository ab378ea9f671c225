// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/error/mesh_adaptation.h>
#include <viscoplastic_contact/mesh/cell_order.h>
#include <viscoplastic_contact/mesh/marking_threshold.h>
#include <viscoplastic_contact/mesh/mesh_refinement.h>

#include <cmath>
#include <limits>

namespace Viscoplastic
{
  namespace
  {
    /// Number of owned parents all of whose children are to be removed. Ranks
    /// own siblings together.
    template <int dim>
    unsigned int
    n_coarsened_parents(
      const parallel::distributed::Triangulation<dim> &triangulation)
    {
      unsigned int n = 0;
      for (const auto &cell : owned_cells(triangulation))
        if (cell->coarsen_flag_set() && cell->parent()->child(0) == cell)
          {
            bool all = true;
            for (const auto &sibling : cell->parent()->child_iterators())
              all &= sibling->is_active() && sibling->coarsen_flag_set();
            n += all;
          }
      return n;
    }



    /**
     * Flag the cells with the largest estimates that make up a fraction of
     * their sum for refinement, and those with the smallest for coarsening.
     */
    template <int dim>
    void
    flag_fractions(parallel::distributed::Triangulation<dim> &triangulation,
                   const Vector<double>                      &squared_estimate,
                   const RefinementParameters                &parameters)
    {
      const MPI_Comm comm = triangulation.get_communicator();
      std::vector<std::pair<double, double>> estimates;
      double                                 total = 0.;
      for (const auto &cell : owned_cells(triangulation))
        {
          const double value = squared_estimate[cell->active_cell_index()];
          estimates.emplace_back(value, value);
          total += value;
        }
      total = Utilities::MPI::sum(total, comm);

      // A sum that hits the fraction exactly, as of equal cells, has reached
      // it, whatever rounding says.
      const double slack        = 1e-3;
      const double refined      = parameters.refinement_fraction;
      const double coarsened    = parameters.coarsening_fraction;
      const double infinity     = std::numeric_limits<double>::infinity();
      double       refine_above = refined >= 1. ? -1. : infinity;
      if (total > 0. && refined > 0. && refined < 1.)
        refine_above = marking_threshold(estimates,
                                         (1. - slack) * refined * total,
                                         ThresholdSide::below,
                                         comm);
      double coarsen_below = coarsened >= 1. ? infinity : 0.;
      if (total > 0. && coarsened > 0. && coarsened < 1.)
        coarsen_below =
          marking_threshold(estimates,
                            (1. - (1. + slack) * coarsened) * total,
                            ThresholdSide::below,
                            comm);
      for (const auto &cell : owned_cells(triangulation))
        {
          const double value = squared_estimate[cell->active_cell_index()];
          if (value > refine_above)
            cell->set_refine_flag();
          else if (value < coarsen_below)
            cell->set_coarsen_flag();
        }
    }



    /**
     * Withdraw the smallest of the marked cells until at most @p n_allowed of
     * all ranks are left.
     */
    template <int dim>
    void
    limit_refinement(parallel::distributed::Triangulation<dim> &triangulation,
                     const Vector<double> &squared_estimate,
                     const double          n_allowed)
    {
      std::vector<std::pair<double, double>> marked;
      for (const auto &cell : owned_cells(triangulation))
        if (cell->refine_flag_set())
          marked.emplace_back(squared_estimate[cell->active_cell_index()], 1.);
      const double threshold =
        marking_threshold(marked,
                          std::floor(n_allowed) + 1.,
                          ThresholdSide::above,
                          triangulation.get_communicator());
      for (const auto &cell : owned_cells(triangulation))
        if (squared_estimate[cell->active_cell_index()] <= threshold)
          cell->clear_refine_flag();
    }



    /// Whether the marked cells are worth a new mesh.
    template <int dim>
    bool
    is_worth_it(const parallel::distributed::Triangulation<dim> &triangulation,
                const Vector<double> &squared_estimate,
                const double          smallest_share)
    {
      double       total = 0., refined = 0.;
      unsigned int n_refined = 0, n_changed = 0;
      for (const auto &cell : owned_cells(triangulation))
        {
          const double value = squared_estimate[cell->active_cell_index()];
          total += value;
          if (cell->refine_flag_set())
            {
              refined += value;
              ++n_refined;
            }
          n_changed += cell->refine_flag_set() || cell->coarsen_flag_set();
        }
      const MPI_Comm comm = triangulation.get_communicator();
      if (Utilities::MPI::sum(n_changed, comm) == 0)
        return false;
      const double n_coarsened =
        Utilities::MPI::sum(n_coarsened_parents(triangulation), comm);
      const double n_gone =
        (Utilities::pow(2, dim) - 1) *
        (n_coarsened - Utilities::MPI::sum(n_refined, comm));
      return Utilities::MPI::sum(refined, comm) >=
               smallest_share * Utilities::MPI::sum(total, comm) ||
             n_gone >= 0.1 * triangulation.n_global_active_cells();
    }
  } // namespace



  template <int dim>
  bool
  mark_cells(parallel::distributed::Triangulation<dim> &triangulation,
             const Vector<double>                      &squared_estimate,
             const RefinementParameters                &parameters,
             const std::function<void()>               &limit_coarsening)
  {
    AssertDimension(squared_estimate.size(), triangulation.n_active_cells());
    const MPI_Comm comm = triangulation.get_communicator();

    flag_fractions(triangulation, squared_estimate, parameters);

    unsigned int n_refined = 0;
    for (const auto &cell : owned_cells(triangulation))
      {
        const auto level = static_cast<unsigned int>(cell->level());
        if (level >= parameters.maximal_level)
          cell->clear_refine_flag();
        if (level <= parameters.minimal_level)
          cell->clear_coarsen_flag();
        n_refined += cell->refine_flag_set();
      }

    // A refined cell adds, and a coarsened family removes, 2^dim - 1 cells.
    const double new_cells = Utilities::pow(2, dim) - 1;
    const double allowed =
      std::max(0.,
               (static_cast<double>(parameters.cell_budget) -
                triangulation.n_global_active_cells()) /
                   new_cells +
                 Utilities::MPI::sum(n_coarsened_parents(triangulation), comm));
    if (Utilities::MPI::sum(static_cast<double>(n_refined), comm) > allowed)
      limit_refinement(triangulation, squared_estimate, allowed);

    prepare_mesh_change(triangulation);
    if (limit_coarsening)
      limit_coarsening();
    if (is_worth_it(triangulation, squared_estimate, parameters.smallest_share))
      return true;
    for (const auto &cell : triangulation.active_cell_iterators())
      {
        cell->clear_refine_flag();
        cell->clear_coarsen_flag();
      }
    return false;
  }



  template <int dim>
  bool
  mark_cells_to_tolerance(
    parallel::distributed::Triangulation<dim> &triangulation,
    const Vector<double>                      &squared_estimate,
    const RefinementParameters                &parameters,
    const double                               ratio,
    const std::function<void()>               &limit_coarsening)
  {
    // The squared estimate of cells of twice the size is four times as large.
    const double aim = 0.85, coarsen_below = 0.6, square = ratio * ratio;
    RefinementParameters chosen(parameters);
    chosen.refinement_fraction = 0.;
    chosen.coarsening_fraction = 0.;
    if (ratio > 1.)
      {
        chosen.refinement_fraction =
          std::min(0.6, (1. - aim * aim / square) / 0.75);
        if (limit_coarsening)
          chosen.coarsening_fraction = 0.05 / (3. * square);
        // Neither for coarser cells alone, nor for the few that bounds on the
        // level or the number of cells have left of what was wanted.
        chosen.smallest_share = 0.1;
      }
    else if (ratio < coarsen_below && limit_coarsening)
      {
        chosen.coarsening_fraction =
          ratio > 0. ? std::min(0.5, (aim * aim - square) / (6. * square)) :
                       0.5;
        chosen.smallest_share = 1.;
      }
    else
      return false;
    return mark_cells(triangulation,
                      squared_estimate,
                      chosen,
                      limit_coarsening);
  }



  namespace
  {
    /// sigma_h at all samples.
    template <int dim>
    IrreversibleStress
    sampled_stress(const StressSpace<dim> &stress_space,
                   const State<dim>       &state)
    {
      const unsigned int                 n = stress_space.n_samples;
      IrreversibleStress                 result(state.z);
      std::vector<SymmetricTensor<2, 3>> strains(n);
      for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
        {
          stress_space.strains(c, state.u.begin(), strains.data());
          for (unsigned int s = 0; s < n; ++s)
            result[c * n + s] += stress_space.moduli(c).stress(strains[s]);
        }
      return result;
    }
  } // namespace



  template <int dim>
  StateTransfer<dim>::StateTransfer(
    parallel::distributed::Triangulation<dim> &triangulation,
    const StressSpace<dim>                    &old_stress_space,
    const State<dim>                          &state,
    const DistributedVector                   *multiplier_density,
    const Vector<double>                      &if_refined)
    : triangulation(triangulation)
    , n_samples(old_stress_space.n_samples)
    , old_fields{{state.u,
                  state.velocity,
                  state.initial_u,
                  state.friction_work,
                  multiplier_density ? *multiplier_density :
                                       DistributedVector()}}
    , field_transfer(old_stress_space.space.dof_handler)
    , handle(numbers::invalid_unsigned_int)
    , if_refined(if_refined)
    , n(state.n)
    , t(state.t)
    , k(state.k)
  {
    std::vector<const DistributedVector *> present;
    for (const DistributedVector &field : old_fields)
      if (field.size() > 0)
        present.push_back(&field);
    field_transfer.prepare_for_coarsening_and_refinement(present);

    // A rank without cells has empty fields in every scene.
    const auto sampled = sample_fields(state);
    for (unsigned int f = 0; f < sampled.size(); ++f)
      if (Utilities::MPI::max(sampled[f]->empty() ? 0 : 1,
                              old_stress_space.space.communicator) == 1)
        {
          AssertDimension(sampled[f]->size(),
                          old_stress_space.n_cells() * n_samples);
          carried.push_back(f);
          old_samples.push_back(*sampled[f]);
        }
    if (carried.empty())
      return;
    if (old_stress_space.space.scene.has_viscosity())
      {
        carried.push_back(stress);
        old_samples.push_back(sampled_stress(old_stress_space, state));
      }
    old_cell.resize(triangulation.n_active_cells());
    unsigned int index = 0;
    for (const auto &cell : old_stress_space.space.cells)
      {
        for (unsigned int s = 0; s < n_samples; ++s)
          old_weights.push_back(old_stress_space.weight(index, s));
        old_cell[cell->active_cell_index()] = index++;
      }

    prolongation = old_stress_space.prolongation();

    handle = triangulation.register_data_attach(
      [this](const CellIterator &cell, const CellStatus status) {
        return pack(cell, status);
      },
      /* returns_variable_size_data = */ false);
  }



  template <int dim>
  std::vector<char>
  StateTransfer<dim>::pack(const CellIterator &cell,
                           const CellStatus    status) const
  {
    // The samples and their integral. For a cell to be coarsened, instead of
    // the samples r of the parent to be, which divides by its own weights W_r:
    //
    //   W_r z_r = sum over samples s of all children: w_s P_sr z_s.
    //
    // Since sum_r P_sr = 1, sum_r W_r z_r is the integral over the children on
    // curved cells, too. On straight ones this is the L2 projection, as the
    // Gauss rule integrates the parent's mass matrix (in 3D: on affine cells)
    // exactly, diagonal as it is.
    if (status == Triangulation<dim>::CELL_REFINE && if_refined.size() > 0)
      of_refined_cells += if_refined[cell->active_cell_index()];
    IrreversibleStress values(carried.size() * (n_samples + 1));
    for (unsigned int f = 0; f < carried.size(); ++f)
      {
        SymmetricTensor<2, 3>    *packed = &values[f * (n_samples + 1)];
        const IrreversibleStress &old    = old_samples[f];
        if (status == Triangulation<dim>::CELL_COARSEN)
          {
            for (unsigned int child = 0; child < cell->n_children(); ++child)
              {
                const std::size_t first =
                  std::size_t(n_samples) *
                  old_cell[cell->child(child)->active_cell_index()];
                for (unsigned int s = 0; s < n_samples; ++s)
                  for (unsigned int r = 0; r < n_samples; ++r)
                    packed[r] += old_weights[first + s] *
                                 prolongation[child](s, r) * old[first + s];
              }
          }
        else
          {
            const std::size_t first =
              std::size_t(n_samples) * old_cell[cell->active_cell_index()];
            for (unsigned int s = 0; s < n_samples; ++s)
              {
                packed[s] = old[first + s];
                packed[n_samples] += old_weights[first + s] * old[first + s];
              }
          }
      }
    return Utilities::pack(values, /* allow_compression = */ false);
  }



  template <int dim>
  typename StateTransfer<dim>::Result
  StateTransfer<dim>::unpack(const StressSpace<dim> &new_stress_space)
  {
    AssertDimension(new_stress_space.n_samples, n_samples);
    const AdmissibleSpace<dim> &space = new_stress_space.space;

    Result result;
    result.state.n = n;
    result.state.t = t;
    result.state.k = k;

    const std::array<DistributedVector *, 5> targets{
      {&result.state.u,
       &result.state.velocity,
       &result.state.initial_u,
       &result.state.friction_work,
       &result.multiplier_density}};
    std::vector<DistributedVector>   fields;
    std::vector<DistributedVector *> field_pointers;
    for (const DistributedVector &field : old_fields)
      if (field.size() > 0)
        fields.push_back(space.owned_vector());
    for (DistributedVector &field : fields)
      field_pointers.push_back(&field);
    field_transfer.interpolate(field_pointers);
    for (unsigned int i = 0, next = 0; i < targets.size(); ++i)
      if (old_fields[i].size() > 0)
        {
          space.distribute_hanging_nodes(fields[next]);
          *targets[i] = space.ghosted_vector();
          *targets[i] = fields[next++];
        }

    if (carried.empty())
      return result;
    result.of_refined_cells =
      Utilities::MPI::sum(of_refined_cells, space.communicator);
    const auto of_state = sample_fields(result.state);
    const auto sampled  = [&](const unsigned int f) {
      return f == stress ? &result.stress : of_state[f];
    };
    for (const unsigned int f : carried)
      sampled(f)->resize(new_stress_space.n_cells() * n_samples);
    std::vector<unsigned int> new_cell(triangulation.n_active_cells());
    unsigned int              index = 0;
    for (const auto &cell : space.cells)
      new_cell[cell->active_cell_index()] = index++;
    AssertDimension(index, new_stress_space.n_cells());

    const auto unpack_field = [&](const CellIterator          &cell,
                                  const CellStatus             status,
                                  const SymmetricTensor<2, 3> *values,
                                  IrreversibleStress          &z) {
      if (status == Triangulation<dim>::CELL_REFINE)
        {
          // On curved cells the children do not fill the parent; a shift
          // makes up for it.
          SymmetricTensor<2, 3> missing = values[n_samples];
          double                volume  = 0.;
          for (unsigned int child = 0; child < cell->n_children(); ++child)
            {
              const std::size_t c =
                new_cell[cell->child(child)->active_cell_index()];
              volume += new_stress_space.volume(c);
              for (unsigned int s = 0; s < n_samples; ++s)
                {
                  SymmetricTensor<2, 3> &sample = z[c * n_samples + s];
                  for (unsigned int r = 0; r < n_samples; ++r)
                    sample += prolongation[child](s, r) * values[r];
                  missing -= new_stress_space.weight(c, s) * sample;
                }
            }
          for (const auto &child : cell->child_iterators())
            for (unsigned int s = 0; s < n_samples; ++s)
              z[std::size_t(n_samples) * new_cell[child->active_cell_index()] +
                s] += missing / volume;
        }
      else
        {
          const std::size_t c = new_cell[cell->active_cell_index()];
          for (unsigned int s = 0; s < n_samples; ++s)
            z[c * n_samples + s] = status == Triangulation<dim>::CELL_COARSEN ?
                                     values[s] / new_stress_space.weight(c, s) :
                                     values[s];
        }
    };

    triangulation.notify_ready_to_unpack(
      handle,
      [&](
        const CellIterator                                             &cell,
        const CellStatus                                                status,
        const boost::iterator_range<std::vector<char>::const_iterator> &data) {
        const auto values =
          Utilities::unpack<IrreversibleStress>(data.begin(),
                                                data.end(),
                                                /* allow_compression = */
                                                false);
        for (unsigned int f = 0; f < carried.size(); ++f)
          unpack_field(cell,
                       status,
                       &values[f * (n_samples + 1)],
                       *sampled(carried[f]));
      });
    return result;
  }



  template <int dim>
  void
  share_mismatch(const StressSpace<dim>   &stress_space,
                 const IrreversibleStress &stress,
                 State<dim>               &state)
  {
    const unsigned int       n       = stress_space.n_samples;
    const IrreversibleStress present = sampled_stress(stress_space, state);
    const auto               square  = [&](const IrreversibleStress &field,
                            const std::size_t         c) {
      double result = 0.;
      for (unsigned int s = 0; s < n; ++s)
        result += stress_space.weight(c, s) *
                  Utilities::fixed_power<2>(deviator(field[c * n + s]).norm());
      return result;
    };
    for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
      {
        const double of_z = std::sqrt(square(state.z, c)),
                     size = of_z + std::sqrt(square(stress, c));
        if (of_z == 0.)
          continue;
        for (unsigned int s = 0; s < n; ++s)
          {
            const SymmetricTensor<2, 3> mismatch =
              deviator(stress[c * n + s] - present[c * n + s]);
            // What has not changed stays as it is to the last digit.
            if (mismatch.norm() >
                1e-12 * size / std::sqrt(stress_space.volume(c)))
              state.z[c * n + s] += of_z / size * mismatch;
          }
      }
  }



  template <int dim>
  ContactState
  contact_on_new_mesh(const Discretization<dim> &discretization,
                      const State<dim>          &state,
                      const DistributedVector   &multiplier_density)
  {
    const ContactFace<dim>   &face = *discretization.face;
    const std::vector<double> rates =
      face.slip_rates(state.velocity, state.t - state.k, state.t);
    ContactState contact(face.bounds(state.t, rates));
    contact.multiplier            = face.multipliers(multiplier_density);
    const ContactLayout &layout   = face.layout();
    DistributedVector    velocity = discretization.space.owned_vector();
    if (face.has_obstacles())
      {
        discretization.space.to_frames(state.u, velocity);
        const std::vector<Tensor<1, 2>> carried_over = contact.multiplier;
        face.set_obstacles(state.t, velocity, contact);
        for (unsigned int p = 0; p < contact.n_points(); ++p)
          if (const ContactLayout::Point &point = layout.points[p];
              point.is_obstacle)
            {
              const double force = std::max(0., carried_over[p][0]);
              // The pressure is known better than the penetration, which at new
              // nodes is that of an interpolant; at corners it is all there is.
              if (point.gives_way() && layout.first_point[point.node + 1] -
                                           layout.first_obstacle(point.node) >
                                         1)
                continue;
              contact.multiplier[p][0] = force;
              if (point.gives_way())
                contact.bound[p] = force > 0. ?
                                     -point.compliance.penetration(force) :
                                     std::max(0., contact.bound[p]);
            }
        face.add_computed_bounds(state.t, contact, contact.bound, rates);
      }
    discretization.space.to_frames(state.velocity, velocity);
    auto       slip_rates = face.slips(velocity);
    const auto carried    = face.foundation_step(state.t - state.k, state.t);
    for (unsigned int p = 0; p < carried.size(); ++p)
      slip_rates[p] -= carried[p] / state.k;
    const double max_speed = velocity.linfty_norm();
    for (unsigned int p = 0; p < contact.n_points(); ++p)
      {
        const double bound      = contact.bound[p];
        auto        &multiplier = contact.multiplier[p];
        const double size       = stable_norm(multiplier);
        if (layout.points[p].is_obstacle)
          {
            contact.sticks[p] = size > 0.;
            continue;
          }
        if (size > bound)
          multiplier *= bound / size;
        // A bound of the slip rate is that of the next step.
        contact.sticks[p] = (rates.empty() && size < (1. - 1e-6) * bound) ||
                            stable_norm(slip_rates[p]) <= 1e-12 * max_speed;
      }
    return contact;
  }



  template bool
  mark_cells<2>(parallel::distributed::Triangulation<2> &,
                const Vector<double> &,
                const RefinementParameters &,
                const std::function<void()> &);
  template bool
  mark_cells<3>(parallel::distributed::Triangulation<3> &,
                const Vector<double> &,
                const RefinementParameters &,
                const std::function<void()> &);
  template bool
  mark_cells_to_tolerance<2>(parallel::distributed::Triangulation<2> &,
                             const Vector<double> &,
                             const RefinementParameters &,
                             const double,
                             const std::function<void()> &);
  template bool
  mark_cells_to_tolerance<3>(parallel::distributed::Triangulation<3> &,
                             const Vector<double> &,
                             const RefinementParameters &,
                             const double,
                             const std::function<void()> &);
  template void
  share_mismatch<2>(const StressSpace<2> &,
                    const IrreversibleStress &,
                    State<2> &);
  template void
  share_mismatch<3>(const StressSpace<3> &,
                    const IrreversibleStress &,
                    State<3> &);
  template class StateTransfer<2>;
  template class StateTransfer<3>;
  template ContactState
  contact_on_new_mesh<2>(const Discretization<2> &,
                         const State<2> &,
                         const DistributedVector &);
  template ContactState
  contact_on_new_mesh<3>(const Discretization<3> &,
                         const State<3> &,
                         const DistributedVector &);
} // namespace Viscoplastic
