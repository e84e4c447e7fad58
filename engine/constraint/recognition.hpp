// Constraint recognition with all of the project's recognizers (recognizers.hpp; dispatch: multi_method.hpp). Source:
// dissertation chapter 7.
#pragma once

#include "engine/constraint/constraint.hpp"
#include "engine/constraint/entities.hpp"
#include "engine/constraint/tolerances.hpp"

namespace verisim {

/// The constraint between an entity of A and one of B, or kind `none`. Swapped arguments swap the sides and change
/// nothing else. Pure, no allocation.
[[nodiscard]] Constraint recognize(const Entity& a, const Entity& b, const Tolerances& tolerances = {});

}  // namespace verisim
