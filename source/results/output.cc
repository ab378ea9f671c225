// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/numerics/data_out.h>

#include <viscoplastic_contact/base/files.h>
#include <viscoplastic_contact/base/json_text.h>
#include <viscoplastic_contact/base/messages.h>
#include <viscoplastic_contact/base/number_range.h>
#include <viscoplastic_contact/base/spelling.h>
#include <viscoplastic_contact/base/table.h>
#include <viscoplastic_contact/base/version.h>
#include <viscoplastic_contact/error/recovery_estimate.h>
#include <viscoplastic_contact/error/solution_errors.h>
#include <viscoplastic_contact/results/body_fields.h>
#include <viscoplastic_contact/results/output.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <limits>
#include <regex>
#include <sstream>

namespace Viscoplastic
{
  namespace
  {
    /**
     * VTU files have single precision. What is beyond its range, and would be
     * infinite there, becomes its largest number: ParaView cannot scale colors
     * to infinite values. Returns the data sets where this was needed, by
     * their indices, and the number of data sets for the coordinates.
     */
    template <int dim, int spacedim>
    std::set<unsigned int>
    cut_off_infinite(std::vector<DataOutBase::Patch<dim, spacedim>> &patches,
                     const unsigned int n_data_sets)
    {
      constexpr float        largest = std::numeric_limits<float>::max();
      std::set<unsigned int> result;
      for (auto &patch : patches)
        {
          for (unsigned int i = 0; i < n_data_sets; ++i)
            for (unsigned int j = 0; j < patch.data.n_cols(); ++j)
              if (float &value = patch.data(i, j); std::isinf(value))
                {
                  value = std::copysign(largest, value);
                  result.insert(i);
                }
          for (Point<spacedim> &x : patch.vertices)
            for (unsigned int d = 0; d < spacedim; ++d)
              if (std::abs(x[d]) > largest)
                {
                  x[d] = std::copysign(largest, x[d]);
                  result.insert(n_data_sets);
                }
        }
      return result;
    }



    /// The body with its fields.
    template <int dim>
    class BodyOutput : public DataOut<dim>
    {
    public:
      /// Bring the patches, one for each owned cell in the order of active
      /// cells, into that of @p cells, which a restart does not change.
      template <class Cell>
      void
      sort_by(const std::vector<Cell> &cells)
      {
        AssertDimension(this->patches.size(), cells.size());
        std::vector<std::pair<unsigned int, std::size_t>> order;
        for (std::size_t c = 0; c < cells.size(); ++c)
          order.emplace_back(cells[c]->active_cell_index(), c);
        std::sort(order.begin(), order.end());
        auto sorted = this->patches;
        for (std::size_t p = 0; p < order.size(); ++p)
          {
            auto &patch       = sorted[order[p].second];
            patch             = std::move(this->patches[p]);
            patch.patch_index = order[p].second;
            // Their numbers are no longer right, and nothing here asks for
            // them.
            std::fill(std::begin(patch.neighbors),
                      std::end(patch.neighbors),
                      numbers::invalid_unsigned_int);
          }
        this->patches = std::move(sorted);
      }

      std::set<unsigned int>
      cut_off()
      {
        return cut_off_infinite(this->patches, names().size());
      }

      std::vector<std::string>
      names() const
      {
        return this->get_dataset_names();
      }
    };



    /// Faces of Gamma_3 with nodal data, in the form that DataOut writes.
    template <int dim>
    class FaceOutput : public DataOutInterface<dim - 1, dim>
    {
    public:
      std::vector<DataOutBase::Patch<dim - 1, dim>> patches;
      std::vector<std::string>                      names;
      std::vector<
        std::tuple<unsigned int,
                   unsigned int,
                   std::string,
                   DataComponentInterpretation::DataComponentInterpretation>>
        vectors;

    protected:
      const std::vector<DataOutBase::Patch<dim - 1, dim>> &
      get_patches() const override
      {
        return patches;
      }

      std::vector<std::string>
      get_dataset_names() const override
      {
        return names;
      }

      std::vector<
        std::tuple<unsigned int,
                   unsigned int,
                   std::string,
                   DataComponentInterpretation::DataComponentInterpretation>>
      get_nonscalar_data_ranges() const override
      {
        return vectors;
      }
    };



    /// Stronger compression takes ten times as long and saves a tenth.
    DataOutBase::VtkFlags
    vtk_flags()
    {
      DataOutBase::VtkFlags flags;
      flags.compression_level = DataOutBase::VtkFlags::best_speed;
      return flags;
    }



    /// Refuse to overwrite what somebody else keeps under our names.
    void
    refuse_foreign_files(const std::string &path)
    {
      for (const auto &[name, beginning] :
           std::vector<std::pair<std::string, std::string>>{
             {"parameters.prm", "# Listing of Parameters\n"},
             {"run.json", "{\n  \"program\": \"viscoplastic_contact\""},
             {"statistics.csv", "step,t,k,"}})
        {
          std::error_code none;
          if (!std::filesystem::is_regular_file(path + name, none))
            continue;
          std::ifstream file(path + name, std::ios::binary);
          std::string   text(beginning.size(), ' ');
          file.read(text.data(), static_cast<std::streamsize>(text.size()));
          text.resize(file.gcount());
          // It may be cut short.
          AssertThrow(file.is_open() &&
                        beginning.compare(0, text.size(), text) == 0,
                      ExcMessage("The results would overwrite '" + path + name +
                                 "', which this program has not written; "
                                 "choose another 'Output/Directory'."));
        }
    }



    nlohmann::ordered_json
    record_of_errors(const ErrorSummary &errors,
                     const std::string  &name_of_size)
    {
      return {{"t", errors.t},
              {"space", errors.largest.space},
              {"time", errors.largest.time},
              {"friction", errors.largest.friction},
              {"transfer", errors.largest.transfer},
              {"algebraic", errors.largest.algebraic},
              {"initial", errors.largest.initial},
              {"total", errors.largest.total()},
              {name_of_size, errors.size},
              {"relative", errors.relative()}};
    }



    template <int dim>
    void
    write_record(const Scene<dim>      &scene,
                 const std::string     &path,
                 const unsigned int     n_ranks,
                 const RunSummary<dim> *summary = nullptr)
    {
      std::ostringstream parameters;
      scene.parameters.handler.print_parameters(parameters,
                                                ParameterHandler::Text);
      replace_file(path + "parameters.prm", parameters.str());

      const std::time_t now = std::time(nullptr);
      char              date[32];
      std::strftime(date, sizeof(date), "%FT%TZ", std::gmtime(&now));
      nlohmann::ordered_json record{{"program", "viscoplastic_contact"},
                                    {"version", VISCOPLASTIC_CONTACT_VERSION},
                                    {"git_revision",
                                     VISCOPLASTIC_CONTACT_GIT_REVISION},
                                    {"dealii_version", DEAL_II_PACKAGE_VERSION},
                                    {"n_mpi_ranks", n_ranks},
                                    {"dimension", dim},
                                    {"effects", scene.effects()}};
      const auto            &libraries = scene.parameters.shared_libraries;
      if (!libraries.empty())
        record["shared_libraries"] = libraries;
      for (const auto &table : tables_in_use())
        record["tables"].push_back({{"section", table->section},
                                    {"file", table->file},
                                    {"crc32", table->checksum}});
      if (summary != nullptr && summary->errors)
        record["estimated_error"] =
          record_of_errors(*summary->errors, "largest_energy_norm");
      if (summary != nullptr && !summary->quantity.empty())
        {
          auto &errors = record["estimated_error_of_quantity"] =
            record_of_errors(summary->quantity_errors, "largest_value");
          errors["quantity"] = summary->quantity;
        }
      record["date"] = date;
      replace_file(path + "run.json", json_text(record));
    }



    /// The name of an output without its ending.
    std::string
    record_name(const std::string &series, const unsigned int n)
    {
      return series + '_' + Utilities::int_to_string(n, 5);
    }
  } // namespace



  std::string
  results_directory(const Parameters &parameters)
  {
    std::string path = parameters.output.directory;
    if (path.empty())
      path = "output/" + std::filesystem::path(parameters.file).stem().string();
    return path.back() == '/' ? path : path + '/';
  }



  void
  make_results_directory(const std::string &path)
  {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    AssertThrow(!error,
                ExcMessage("The results directory '" + path +
                           "' cannot be written; change 'Output/Directory' or "
                           "its permissions."));
  }



  template <int dim>
  Output<dim>::Output(const Scene<dim> &scene, const MPI_Comm communicator)
    : scene(scene)
    , communicator(communicator)
    , path(results_directory(scene.parameters))
  {
    fail_together(communicator, [&]() {
      if (Utilities::MPI::this_mpi_process(communicator) != 0)
        return;
      make_results_directory(path);
      refuse_foreign_files(path);
      write_record(scene, path, Utilities::MPI::n_mpi_processes(communicator));
    });
  }



  template <int dim>
  void
  Output<dim>::record_errors(const RunSummary<dim> &summary) const
  {
    fail_together(communicator, [&]() {
      if (Utilities::MPI::this_mpi_process(communicator) == 0)
        write_record(scene,
                     path,
                     Utilities::MPI::n_mpi_processes(communicator),
                     &summary);
    });
  }



  template <int dim>
  void
  Output<dim>::resume(const std::vector<double> &earlier)
  {
    times = earlier;
    std::vector<std::string> names{"solution"};
    if (scene.has_contact())
      names.emplace_back("contact");
    for (const std::string &name : names)
      {
        write_pvd(name);
        remove_later(name);
      }
  }



  template <int dim>
  void
  Output<dim>::remove_later(const std::string &name) const
  {
    if (Utilities::MPI::this_mpi_process(communicator) != 0)
      return;
    namespace fs = std::filesystem;
    const std::regex      piece(name +
                           "_([0-9]{5,9})[.](pvtu|[0-9]+[.]vtu)([.]part)?");
    std::vector<fs::path> later;
    std::error_code       error;
    for (const auto &entry : fs::directory_iterator(path, error))
      {
        const std::string file = entry.path().filename().string();
        std::smatch       parts;
        if (std::regex_match(file, parts, piece) &&
            std::stoul(parts[1]) >= times.size())
          later.push_back(entry.path());
      }
    for (const fs::path &file : later)
      fs::remove(file, error);
  }



  template <int dim>
  bool
  Output<dim>::is_due(const TimeStep &step) const
  {
    if (step.t >= scene.schedule.end_time())
      return true;
    const OutputParameters &parameters = scene.parameters.output;
    if (parameters.fields_interval > 0.)
      {
        // Has a multiple of the interval been passed? Times carry rounding.
        const double slack = 1e-9 * scene.schedule.end_time();
        return std::floor((step.t + slack) / parameters.fields_interval) >
               std::floor((step.t_old + slack) / parameters.fields_interval);
      }
    return parameters.fields_every > 0 && step.n % parameters.fields_every == 0;
  }



  template <int dim>
  std::vector<std::string>
  Output<dim>::write_fields(const FlowLaws<dim>    &laws,
                            const State<dim>       &state,
                            const ContactFace<dim> *face,
                            const Vector<double>   *squared_estimate)
  {
    times.push_back(state.t);
    std::vector<std::string> remarks{write_body(laws, state, squared_estimate)};
    write_pvd("solution");
    if (scene.has_contact())
      {
        remarks.push_back(write_contact(laws.stress_space, state, face));
        write_pvd("contact");
      }
    remarks.erase(std::remove(remarks.begin(), remarks.end(), ""),
                  remarks.end());
    return remarks;
  }



  template <int dim>
  void
  Output<dim>::write_pvd(const std::string &name) const
  {
    std::vector<std::pair<double, std::string>> records;
    for (unsigned int i = 0; i < times.size(); ++i)
      records.emplace_back(times[i], record_name(name, i) + ".pvtu");
    std::ostringstream text;
    text << std::setprecision(15);
    DataOutBase::write_pvd_record(text, records);
    fail_together(communicator, [&]() {
      if (Utilities::MPI::this_mpi_process(communicator) == 0)
        replace_file(path + name + ".pvd", text.str());
    });
  }



  template <int dim>
  template <typename Data>
  std::string
  Output<dim>::write_vtu(const std::string              &name,
                         const Data                     &data,
                         const std::set<unsigned int>   &cut_off,
                         const std::vector<std::string> &data_sets)
  {
    // What DataOutInterface::write_vtu_with_pvtu_record() writes; its errors
    // would name no file.
    const unsigned int n_ranks = Utilities::MPI::n_mpi_processes(communicator);
    const unsigned int rank    = Utilities::MPI::this_mpi_process(communicator);
    const std::string  record  = record_name(name, times.size() - 1);
    std::vector<std::string> pieces;
    for (unsigned int r = 0; r < n_ranks; ++r)
      pieces.push_back(
        record + '.' +
        Utilities::int_to_string(r, Utilities::needed_digits(n_ranks - 1)) +
        ".vtu");
    fail_together(communicator, [&]() {
      std::ostringstream text;
      data.write_vtu(text);
      replace_file(path + pieces[rank], text.str());
      if (rank != 0)
        return;
      std::ostringstream list;
      data.write_pvtu_record(list, pieces);
      replace_file(path + record + ".pvtu", list.str());
    });

    // Vectors have a data set for each component.
    std::vector<int> is_cut(data_sets.size() + 1, 0);
    for (const unsigned int i : cut_off)
      is_cut[i] = 1;
    Utilities::MPI::max(is_cut, communicator, is_cut);
    std::vector<std::string> fields;
    for (unsigned int i = 0; i < is_cut.size(); ++i)
      if (const std::string field =
            i < data_sets.size() ? "'" + data_sets[i] + "'" : "the coordinates";
          is_cut[i] == 1 && cut_fields.insert(name + field).second)
        fields.push_back(field);
    if (fields.empty())
      return "";
    std::ostringstream remark;
    remark << "Warning: '" << path << record << ".pvtu' has "
           << std::setprecision(2) << std::numeric_limits<float>::max()
           << ", the largest number of single precision, where the values of "
           << enumeration(fields)
           << " are larger; choose other units to see them.";
    return remark.str();
  }



  template <int dim>
  std::string
  Output<dim>::write_body(const FlowLaws<dim>  &laws,
                          const State<dim>     &state,
                          const Vector<double> *squared_estimate)
  {
    const StressSpace<dim> &stress_space = laws.stress_space;
    const DoFHandler<dim>  &dof_handler  = stress_space.space.dof_handler;
    const auto             &tria         = dof_handler.get_triangulation();
    BodyOutput<dim>         data_out;
    data_out.attach_dof_handler(dof_handler);
    const std::vector<DataComponentInterpretation::DataComponentInterpretation>
      is_vector(dim, DataComponentInterpretation::component_is_part_of_vector);
    data_out.add_data_vector(state.u,
                             std::vector<std::string>(dim, "displacement"),
                             DataOut<dim>::type_dof_data,
                             is_vector);
    data_out.add_data_vector(state.velocity,
                             std::vector<std::string>(dim, "velocity"),
                             DataOut<dim>::type_dof_data,
                             is_vector);

    // The same fields on all ranks, also on those without cells.
    const bool         has_z      = scene.has_irreversible_stress();
    constexpr auto     components = stress_components<dim>();
    const unsigned int n          = components.size();
    const std::vector<SymmetricTensor<2, 3>> stress =
      stress_space.mean_stress(state.u, state.z);
    std::vector<Vector<double>> stresses(n,
                                         Vector<double>(tria.n_active_cells()));
    std::vector<Vector<double>> irreversible(
      has_z ? n : 0, Vector<double>(tria.n_active_cells()));
    Vector<double> mises(tria.n_active_cells());
    Vector<double> subdomain(tria.n_active_cells());
    std::size_t    owned_cell = 0;
    for (const auto &cell : stress_space.space.cells)
      {
        const unsigned int i = cell->active_cell_index();
        subdomain[i]         = cell->subdomain_id();
        mises[i]             = von_mises(stress[owned_cell]);
        for (unsigned int c = 0; c < n; ++c)
          stresses[c][i] =
            stress[owned_cell][components[c].first][components[c].second];
        if (has_z)
          {
            const auto z =
              stress_space.mean(owned_cell,
                                &state.z[owned_cell * stress_space.n_samples]);
            for (unsigned int c = 0; c < n; ++c)
              irreversible[c][i] = z[components[c].first][components[c].second];
          }
        ++owned_cell;
      }
    const std::string xyz = "xyz";
    for (unsigned int c = 0; c < n; ++c)
      {
        const std::string suffix = std::string("_") + xyz[components[c].first] +
                                   xyz[components[c].second];
        data_out.add_data_vector(stresses[c], "stress" + suffix);
        if (has_z)
          data_out.add_data_vector(irreversible[c],
                                   "irreversible_stress" + suffix);
      }
    data_out.add_data_vector(mises, "von_mises");
    data_out.add_data_vector(subdomain, "subdomain");
    const std::vector<CellField> additional = additional_fields(laws, state);
    for (const CellField &field : additional)
      data_out.add_data_vector(field.values, field.name);
    const auto square_roots = [](Vector<double> squares) {
      for (double &value : squares)
        value = std::sqrt(value);
      return squares;
    };
    Vector<double> estimator, error, recovery;
    if (squared_estimate != nullptr)
      {
        estimator = square_roots(*squared_estimate);
        data_out.add_data_vector(estimator, "estimator");
      }
    if (stress_space.space.scene.exact_solution)
      {
        error = square_roots(
          solution_errors(stress_space, state, nullptr).squared_energy_by_cell);
        recovery = square_roots(squared_recovery_estimate(stress_space, state));
        data_out.add_data_vector(error, "error_energy");
        data_out.add_data_vector(recovery, "recovery");
      }
    data_out.set_flags(vtk_flags());
    data_out.build_patches();
    data_out.sort_by(stress_space.space.cells);
    const std::set<unsigned int> cut = data_out.cut_off();
    return write_vtu("solution", data_out, cut, data_out.names());
  }



  template <int dim>
  std::string
  Output<dim>::write_contact(const StressSpace<dim> &stress_space,
                             const State<dim>       &state,
                             const ContactFace<dim> *face)
  {
    const AdmissibleSpace<dim> &space = stress_space.space;
    const bool                  has_normal_traction =
      scene.parameters.output.has(AdditionalField::normal_traction);
    const bool has_friction_work =
      face != nullptr &&
      scene.parameters.output.has(AdditionalField::friction_work);
    // In the order of the cells.
    const std::vector<SymmetricTensor<2, 3>> stress =
      has_normal_traction ? stress_space.mean_stress(state.u, state.z) :
                            std::vector<SymmetricTensor<2, 3>>();
    FaceOutput<dim> output;
    output.set_flags(vtk_flags());
    const auto add_vector = [&output](const std::string &name) {
      output.vectors.emplace_back(
        output.names.size(),
        output.names.size() + dim - 1,
        name,
        DataComponentInterpretation::component_is_part_of_vector);
      output.names.insert(output.names.end(), dim, name);
    };
    add_vector("displacement");
    add_vector("slip");
    add_vector("slip_rate");

    // Tractions and sets live at the nodes of friction points.
    // Where a frictional piece has none, other conditions prescribe the node.
    DistributedVector density, bound, utilization, slipping;
    if (face != nullptr)
      {
        add_vector("traction");
        for (const char *name : {"bound", "utilisation", "stick"})
          output.names.push_back(name);
        if (has_friction_work)
          output.names.emplace_back("friction_work");
        const std::vector<double> &bounds = state.friction.bound;
        std::vector<double>        values(bounds.size());
        for (unsigned int p = 0; p < values.size(); ++p)
          values[p] = bounds[p] / face->weights()[p];
        bound = face->nodal_field(values);
        for (unsigned int p = 0; p < values.size(); ++p)
          values[p] = bounds[p] > 0. ?
                        stable_norm(state.friction.multiplier[p]) / bounds[p] :
                        0.;
        utilization = face->nodal_field(values);
        for (unsigned int p = 0; p < values.size(); ++p)
          values[p] = state.friction.sticks[p] ? 0. : 1.;
        slipping = face->nodal_field(values);
        density  = face->density(state.friction);
      }

    if (has_normal_traction)
      output.names.emplace_back("normal_traction");

    for (std::size_t c = 0; c < space.cells.size(); ++c)
      for (const unsigned int f : space.cells[c]->face_indices())
        {
          const auto cell_face = space.cells[c]->face(f);
          if (!cell_face->at_boundary())
            continue;
          const auto &condition =
            space.scene.boundary.at(cell_face->boundary_id());
          if (condition.role != BoundaryRole::contact)
            continue;
          DataOutBase::Patch<dim - 1, dim> patch;
          patch.patch_index    = output.patches.size();
          patch.reference_cell = ReferenceCells::get_hypercube<dim - 1>();
          patch.data.reinit(output.names.size(), cell_face->n_vertices());
          for (const unsigned int v : cell_face->vertex_indices())
            {
              patch.vertices[v] = cell_face->vertex(v);
              const auto node   = space.relevant.index_within_set(
                cell_face->vertex_dof_index(v, 0));
              unsigned int row    = 0;
              const auto   vector = [&](const DistributedVector &field) {
                Tensor<1, dim> value;
                for (unsigned int d = 0; d < dim; ++d)
                  value[d] = field.begin()[node + d];
                return value;
              };
              const auto store = [&](const Tensor<1, dim> &value) {
                for (unsigned int d = 0; d < dim; ++d)
                  patch.data(row++, v) = value[d];
              };
              const auto tangential = [&](const Tensor<1, dim> &value) {
                return value - (value * condition.normal) * condition.normal;
              };
              const Tensor<1, dim> u = vector(state.u);
              const Tensor<1, dim> w =
                condition.sliding(patch.vertices[v], state.t);
              store(u);
              store(tangential(state.initial_u.size() > 0 ?
                                 u - vector(state.initial_u) :
                                 u) -
                    w);
              Tensor<1, dim> rate = tangential(vector(state.velocity));
              if (state.k > 0. && condition.foundation_motion)
                rate -= (w - condition.sliding(patch.vertices[v],
                                               state.t - state.k)) /
                        state.k;
              store(rate);
              if (face != nullptr)
                {
                  // On the body: minus the multiplier.
                  store(condition.has_friction() ?
                          -1. * tangential(vector(density)) :
                          Tensor<1, dim>());
                  const bool frictional = condition.has_friction();
                  patch.data(row++, v)  = frictional ? bound.begin()[node] : 0.;
                  patch.data(row++, v) =
                    frictional ? utilization.begin()[node] : 0.;
                  patch.data(row++, v) =
                    frictional ? 1. - slipping.begin()[node] : 0.;
                  if (has_friction_work)
                    patch.data(row++, v) =
                      frictional && state.friction_work.size() > 0 ?
                        state.friction_work.begin()[node] :
                        0.;
                }
              if (has_normal_traction)
                {
                  double normal_traction = 0.;
                  for (unsigned int i = 0; i < dim; ++i)
                    for (unsigned int j = 0; j < dim; ++j)
                      normal_traction += condition.normal[i] * stress[c][i][j] *
                                         condition.normal[j];
                  patch.data(row++, v) = normal_traction;
                }
            }
          output.patches.push_back(patch);
        }
    const std::set<unsigned int> cut =
      cut_off_infinite(output.patches, output.names.size());
    return write_vtu("contact", output, cut, output.names);
  }



  template class Output<2>;
  template class Output<3>;
} // namespace Viscoplastic
