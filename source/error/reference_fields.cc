// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi_remote_point_evaluation.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/mapping_q1.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/error/reference_fields.h>

#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/serialization/vector.hpp>

#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    const FEValuesExtractors::Vector displacement(0);

    /// Points of a face are moved by this part of the way to the center of
    /// their cell, to be found in a cell of their body.
    constexpr double inset = 1e-3;

    /// The first number of a file of samples: its version and dimension.
    template <int dim>
    constexpr double magic_number = 7.28e9 + dim;



    /// Send each sample to the rank that owns the cell around its @p place, and
    /// call visit(cell, samples in it, their places on the unit cell).
    /// Collective.
    template <int dim, typename Sample, typename Visitor>
    void
    visit_cells_of(const std::vector<Sample> &samples,
                   Point<dim> Sample::*const place,
                   const DoFHandler<dim>    &dof_handler,
                   const Visitor            &visit)
    {
      std::vector<Point<dim>> points;
      for (const Sample &sample : samples)
        points.push_back(sample.*place);
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
        &FieldSamples<dim>::CellPoint::x,
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
              const auto  &sample = samples[q];
              const double w      = sample.weight;
              auto         exact  = strain(sample.gradient, sample.strain_zz),
                   ours           = strain(values[q],
                                 gradients[q],
                                 sample.x,
                                 space.scene.plane_model(),
                                 space.axial_strain(state.u.begin()));
              if (stress_space.mean_dilatation)
                {
                  exact = with_dilatation(exact, sample.dilatation);
                  ours  = with_dilatation(ours, dilatation);
                }
              const auto defect = exact - ours;
              error.energy += w * (stiffness.stress(defect) * defect);
              norm.energy += w * (stiffness.stress(exact) * exact);
              error.h1 += w * ((sample.u - values[q]).norm_square() +
                               (sample.gradient - gradients[q]).norm_square());
              norm.h1 +=
                w * (sample.u.norm_square() + sample.gradient.norm_square());
              const auto difference = sample.stress - stress[i];
              error.stress += w * (difference * difference);
              norm.stress += w * (sample.stress * sample.stress);
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
      visit_cells_of(reference.faces,
                     &FieldSamples<dim>::FacePoint::inside,
                     space.dof_handler,
                     [&](const auto &cell, const auto &samples, auto points) {
                       for (unsigned int q = 0; q < points.size(); ++q)
                         points[q] = GeometryInfo<dim>::project_to_unit_cell(
                           mapping.transform_real_to_unit_cell(cell,
                                                               samples[q].x));
                       FEValues<dim> here(mapping,
                                          space.dof_handler.get_fe(),
                                          Quadrature<dim>(points),
                                          update_values);
                       here.reinit(cell);
                       std::vector<Tensor<1, dim>> multiplier(points.size());
                       here[displacement].get_function_values(density,
                                                              multiplier);
                       for (unsigned int q = 0; q < points.size(); ++q)
                         {
                           const auto &[x, inside, weight, lambda] = samples[q];
                           error.multiplier +=
                             (lambda - multiplier[q]).norm_square() * weight;
                           norm.multiplier += lambda.norm_square() * weight;
                         }
                     });
    }



    /// Return the samples of all ranks, in the order of ranks, on rank 0.
    template <typename Sample>
    std::vector<Sample>
    gather(const std::vector<Sample> &samples, const MPI_Comm communicator)
    {
      std::vector<Sample> result;
      for (const auto &part : Utilities::MPI::gather(communicator, samples))
        result.insert(result.end(), part.begin(), part.end());
      return result;
    }



    /// Throw on all ranks if rank 0 has a complaint. Collective.
    void
    agree(const std::string &complaint, const MPI_Comm communicator)
    {
      const std::string text =
        Utilities::MPI::broadcast(communicator, complaint);
      if (!text.empty())
        refuse(text);
    }
  } // namespace



  template <int dim>
  FieldSamples<dim>
  sample_fields(const StressSpace<dim>  &stress_space,
                const State<dim>        &state,
                const DistributedVector *multiplier_density)
  {
    const auto       &space       = stress_space.space;
    const auto       &dof_handler = space.dof_handler;
    FieldSamples<dim> result;
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
    const auto stress = stress_space.mean_stress(state.u, state.z);

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
        result.cells.push_back({fe_values.quadrature_point(0),
                                fe_values.JxW(0),
                                values[0],
                                gradients[0],
                                dilatation,
                                at_center[2][2],
                                stress[index]});
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
              result.faces.push_back(
                {face_values.quadrature_point(q),
                 face_values.quadrature_point(q) +
                   inset * (cell->center() - face_values.quadrature_point(q)),
                 face_values.JxW(q),
                 lambda[q]});
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
    const auto  cells = gather(samples.cells, communicator);
    const auto  faces = gather(samples.faces, communicator);
    std::string complaint;
    if (Utilities::MPI::this_mpi_process(communicator) == 0)
      {
        std::ostringstream              bytes;
        boost::archive::binary_oarchive archive(bytes);
        archive &magic_number<dim> &samples.t &cells &faces;
        try
          {
            replace_file(file, bytes.str());
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
        bool is_good = false, is_there = false;
        try
          {
            if (const auto bytes = read_file_if_any(file))
              {
                is_there = true;
                std::istringstream              stream(*bytes);
                boost::archive::binary_iarchive archive(stream);
                double                          magic = 0.;
                archive                        &magic;
                is_good = magic == magic_number<dim>;
                if (is_good)
                  archive &result.t &result.cells &result.faces;
              }
          }
        catch (const std::exception &)
          {
            is_good = false; // reported below
          }
        if (!is_good)
          complaint = "'" + file + "' " +
                      (is_there ? "holds no reference fields in " +
                                    std::to_string(dim) + " dimensions" :
                                  "does not exist") +
                      "; reference fields are written at the end of each phase "
                      "by a run with 'Output/Reference fields' = true.";
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



  VISCOPLASTIC_INSTANTIATE_CLASS(FieldSamples);
  VISCOPLASTIC_INSTANTIATE(sample_fields);
  VISCOPLASTIC_INSTANTIATE(write_samples);
  VISCOPLASTIC_INSTANTIATE(read_samples);
  VISCOPLASTIC_INSTANTIATE(differences);
} // namespace Viscoplastic
