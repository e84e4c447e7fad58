// Conversion of the kernel's shapes into parts. Kernel lengths are millimetres, for which its tolerances (1e-7) are
// made.
#pragma once

#include <TopoDS_Shape.hxx>
#include <array>
#include <string>
#include <vector>

#include "engine/geometry/cad/kernel.hpp"

namespace verisim::cad {

inline constexpr double kMillimetresPerMetre = 1000;

struct NamedShape {
  TopoDS_Shape shape;  ///< placed; a solid or a compound of solids
  std::string name;
  std::array<float, 4> color = {0.7F, 0.7F, 0.7F, 1};
  std::vector<std::string> notes;
};

/// Entities, mass and tessellation of a shape, as part.hpp and entity.hpp define them.
[[nodiscard]] Part part_from(const NamedShape& shape, const Options& options);

/// A solid's shape, with faces and edges that continue each other united. Throws Error(input) if nothing is left of it.
[[nodiscard]] TopoDS_Shape shape_from(const Solid& solid);

}  // namespace verisim::cad
