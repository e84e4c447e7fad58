// Parts of the experiments' scenes, without files or CAD kernel. Lengths in m.
#pragma once

#include <string>

#include "engine/simulation/scene.hpp"

namespace verisim::stability {

/// A box centred at the body's origin.
[[nodiscard]] Part box_part(const std::string& name, const Vector3d& size);
/// The same as a body of a given mass [kg].
[[nodiscard]] BodyDescription box_body(const std::string& name, const Vector3d& size, double mass, double voxel_size);

}  // namespace verisim::stability
