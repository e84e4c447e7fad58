// A part: one solid of a model file or one solid made from primitives, as the rest of the engine knows it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "engine/base/named_array.hpp"
#include "engine/geometry/entity.hpp"
#include "engine/geometry/mesh.hpp"

namespace verisim {

struct Part {
  std::string name;  ///< as the file names it; made unique within the model ("Undefined#2")
  std::array<float, 4> color = {0.7F, 0.7F, 0.7F, 1};
  TriangleMesh mesh;        ///< part coordinates as placed by the file, scaled to metres
  std::vector<Face> faces;  ///< empty: no b-rep is known
  std::vector<Edge> edges;
  MassProperties mass;  ///< exact where the geometry is, else that of the mesh
  double area = 0;      ///< m^2
  bool watertight = false;
  bool exact = false;              ///< faces, edges and mass come from exact geometry
  std::string solid;               ///< made from a Solid: its text (solid.hpp), in part coordinates; not in tables
  std::vector<std::string> notes;  ///< repairs and warnings, one sentence each

  [[nodiscard]] bool has_brep() const { return !faces.empty(); }
};

/// Two cylinders of two parts that could mate: a pin in a hole of nearly its radius.
struct Mate {
  std::string part_a, part_b;  ///< the part with the hole, the part with the pin
  double radius_hole = 0, radius_pin = 0;
  [[nodiscard]] double clearance() const { return radius_hole - radius_pin; }
};

/// All pairs (hole, pin) of two different parts whose radii differ by at most `tolerance` (relative to the hole's),
/// ordered by clearance, then part names. Equal rows are listed once. @pre tolerance is finite and not negative
[[nodiscard]] std::vector<Mate> mating_candidates(const std::vector<Part>& parts, double tolerance = 0.15);

/// A part as tables (vertices, triangles, faces, edges, mass …) and back: what a run file embeds, so that `replay`
/// needs no CAD kernel. Round trip is exact to the bit. Error(input) for tables that do not fit together.
/// @pre is_whole(part.mesh)
[[nodiscard]] std::vector<NamedArray> to_tables(const Part& part);
[[nodiscard]] Part from_tables(const std::string& name, const std::vector<NamedArray>& tables);

}  // namespace verisim
