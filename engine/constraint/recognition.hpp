// Automatic constraint recognition: the public face of the multi-method (multi_method.hpp) with all of the project's
// recognizers (recognizers.hpp), for single pairs and for whole sets.
#pragma once

#include <span>
#include <vector>

#include "engine/constraint/constraint.hpp"
#include "engine/constraint/entities.hpp"
#include "engine/constraint/sorted_entities.hpp"
#include "engine/constraint/tolerances.hpp"

namespace verisim {

/// The constraint between an entity of A and one of B, or kind `none`. Order does not matter but for the sides. Pure,
/// no allocation.
[[nodiscard]] Constraint recognize(const Entity& a, const Entity& b, const Tolerances& tolerances = {});

/// Which entities of two parts could ever be a constraint, by size and role: all pairs at once (sorted_entities.hpp).
/// For load time and reports: it allocates.
[[nodiscard]] std::vector<Match> recognize_all(std::span<const Entity> a, std::span<const Entity> b,
                                               const Tolerances& tolerances = {});

}  // namespace verisim
