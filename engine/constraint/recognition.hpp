// Constraint recognition with all of the project's recognizers (recognizers.hpp; dispatch: multi_method.hpp), for
// single pairs and for whole sets. Source: dissertation chapter 7.
#pragma once

#include <span>
#include <vector>

#include "engine/constraint/constraint.hpp"
#include "engine/constraint/entities.hpp"
#include "engine/constraint/sorted_entities.hpp"
#include "engine/constraint/tolerances.hpp"

namespace verisim {

/// The constraint between an entity of A and one of B, or kind `none`. Swapped arguments swap the sides and change
/// nothing else. Pure, no allocation.
[[nodiscard]] Constraint recognize(const Entity& a, const Entity& b, const Tolerances& tolerances = {});

/// Which entities of two parts could ever be a constraint, by size and role: all pairs at once (sorted_entities.hpp).
/// For load time and reports: it allocates.
[[nodiscard]] std::vector<Match> recognize_all(std::span<const Entity> a, std::span<const Entity> b,
                                               const Tolerances& tolerances = {});

}  // namespace verisim
