// Automatic constraint recognition: the public face of the multi-method (multi_method.hpp) with all of the project's
// recognizers (recognizers.hpp).
#pragma once

#include "engine/constraint/constraint.hpp"
#include "engine/constraint/entities.hpp"
#include "engine/constraint/tolerances.hpp"

namespace verisim {

/// The constraint between an entity of A and one of B, or kind `none`. Order does not matter but for the sides. Pure,
/// no allocation.
[[nodiscard]] Constraint recognize(const Entity& a, const Entity& b, const Tolerances& tolerances = {});

}  // namespace verisim
