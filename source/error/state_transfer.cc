// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/error/state_transfer.h>

namespace Viscoplastic
{
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
    const DistributedVector                   *multiplier_density)
    : triangulation(triangulation)
    , n_samples(old_stress_space.n_samples)
    , old_fields{{state.u,
                  state.velocity,
                  state.initial_u,
                  state.friction_work,
                  state.carried_error_of_u,
                  multiplier_density ? *multiplier_density :
                                       DistributedVector()}}
    , field_transfer(old_stress_space.space.dof_handler)
    , handle(numbers::invalid_unsigned_int)
    , n(state.n)
    , t(state.t)
    , k(state.k)
    , time_error_unit(state.time_error_unit)
  {
    std::vector<const DistributedVector *> present;
    for (const DistributedVector &field : old_fields)
      if (field.size() > 0)
        {
          present.push_back(&field);
          if (const auto axial = old_stress_space.space.axial)
            old_axial.push_back(field.begin()[*axial]);
        }
    field_transfer.prepare_for_coarsening_and_refinement(present);

    // A field is present if any rank has it, as those without cells do not.
    for_each_sample_field(state, [&](const auto &field) {
      is_carried.push_back(
        Utilities::MPI::max(field.empty() ? 0 : 1,
                            old_stress_space.space.communicator) == 1);
      if (is_carried.back())
        old_samples.emplace_back(field.begin(), field.end());
    });
    if (old_samples.empty())
      return;
    is_carried.push_back(old_stress_space.space.scene.has_viscosity());
    if (is_carried.back())
      {
        old_samples.push_back(sampled_stress(old_stress_space, state));
        // z is the first field.
        for_children =
          reconstruct_history(old_stress_space, state.z, old_samples.back());
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
    // Pack the samples of each field (of cell means to be refined: values of
    // the children) and their integral. For cells to be coarsened, pack
    // weighted samples r of the parent, which unpack_samples() divides by its
    // weights W_r:
    //
    //   W_r z_r = sum over samples s of all children: w_s P_sr z_s.
    //
    // Since sum_r P_sr = 1, sum_r W_r z_r is the integral over the children on
    // curved cells, too. On straight ones this is the L2 projection, as the
    // Gauss rule integrates the parent's diagonal mass matrix exactly (in 3D on
    // affine cells).
    const bool passes_on =
      status == Triangulation<dim>::CELL_REFINE && !for_children.z.empty();
    if (passes_on)
      of_refined_cells += for_children.squared_error[cell->active_cell_index()];
    const bool of_children =
      status == Triangulation<dim>::CELL_REFINE && n_samples == 1;
    const unsigned int n_fields = old_samples.size();
    IrreversibleStress values(n_fields * (n_values + 1));
    for (unsigned int f = 0; f < n_fields; ++f)
      {
        SymmetricTensor<2, 3>    *packed = &values[f * (n_values + 1)];
        const IrreversibleStress &old =
          passes_on && f == 0            ? for_children.z :
          passes_on && f == n_fields - 1 ? for_children.stress :
                                           old_samples[f];
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
            const std::size_t c = old_cell[cell->active_cell_index()];
            if (of_children)
              {
                const bool has_slopes = &old != &old_samples[f];
                for (unsigned int child = 0; child < n_values; ++child)
                  packed[child] = old[has_slopes ? c * n_values + child : c];
                packed[n_values] = old_weights[c] * old_samples[f][c];
                continue;
              }
            const std::size_t first = c * n_samples;
            for (unsigned int s = 0; s < n_samples; ++s)
              {
                packed[s] = old[first + s];
                packed[n_values] += old_weights[first + s] * old[first + s];
              }
          }
      }
    return Utilities::pack(values, /* allow_compression = */ false);
  }



  template <int dim>
  template <typename Field>
  void
  StateTransfer<dim>::unpack_samples(const CellIterator          &cell,
                                     const CellStatus             status,
                                     const SymmetricTensor<2, 3> *values,
                                     const StressSpace<dim> &new_stress_space,
                                     const std::vector<unsigned int> &new_cell,
                                     Field                           &z) const
  {
    if (status == Triangulation<dim>::CELL_REFINE)
      {
        // On curved cells the children do not fill the parent; a constant shift
        // conserves the integral.
        SymmetricTensor<2, 3> missing = values[n_values];
        double                volume  = 0.;
        for (unsigned int child = 0; child < cell->n_children(); ++child)
          {
            const std::size_t c =
              new_cell[cell->child(child)->active_cell_index()];
            volume += new_stress_space.volume(c);
            for (unsigned int s = 0; s < n_samples; ++s)
              {
                auto &sample = z[c * n_samples + s];
                if (n_samples == 1)
                  sample = values[child];
                else
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
  }



  template <int dim>
  typename StateTransfer<dim>::Result
  StateTransfer<dim>::unpack(const StressSpace<dim> &new_stress_space)
  {
    AssertDimension(new_stress_space.n_samples, n_samples);
    const AdmissibleSpace<dim> &space = new_stress_space.space;

    Result result;
    result.state.n               = n;
    result.state.t               = t;
    result.state.k               = k;
    result.state.time_error_unit = time_error_unit;

    const std::array<DistributedVector *, 6> targets{
      {&result.state.u,
       &result.state.velocity,
       &result.state.initial_u,
       &result.state.friction_work,
       &result.state.carried_error_of_u,
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
          if (const auto axial = space.owned_axial())
            fields[next].begin()[*axial] = old_axial[next];
          *targets[i] = space.ghosted_vector();
          *targets[i] = fields[next++];
        }

    if (old_samples.empty())
      return result;
    result.of_refined_cells =
      Utilities::MPI::sum(of_refined_cells, space.communicator);
    auto       is_present = is_carried.cbegin();
    const auto set_size   = [&](auto &field) {
      field.resize(*is_present++ ? new_stress_space.n_cells() * n_samples : 0);
    };
    for_each_sample_field(result.state, set_size);
    set_size(result.stress);
    std::vector<unsigned int> new_cell(triangulation.n_active_cells());
    unsigned int              index = 0;
    for (const auto &cell : space.cells)
      new_cell[cell->active_cell_index()] = index++;
    AssertDimension(index, new_stress_space.n_cells());

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
        const SymmetricTensor<2, 3> *next         = values.data();
        const auto                   unpack_field = [&](auto &field) {
          if (field.empty())
            return;
          unpack_samples(cell, status, next, new_stress_space, new_cell, field);
          next += n_values + 1;
        };
        for_each_sample_field(result.state, unpack_field);
        unpack_field(result.stress);
      });
    return result;
  }



  template <int dim>
  bool
  share_mismatch(const StressSpace<dim>   &stress_space,
                 const IrreversibleStress &stress,
                 const double              enough,
                 const double              error,
                 State<dim>               &state)
  {
    const unsigned int n      = stress_space.n_samples;
    IrreversibleStress shares = sampled_stress(stress_space, state);
    const auto         square = [&](const IrreversibleStress &field,
                            const std::size_t         c) {
      double result = 0.;
      for (unsigned int s = 0; s < n; ++s)
        result += stress_space.weight(c, s) *
                  Utilities::fixed_power<2>(deviator(field[c * n + s]).norm());
      return result;
    };
    std::vector<double> squares(2); // of the shares and of the stress
    for (std::size_t c = 0; c < stress_space.n_cells(); ++c)
      {
        const double of_z = std::sqrt(square(state.z, c)),
                     size = of_z + std::sqrt(square(stress, c));
        for (unsigned int s = 0; s < n; ++s)
          {
            SymmetricTensor<2, 3> &share = shares[c * n + s];
            share                        = deviator(stress[c * n + s] - share);
            // Rounding does not count: z without a mismatch stays bit for bit.
            share *=
              of_z > 0. && share.norm() >
                             1e-12 * size / std::sqrt(stress_space.volume(c)) ?
                of_z / size :
                0.;
            unsigned int k = 0;
            for (const auto &of : {share, stress[c * n + s]})
              squares[k++] += stress_space.weight(c, s) *
                              stress_space.moduli(c).complementary_square(of);
          }
      }
    Utilities::MPI::sum(squares, stress_space.space.communicator, squares);
    if (std::sqrt(squares[0]) <=
        enough * std::min(error, std::sqrt(squares[1])))
      return false;
    for (std::size_t i = 0; i < shares.size(); ++i)
      state.z[i] += shares[i];
    return true;
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
        for (const unsigned int o : layout.rigid(layout.obstacles()))
          contact.multiplier[o][0] = std::max(0., carried_over[o][0]);
        for (const unsigned int o : layout.compliant(layout.obstacles()))
          // The transferred pressure is more accurate than a penetration
          // interpolated to a new node; corners have only the latter.
          if (const ContactLayout::Point &point = layout.points[o];
              layout.obstacles(point.node).size() == 1)
            {
              const double force       = std::max(0., carried_over[o][0]);
              contact.multiplier[o][0] = force;
              contact.bound[o]         = force > 0. ?
                                           -point.compliance.penetration(force) :
                                           std::max(0., contact.gap(o));
            }
        face.add_computed_bounds(state.t, contact, contact.bound, rates);
      }
    discretization.space.to_frames(state.velocity, velocity);
    auto       slip_rates = face.slips(velocity);
    const auto carried    = face.foundation_step(state.t - state.k, state.t);
    for (unsigned int p = 0; p < carried.size(); ++p)
      slip_rates[p] -= carried[p] / state.k;
    const double max_speed = velocity.linfty_norm();
    for (const unsigned int o : layout.obstacles())
      contact.sticks[o] = stable_norm(contact.multiplier[o]) > 0.;
    for (const unsigned int p : layout.friction_points())
      {
        const double bound      = contact.bound[p];
        auto        &multiplier = contact.multiplier[p];
        const double size       = stable_norm(multiplier);
        if (size > bound)
          multiplier *= bound / size;
        // Bounds that depend on slip rates are not those of the last step, so
        // that multipliers below them do not imply sticking.
        contact.sticks[p] = (rates.empty() && size < (1. - 1e-6) * bound) ||
                            stable_norm(slip_rates[p]) <= 1e-12 * max_speed;
      }
    return contact;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(StateTransfer);
  VISCOPLASTIC_INSTANTIATE(share_mismatch);
  VISCOPLASTIC_INSTANTIATE(contact_on_new_mesh);
} // namespace Viscoplastic
