// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/fe/mapping_q.h>

#include <viscoplastic_contact/mesh/plane_model.h>

namespace Viscoplastic
{
  namespace
  {
    /// The bilinear mapping with weights for bodies of revolution.
    class RingMapping : public MappingQ<2>
    {
    public:
      RingMapping()
        : MappingQ<2>(1)
      {}

      std::unique_ptr<Mapping<2>>
      clone() const override
      {
        return std::make_unique<RingMapping>();
      }

      UpdateFlags
      requires_update_flags(const UpdateFlags flags) const override
      {
        return MappingQ<2>::requires_update_flags(
          flags & update_JxW_values ? flags | update_quadrature_points : flags);
      }

    protected:
      using Cell = Triangulation<2>::cell_iterator;
      using Values =
        dealii::internal::FEValuesImplementation::MappingRelatedData<2>;

      CellSimilarity::Similarity
      fill_fe_values(const Cell &cell,
                     const CellSimilarity::Similarity /*similarity*/,
                     const Quadrature<2>    &quadrature,
                     const InternalDataBase &data,
                     Values                 &values) const override
      {
        // Translated cells have different radii, hence no similarity.
        MappingQ<2>::fill_fe_values(
          cell, CellSimilarity::none, quadrature, data, values);
        revolve(values);
        return CellSimilarity::none;
      }

      void
      fill_fe_face_values(const Cell               &cell,
                          const unsigned int        face,
                          const hp::QCollection<1> &quadrature,
                          const InternalDataBase   &data,
                          Values                   &values) const override
      {
        MappingQ<2>::fill_fe_face_values(cell, face, quadrature, data, values);
        revolve(values);
      }

      void
      fill_fe_subface_values(const Cell             &cell,
                             const unsigned int      face,
                             const unsigned int      subface,
                             const Quadrature<1>    &quadrature,
                             const InternalDataBase &data,
                             Values                 &values) const override
      {
        MappingQ<2>::fill_fe_subface_values(
          cell, face, subface, quadrature, data, values);
        revolve(values);
      }

    private:
      static void
      revolve(Values &values)
      {
        for (unsigned int q = 0; q < values.JxW_values.size(); ++q)
          values.JxW_values[q] *=
            extent(PlaneModel::axisymmetric, values.quadrature_points[q]);
      }
    };
  } // namespace



  template <>
  const Mapping<2> &
  mapping_of(const PlaneModel model)
  {
    static const MappingQ<2> of_section(1);
    static const RingMapping of_ring;
    if (model == PlaneModel::axisymmetric)
      return of_ring;
    return of_section;
  }



  template <>
  const Mapping<3> &
  mapping_of(const PlaneModel)
  {
    static const MappingQ<3> result(1);
    return result;
  }
} // namespace Viscoplastic
