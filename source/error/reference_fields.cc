// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi_remote_point_evaluation.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/mapping_q1.h>

#include <viscoplastic_contact/base/binary_archive.h>
#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/error/reference_fields.h>

namespace Viscoplastic
{
  namespace
  {
    const FEValuesExtractors::Vector displacement(0);

    /// Begins a file of samples, and says of which dimension and version.
    template <int dim>
    constexpr double magic_number = 7.26e9 + dim;



    template <int dim, typename Sample>
    Point<dim>
    position(const Sample &sample)
    {
      Point<dim> x;
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = sample[d];
      return x;
    }



    /// Bring each sample to the owned cell it lies in:
    /// visit(cell, samples in it, their points on the unit cell). Returns
    /// after all ranks have.
    template <int dim, typename Sample, typename Visitor>
    void
    visit_cells_of(const std::vector<Sample> &samples,
                   const DoFHandler<dim>     &dof_handler,
                   const Visitor             &visit)
    {
      std::vector<Point<dim>> points;
      for (const Sample &sample : samples)
        points.push_back(position<dim>(sample));
      Utilities::MPI::RemotePointEvaluation<dim> remote(
        1e-6, /* enforce_unique_mapping = */ true);
      const MappingQ1<dim> mapping;
      remote.reinit(points, dof_handler.get_triangulation(), mapping);
      std::vector<Sample> buffer;
      using CellData =
        typename Utilities::MPI::RemotePointEvaluation<dim>::CellData;
      remote.template process_and_evaluate<Sample>(
        samples,
        buffer,
        [&](const ArrayView<const Sample> &values, const CellData &data) {
          for (unsigned int i = 0; i < data.cells.size(); ++i)
            {
              const typename DoFHandler<dim>::active_cell_iterator cell(
                &dof_handler.get_triangulation(),
                data.cells[i].first,
                data.cells[i].second,
                &dof_handler);
              const unsigned int begin = data.reference_point_ptrs[i],
                                 end   = data.reference_point_ptrs[i + 1];
              const ArrayView<const Sample> here(&values[begin], end - begin);
              visit(cell,
                    here,
                    std::vector<Point<dim>>(
                      data.reference_point_values.begin() + begin,
                      data.reference_point_values.begin() + end));
            }
        });
    }



    /// The mean of div u over a cell.
    template <int dim>
    class MeanDilatation
    {
    public:
      explicit MeanDilatation(const AdmissibleSpace<dim> &space)
        : space(space)
        , values(space.mapping,
                 space.dof_handler.get_fe(),
                 QGauss<dim>(2),
                 update_values | update_gradients | update_JxW_values |
                   update_quadrature_points)
        , u(values.n_quadrature_points)
        , gradients(values.n_quadrature_points)
        , strains(values.n_quadrature_points)
      {}

      template <typename Cell>
      double
      operator()(const Cell &cell, const DistributedVector &ghosted_u)
      {
        values.reinit(cell);
        values[displacement].get_function_values(ghosted_u, u);
        values[displacement].get_function_gradients(ghosted_u, gradients);
        for (unsigned int q = 0; q < strains.size(); ++q)
          strains[q] = strain(u[q],
                              gradients[q],
                              values.quadrature_point(q),
                              space.scene.plane_model(),
                              space.axial_strain(ghosted_u.begin()));
        return mean_dilatation(values.get_JxW_values(), strains);
      }

    private:
      const AdmissibleSpace<dim>        &space;
      FEValues<dim>                      values;
      std::vector<Tensor<1, dim>>        u;
      std::vector<Tensor<2, dim>>        gradients;
      std::vector<SymmetricTensor<2, 3>> strains;
    };



    template <int dim>
    void
    add_cells(const FieldSamples<dim> &reference,
              const StressSpace<dim>  &stress_space,
              const State<dim>        &state,
              SolutionNorms           &error,
              SolutionNorms           &norm)
    {
      using Samples           = FieldSamples<dim>;
      const auto &dof_handler = stress_space.space.dof_handler;
      const auto  stress      = stress_space.mean_stress(state.u, state.z);
      std::vector<unsigned int> owned_index(
        dof_handler.get_triangulation().n_active_cells());
      unsigned int n_owned = 0;
      for (const auto &cell : stress_space.space.cells)
        owned_index[cell->active_cell_index()] = n_owned++;

      const AdmissibleSpace<dim> &space = stress_space.space;
      MeanDilatation<dim>         mean_dilatation(space);
      std::vector<Tensor<2, dim>> gradients;
      visit_cells_of(
        reference.cells,
        dof_handler,
        [&](const auto &cell, const auto &samples, const auto &points) {
          const unsigned int i         = owned_index[cell->active_cell_index()];
          const Stiffness   &stiffness = stress_space.moduli(i);
          const double       dilatation =
            stress_space.mean_dilatation ? mean_dilatation(cell, state.u) : 0.;
          FEValues<dim> here(space.mapping,
                             dof_handler.get_fe(),
                             Quadrature<dim>(points),
                             update_values | update_gradients);
          here.reinit(cell);
          std::vector<Tensor<1, dim>> values(points.size());
          gradients.resize(points.size());
          here[displacement].get_function_values(state.u, values);
          here[displacement].get_function_gradients(state.u, gradients);
          for (unsigned int q = 0; q < points.size(); ++q)
            {
              const auto    &sample = samples[q];
              const double   w      = sample[dim];
              Tensor<1, dim> u;
              Tensor<2, dim> g;
              for (unsigned int d = 0; d < dim; ++d)
                {
                  u[d] = sample[Samples::u_index + d];
                  for (unsigned int e = 0; e < dim; ++e)
                    g[d][e] = sample[Samples::gradient_index + d * dim + e];
                }
              auto exact = strain(g, sample[Samples::zz_index]),
                   ours  = strain(values[q],
                                 gradients[q],
                                 position<dim>(sample),
                                 space.scene.plane_model(),
                                 space.axial_strain(state.u.begin()));
              if (stress_space.mean_dilatation)
                {
                  exact =
                    with_dilatation(exact, sample[Samples::dilatation_index]);
                  ours = with_dilatation(ours, dilatation);
                }
              const auto defect = exact - ours;
              error.energy += w * (stiffness.stress(defect) * defect);
              norm.energy += w * (stiffness.stress(exact) * exact);
              error.h1 += w * ((u - values[q]).norm_square() +
                               (g - gradients[q]).norm_square());
              norm.h1 += w * (u.norm_square() + g.norm_square());

              SymmetricTensor<2, 3> sigma;
              const auto            components = stress_components<dim>();
              for (unsigned int c = 0; c < components.size(); ++c)
                sigma[components[c].first][components[c].second] =
                  sample[Samples::stress_index + c];
              const auto difference = sigma - stress[i];
              error.stress += w * (difference * difference);
              norm.stress += w * (sigma * sigma);
            }
        });
    }



    template <int dim>
    void
    add_faces(const FieldSamples<dim>    &reference,
              const AdmissibleSpace<dim> &space,
              const DistributedVector    &density,
              SolutionNorms              &error,
              SolutionNorms              &norm)
    {
      const MappingQ1<dim> mapping;
      visit_cells_of(
        reference.faces,
        space.dof_handler,
        [&](const auto &cell, const auto &samples, const auto &points) {
          FEValues<dim> here(mapping,
                             space.dof_handler.get_fe(),
                             Quadrature<dim>(points),
                             update_values);
          here.reinit(cell);
          std::vector<Tensor<1, dim>> multiplier(points.size());
          here[displacement].get_function_values(density, multiplier);
          for (unsigned int q = 0; q < points.size(); ++q)
            {
              Tensor<1, dim> lambda;
              for (unsigned int d = 0; d < dim; ++d)
                lambda[d] = samples[q][FieldSamples<dim>::multiplier_index + d];
              error.multiplier +=
                (lambda - multiplier[q]).norm_square() * samples[q][dim];
              norm.multiplier += lambda.norm_square() * samples[q][dim];
            }
        });
    }



    template <std::size_t n>
    void
    append(const std::vector<std::array<double, n>> &rows,
           std::vector<double>                      &numbers)
    {
      for (const auto &row : rows)
        numbers.insert(numbers.end(), row.begin(), row.end());
    }



    template <std::size_t n>
    bool
    split(const std::vector<double>          &numbers,
          std::vector<std::array<double, n>> &rows)
    {
      for (std::size_t i = 0; i + n <= numbers.size(); i += n)
        {
          rows.emplace_back();
          std::copy_n(numbers.begin() + i, n, rows.back().begin());
        }
      return numbers.size() % n == 0;
    }



    /// What all ranks have, in the order of ranks, on rank 0.
    std::vector<double>
    gather(const std::vector<double> &numbers, const MPI_Comm communicator)
    {
      std::vector<double> result;
      for (const auto &part : Utilities::MPI::gather(communicator, numbers))
        result.insert(result.end(), part.begin(), part.end());
      return result;
    }



    /// Throws on all ranks if rank 0 has something to complain about.
    void
    agree(const std::string &complaint, const MPI_Comm communicator)
    {
      const std::string text =
        Utilities::MPI::broadcast(communicator, complaint);
      AssertThrow(text.empty(), ExcMessage(text));
    }
  } // namespace



  template <int dim>
  FieldSamples<dim>
  sample_fields(const StressSpace<dim>  &stress_space,
                const State<dim>        &state,
                const DistributedVector *multiplier_density)
  {
    using Samples           = FieldSamples<dim>;
    const auto &space       = stress_space.space;
    const auto &dof_handler = space.dof_handler;
    Samples     result;
    result.t = state.t;
    FEValues<dim>               fe_values(space.mapping,
                            dof_handler.get_fe(),
                            QMidpoint<dim>(),
                            update_values | update_gradients |
                              update_JxW_values | update_quadrature_points);
    MeanDilatation<dim>         mean_dilatation(space);
    FEFaceValues<dim>           face_values(space.mapping,
                                  dof_handler.get_fe(),
                                  QGauss<dim - 1>(2),
                                  update_values | update_JxW_values |
                                    update_quadrature_points);
    std::vector<Tensor<1, dim>> values(fe_values.n_quadrature_points);
    std::vector<Tensor<2, dim>> gradients(fe_values.n_quadrature_points);
    std::vector<Tensor<1, dim>> lambda(face_values.n_quadrature_points);
    const auto stress     = stress_space.mean_stress(state.u, state.z);
    const auto components = stress_components<dim>();

    std::size_t index = 0;
    for (const auto &cell : stress_space.space.cells)
      {
        fe_values.reinit(cell);
        fe_values[displacement].get_function_values(state.u, values);
        fe_values[displacement].get_function_gradients(state.u, gradients);
        const SymmetricTensor<2, 3> at_center =
          strain(values[0],
                 gradients[0],
                 fe_values.quadrature_point(0),
                 space.scene.plane_model(),
                 space.axial_strain(state.u.begin()));
        const double dilatation = stress_space.mean_dilatation ?
                                    mean_dilatation(cell, state.u) :
                                    trace(at_center);
        for (const unsigned int q : fe_values.quadrature_point_indices())
          {
            typename Samples::CellPoint sample;
            sample[dim]                       = fe_values.JxW(q);
            sample[Samples::dilatation_index] = dilatation;
            sample[Samples::zz_index]         = at_center[2][2];
            for (unsigned int d = 0; d < dim; ++d)
              {
                sample[d]                    = fe_values.quadrature_point(q)[d];
                sample[Samples::u_index + d] = values[q][d];
                for (unsigned int e = 0; e < dim; ++e)
                  sample[Samples::gradient_index + d * dim + e] =
                    gradients[q][d][e];
              }
            for (unsigned int c = 0; c < components.size(); ++c)
              sample[Samples::stress_index + c] =
                stress[index][components[c].first][components[c].second];
            result.cells.push_back(sample);
          }
        ++index;

        for (const unsigned int f : cell->face_indices())
          {
            if (multiplier_density == nullptr || !cell->face(f)->at_boundary())
              continue;
            if (!space.scene.boundary.at(cell->face(f)->boundary_id())
                   .has_friction())
              continue;
            face_values.reinit(cell, f);
            face_values[displacement].get_function_values(*multiplier_density,
                                                          lambda);
            for (const unsigned int q : face_values.quadrature_point_indices())
              {
                typename Samples::FacePoint sample;
                sample[dim] = face_values.JxW(q);
                for (unsigned int d = 0; d < dim; ++d)
                  {
                    sample[d] = face_values.quadrature_point(q)[d];
                    sample[Samples::multiplier_index + d] = lambda[q][d];
                  }
                result.faces.push_back(sample);
              }
          }
      }
    return result;
  }



  template <int dim>
  void
  write_samples(const FieldSamples<dim> &samples,
                const std::string       &file,
                const MPI_Comm           communicator)
  {
    std::vector<double> cells, faces;
    append(samples.cells, cells);
    append(samples.faces, faces);
    cells = gather(cells, communicator);
    faces = gather(faces, communicator);
    std::string complaint;
    if (Utilities::MPI::this_mpi_process(communicator) == 0)
      {
        BinaryWriter archive;
        archive &magic_number<dim> &samples.t &cells &faces;
        try
          {
            replace_file(file, archive.bytes());
          }
        catch (const std::exception &exception)
          {
            complaint = reason(exception);
          }
      }
    agree(complaint, communicator);
  }



  template <int dim>
  FieldSamples<dim>
  read_samples(const std::string &file, const MPI_Comm communicator)
  {
    FieldSamples<dim> result;
    std::string       complaint;
    if (Utilities::MPI::this_mpi_process(communicator) == 0)
      {
        bool is_good = false;
        try
          {
            if (const auto bytes = read_file_if_any(file))
              {
                BinaryReader        archive(*bytes);
                double              magic = 0.;
                std::vector<double> cells, faces;
                archive &magic &result.t &cells &faces;
                is_good = magic == magic_number<dim> && archive.is_at_end() &&
                          split(cells, result.cells) &&
                          split(faces, result.faces);
              }
          }
        catch (const std::exception &)
          {
            is_good = false; // said below
          }
        if (!is_good)
          complaint = "'" + file + "' holds no reference fields in " +
                      std::to_string(dim) +
                      " dimensions; they are written by a run with 'Output/"
                      "Reference fields' = true.";
      }
    agree(complaint, communicator);
    result.t = Utilities::MPI::broadcast(communicator, result.t);
    return result;
  }



  template <int dim>
  SolutionErrors
  differences(const FieldSamples<dim> &reference,
              const StressSpace<dim>  &stress_space,
              const State<dim>        &state,
              const DistributedVector *multiplier_density)
  {
    const MPI_Comm communicator = stress_space.space.communicator;
    SolutionNorms  error, norm; // squared
    add_cells(reference, stress_space, state, error, norm);
    if (multiplier_density)
      add_faces(
        reference, stress_space.space, *multiplier_density, error, norm);
    SolutionErrors result;
    result.error = square_roots(error, communicator);
    result.exact = square_roots(norm, communicator);
    return result;
  }



  std::string
  samples_file(const std::string &directory, const unsigned int phase)
  {
    return directory + "/reference_" + std::to_string(phase) + ".bin";
  }



  template struct FieldSamples<2>;
  template struct FieldSamples<3>;
  VISCOPLASTIC_INSTANTIATE(sample_fields);
  VISCOPLASTIC_INSTANTIATE(write_samples);
  VISCOPLASTIC_INSTANTIATE(read_samples);
  VISCOPLASTIC_INSTANTIATE(differences);
} // namespace Viscoplastic
