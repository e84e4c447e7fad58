// Parts together with the CAD kernel's own shapes of them, and the kernel's distances: the association's oracle. Only
// the tests that compare with the kernel include this.
#pragma once

#include <Bnd_Box.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "engine/geometry/part.hpp"
#include "engine/geometry/solid.hpp"

namespace verisim::test {

/// A part and the kernel's shapes of its entities, in the order in which they are numbered (EntityNumber).
struct KernelPart {
  Part part;
  std::vector<TopoDS_Shape> entities;  ///< in millimetres
  std::vector<Bnd_Box> boxes;          ///< around the entities
};

[[nodiscard]] KernelPart kernel_part_of(const Solid& solid);

/// The solid number `index` of a STEP file.
[[nodiscard]] KernelPart kernel_part_of_file(const std::string& path, int index = 0);

/// Distance of entity `number` from a closed box [m], as the kernel finds it; infinite if their own boxes are apart.
[[nodiscard]] double kernel_distance(const KernelPart& part, std::size_t number, const Vector3d& center,
                                     double half_side);

}  // namespace verisim::test
