// SPDX-License-Identifier: LGPL-2.1-or-later
#include <viscoplastic_contact/mesh/files/mesh_reader.h>

#include <cstdlib>

namespace Viscoplastic
{
  namespace
  {
    // The element types of Gmsh's reference manual that its meshers make.
    const std::map<std::string, MeshReader::Shape> gmsh_shapes{
      {"15", {"point", 0, 1}},
      {"1", {"line", 1, 2}},
      {"2", {"triangle", 2, 3}},
      {"3", {"quadrilateral", 2, 4}},
      {"4", {"tetrahedron", 3, 4}},
      {"5", {"hexahedron", 3, 8}},
      {"6", {"prism", 3, 6}},
      {"7", {"pyramid", 3, 5}},
      {"8", {"line", 1, 3, 2}},
      {"9", {"triangle", 2, 6, 2}},
      {"10", {"quadrilateral", 2, 9, 2}},
      {"11", {"tetrahedron", 3, 10, 2}},
      {"12", {"hexahedron", 3, 27, 2}},
      {"16", {"quadrilateral", 2, 8, 2}},
      {"17", {"hexahedron", 3, 20, 2}},
      {"21", {"triangle", 2, 10, 3}},
      {"26", {"line", 1, 4, 3}},
      {"29", {"tetrahedron", 3, 20, 3}},
      {"36", {"quadrilateral", 2, 16, 3}},
      {"92", {"hexahedron", 3, 64, 3}}};



    /// The physical groups of an entity, by its dimension and number.
    using PhysicalGroups = std::map<std::pair<long, long>, std::vector<long>>;



    PhysicalGroups
    read_msh_entities(MeshReader &reader, const bool version_40)
    {
      PhysicalGroups               result;
      std::array<unsigned long, 4> n_entities;
      for (auto &n : n_entities)
        n = reader.count("the number of entities");
      for (unsigned int dimension = 0; dimension < 4; ++dimension)
        for (unsigned long e = 0; e < n_entities[dimension]; ++e)
          {
            const long number   = reader.integer("the number of an entity");
            const bool is_point = dimension == 0 && !version_40;
            for (unsigned int i = 0; i < (is_point ? 3 : 6); ++i)
              reader.number("a bound of an entity");
            const unsigned long n = reader.count("the number of groups");
            for (unsigned long i = 0; i < n; ++i)
              // the sign is the orientation of the entity in the group
              result[{dimension, number}].push_back(
                std::abs(reader.integer("a physical group")));
            if (dimension > 0)
              {
                const unsigned long n_bounding =
                  reader.count("the number of bounding entities");
                for (unsigned long i = 0; i < n_bounding; ++i)
                  reader.integer("a bounding entity");
              }
          }
      return result;
    }



    void
    read_msh_nodes(MeshReader &reader, const double version)
    {
      if (version < 4.)
        {
          const unsigned long n = reader.count("the number of nodes");
          for (unsigned long i = 0; i < n; ++i)
            {
              const long number = reader.integer("the number of a node");
              reader.add_node(number, reader.coordinates());
            }
          return;
        }
      const bool          version_40 = version < 4.05;
      const unsigned long n_blocks   = reader.count("the number of blocks");
      reader.count("the number of nodes");
      if (!version_40)
        for (const char *what : {"the least number", "the greatest number"})
          reader.integer(what);
      for (unsigned long block = 0; block < n_blocks; ++block)
        {
          std::array<long, 2> entity{
            {reader.integer("an entity"), reader.integer("an entity")}};
          const long dimension = version_40 ? entity[1] : entity[0];
          if (dimension < 0 || dimension > 3)
            reader.fail("an entity of dimension " + std::to_string(dimension));
          const bool parametric = reader.integer("parametric or not") != 0;
          const unsigned long n = reader.count("the number of nodes");
          std::vector<long>   numbers(n);
          if (!version_40)
            for (long &number : numbers)
              number = reader.integer("the number of a node");
          for (long &number : numbers)
            {
              if (version_40)
                number = reader.integer("the number of a node");
              reader.add_node(number, reader.coordinates());
              if (parametric)
                for (long d = 0; d < dimension; ++d)
                  reader.number("a parametric coordinate");
            }
        }
    }



    void
    read_msh_elements(MeshReader           &reader,
                      const double          version,
                      const PhysicalGroups &groups)
    {
      if (version < 4.)
        {
          const unsigned long n = reader.count("the number of elements");
          for (unsigned long i = 0; i < n; ++i)
            {
              reader.integer("the number of an element");
              const MeshReader::Shape &type = reader.shape(gmsh_shapes);
              long                     id   = 0;
              const unsigned long n_tags = reader.count("the number of tags");
              for (unsigned long tag = 0; tag < n_tags; ++tag)
                {
                  const long value = reader.integer("a tag");
                  if (tag == 0)
                    id = std::abs(value);
                }
              reader.add_element(type, id, reader.node_numbers(type.n_nodes));
            }
          return;
        }
      const bool          version_40 = version < 4.05;
      const unsigned long n_blocks   = reader.count("the number of blocks");
      reader.count("the number of elements");
      if (!version_40)
        for (const char *what : {"the least number", "the greatest number"})
          reader.integer(what);
      for (unsigned long block = 0; block < n_blocks; ++block)
        {
          std::pair<long, long> entity;
          entity.first  = reader.integer("an entity");
          entity.second = reader.integer("an entity");
          if (version_40)
            std::swap(entity.first, entity.second);
          const MeshReader::Shape &type  = reader.shape(gmsh_shapes);
          const auto               group = groups.find(entity);
          if (group != groups.end() && group->second.size() > 1 &&
              type.dimension + 1 >= reader.dim)
            reader.fail("this " + type.name + " is in " +
                        std::to_string(group->second.size()) +
                        " physical groups; it can have one id only");
          const long          id = group == groups.end() ? 0 : group->second[0];
          const unsigned long n  = reader.count("the number of elements");
          for (unsigned long i = 0; i < n; ++i)
            {
              reader.integer("the number of an element");
              reader.add_element(type, id, reader.node_numbers(type.n_nodes));
            }
        }
    }
  } // namespace



  void
  read_msh(MeshReader &reader)
  {
    reader.expect("$MeshFormat");
    const double version = reader.number("the version");
    if (!((version >= 2. && version < 3.) || (version >= 4. && version < 4.2)))
      reader.fail("versions 2, 4.0 and 4.1 are supported; this is another");
    if (reader.integer("the file type") != 0)
      reader.fail("it is binary; only text is supported (Gmsh: Mesh.Binary = "
                  "0)");
    reader.integer("the size of numbers");
    reader.expect("$EndMeshFormat");

    PhysicalGroups groups;
    bool           has_nodes = false, has_elements = false;
    while (!reader.at_end())
      {
        const std::string section = reader.word("a section");
        if (section[0] != '$')
          reader.fail("expected a section that begins with $, found " +
                      MeshReader::quoted(section));
        const std::string end = "$End" + section.substr(1);
        if (section == "$Entities" && version >= 4.)
          groups = read_msh_entities(reader, version < 4.05);
        else if (section == "$Nodes")
          {
            read_msh_nodes(reader, version);
            has_nodes = true;
          }
        else if (section == "$Elements")
          {
            read_msh_elements(reader, version, groups);
            has_elements = true;
          }
        else
          {
            while (reader.word(end) != end)
              ;
            continue;
          }
        reader.expect(end);
      }
    if (!has_nodes || !has_elements)
      reader.fail(std::string("the file ends without a section ") +
                  (has_nodes ? "$Elements" : "$Nodes"));
  }
} // namespace Viscoplastic
