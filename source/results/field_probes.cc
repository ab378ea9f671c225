// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>

#include <viscoplastic_contact/discretization/energy.h>
#include <viscoplastic_contact/results/field_probes.h>

namespace Viscoplastic
{
  namespace
  {
    template <int dim>
    VertexWeights<dim>
    shape_values(const Point<dim> &unit)
    {
      VertexWeights<dim> result;
      for (unsigned int v = 0; v < result.size(); ++v)
        result[v] = GeometryInfo<dim>::d_linear_shape_function(unit, v);
      return result;
    }



    /// The physical quantity of an integral over a boundary or a material.
    Quantity
    integrated(const Quantity quantity, const bool is_of_boundary)
    {
      if (quantity == Quantity::stress)
        return is_of_boundary ? Quantity::force : Quantity::energy;
      if (quantity == Quantity::work_per_area && is_of_boundary)
        return Quantity::energy;
      if (quantity == Quantity::length && is_of_boundary)
        return Quantity::volume;
      if (quantity == Quantity::pure_number)
        return is_of_boundary ? Quantity::area : Quantity::volume;
      return Quantity::pure_number; // without a label of its own
    }
  } // namespace



  template <int dim>
  FieldProbes<dim>::FieldProbes(const Discretization<dim>     &discretization,
                                const std::vector<Point<dim>> &points,
                                const std::set<RecordedField> &fields)
    : discretization(discretization)
    , fields(fields)
    , all_columns(columns_of<dim>(fields, false))
    , n_body(all_columns.size())
    , is_on_face(points.size(), false)
  {
    const Triangulation<dim> &mesh =
      discretization.space.dof_handler.get_triangulation();
    const Scene<dim> &scene = discretization.scene();
    in_body =
      locate_points(mesh, points, [&scene](const types::material_id id) {
        return scene.is_present(id);
      }).points;
    const auto of_boundary = columns_of<dim>(fields, true);
    if (of_boundary.empty())
      return;
    all_columns.insert(all_columns.end(),
                       of_boundary.begin(),
                       of_boundary.end());
    const PointLocations<dim> found =
      locate_on_boundary(mesh,
                         points,
                         discretization.scene().contact_boundaries());
    on_face = found.points;
    for (std::size_t i = 0; i < points.size(); ++i)
      is_on_face[i] = found.distances[i] == 0.;
  }



  template <int dim>
  std::vector<double>
  FieldProbes<dim>::values(const State<dim> &state) const
  {
    const AdmissibleSpace<dim> &space   = discretization.space;
    const std::size_t           n_names = all_columns.size();
    const double        nothing = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> result(in_body.size() * n_names, 0.);
    {
      const BodyFields<dim> body(discretization.laws, state, fields);
      for (std::size_t i = 0; i < in_body.size(); ++i)
        if (const CellPoint<dim> &place = in_body[i]; place.is_mine())
          {
            double *const values = &result[i * n_names];
            if (space.scene.is_present(space.cells[place.cell]->material_id()))
              body.add(place.cell, shape_values(place.unit), values);
            else
              std::fill(values, values + n_body, nothing);
          }
    }
    if (!on_face.empty())
      {
        const BoundaryFields<dim> boundary(discretization.stress_space,
                                           state,
                                           discretization.face.get(),
                                           fields);
        for (std::size_t i = 0; i < on_face.size(); ++i)
          {
            const CellPoint<dim> &place  = on_face[i];
            double *const         values = &result[i * n_names];
            if (!is_on_face[i])
              std::fill(values + n_body, values + n_names, nothing);
            else if (place.is_mine())
              boundary.add(
                place.cell,
                place.face,
                shape_values(place.unit),
                space.scene.boundary
                  .at(space.cells[place.cell]->face(place.face)->boundary_id())
                  .normal,
                values + n_body);
          }
      }
    Utilities::MPI::sum(result, space.communicator, result);
    return result;
  }



  template <int dim>
  FieldIntegrals<dim>::FieldIntegrals(const Discretization<dim> &discretization)
    : discretization(discretization)
  {
    for (const OutputIntegral &integral :
         discretization.scene().output_integrals)
      {
        const bool is_boundary =
          integral.domain == OutputIntegral::Domain::boundary;
        pieces.push_back(pieces_of(integral));
        const auto add = [&](const std::string &name,
                             const Quantity     quantity,
                             const bool         is_of_step = false) {
          all_columns.push_back({name, quantity, is_of_step});
        };
        add((is_boundary ? "area_" : "volume_") + integral.name(),
            is_boundary ? Quantity::area : Quantity::volume);
        for (const bool of_boundary : {false, true})
          for (const FieldColumn &column :
               columns_of<dim>(integral.fields, of_boundary))
            add("integral_" + integral.name() + "_" + column.name,
                integrated(column.quantity, is_boundary));
        if (!integral.energies)
          continue;
        add("stored_energy_" + integral.name(), Quantity::energy);
        add("viscous_dissipation_" + integral.name(), Quantity::energy, true);
        const StressSpace<dim> &space = discretization.stress_space;
        if (!points)
          points = std::make_unique<const StressSpace<dim>>(
            space.space,
            space.moduli,
            /* at_quadrature_points = */ true,
            space.mean_dilatation);
      }
  }



  template <int dim>
  std::vector<typename FieldIntegrals<dim>::Piece>
  FieldIntegrals<dim>::pieces_of(const OutputIntegral &integral) const
  {
    using Domain                       = OutputIntegral::Domain;
    const AdmissibleSpace<dim> &space  = discretization.space;
    const FiniteElement<dim>   &fe     = space.dof_handler.get_fe();
    const UpdateFlags           update = update_values | update_JxW_values;
    FEValues<dim>      of_cell(space.mapping, fe, QGauss<dim>(2), update);
    FEFaceValues<dim>  of_face(space.mapping,
                              fe,
                              QGauss<dim - 1>(2),
                              update | update_normal_vectors);
    std::vector<Piece> result;
    const auto         add = [&](const FEValuesBase<dim> &values,
                         const std::size_t        cell,
                         const unsigned int       face) {
      Piece piece{cell, face, {}, {}};
      for (const unsigned int q : values.quadrature_point_indices())
        for (unsigned int v = 0; v < piece.weights.size(); ++v)
          piece.weights[v] += values.shape_value(v * dim, q) * values.JxW(q);
      result.push_back(piece);
    };
    for (std::size_t c = 0; c < space.cells.size(); ++c)
      {
        const auto              &cell = space.cells[c];
        const types::material_id id   = cell->material_id();
        if (!space.scene.is_present(id))
          continue;
        if (integral.domain == Domain::body ||
            (integral.domain == Domain::material && id == integral.id))
          {
            of_cell.reinit(cell);
            add(of_cell, c, numbers::invalid_unsigned_int);
          }
        if (integral.domain == Domain::boundary)
          for (const unsigned int f : cell->face_indices())
            if (cell->at_boundary(f) &&
                cell->face(f)->boundary_id() == integral.id)
              {
                of_face.reinit(cell, f);
                add(of_face, c, f);
                Tensor<1, dim> normal;
                double         area = 0.;
                for (const unsigned int q : of_face.quadrature_point_indices())
                  {
                    normal += of_face.normal_vector(q) * of_face.JxW(q);
                    area += of_face.JxW(q);
                  }
                // A face on the axis of revolution has no area and no normal.
                if (area > 0.)
                  result.back().normal = normal / area;
              }
      }
    return result;
  }



  template <int dim>
  std::array<double, 2>
  FieldIntegrals<dim>::energies(const std::vector<Piece> &cells,
                                const State<dim>         &old,
                                const State<dim>         &state) const
  {
    // 1/2 int E^-1 sigma : sigma with sigma = E eps(u) + z.
    const StressSpace<dim> &samples = discretization.stress_space;
    const FlowLaws<dim>    &laws    = discretization.laws;
    const auto              before  = laws.at(old.t, old.history),
               now                  = laws.at(state.t, state.history);
    std::vector<SymmetricTensor<2, 3>> strain(points->n_samples);
    std::array<double, 2>              result{{0., 0.}};
    for (const Piece &piece : cells)
      {
        const std::size_t c = piece.cell;
        points->strains(c, state.u.begin(), strain.data());
        for (unsigned int s = 0; s < points->n_samples; ++s)
          result[0] += 0.5 * points->weight(c, s) *
                       (points->moduli(c).stress(strain[s]) * strain[s]);
        if (!state.z.empty())
          {
            samples.strains(c, state.u.begin(), strain.data());
            for (unsigned int s = 0; s < samples.n_samples; ++s)
              result[0] += samples.weight(c, s) *
                           (state.z[c * samples.n_samples + s] * strain[s]);
          }
        const FlowEnergies energies =
          energies_of_cell(laws, before, now, old, state, c);
        result[0] += energies.irreversible_energy;
        result[1] += energies.viscous_dissipation;
      }
    return result;
  }



  template <int dim>
  std::vector<double>
  FieldIntegrals<dim>::values(const State<dim> &old,
                              const State<dim> &state) const
  {
    std::vector<double> result(all_columns.size(), 0.);
    double             *sums = result.data();
    for (std::size_t i = 0; i < pieces.size(); ++i)
      {
        const OutputIntegral &integral =
          discretization.scene().output_integrals[i];
        const std::set<RecordedField> &fields = integral.fields;
        const BodyFields<dim>          body(discretization.laws, state, fields);
        const BoundaryFields<dim>      boundary(discretization.stress_space,
                                           state,
                                           discretization.face.get(),
                                           fields);
        const std::size_t n_body = columns_of<dim>(fields, false).size();
        for (const Piece &piece : pieces[i])
          {
            for (const double weight : piece.weights)
              sums[0] += weight;
            body.add(piece.cell, piece.weights, sums + 1);
            boundary.add(piece.cell,
                         piece.face,
                         piece.weights,
                         piece.normal,
                         sums + 1 + n_body);
          }
        sums += 1 + n_body + columns_of<dim>(fields, true).size();
        if (integral.energies)
          for (const double energy : energies(pieces[i], old, state))
            *sums++ = energy;
      }
    Utilities::MPI::sum(result, discretization.space.communicator, result);
    return result;
  }



  VISCOPLASTIC_INSTANTIATE_CLASS(FieldProbes);
  VISCOPLASTIC_INSTANTIATE_CLASS(FieldIntegrals);
} // namespace Viscoplastic
