// The vectorised inner loop of a query, dispatched at run time. Private to this folder.
#pragma once

#include <span>

#include "engine/contact/query_arithmetic.hpp"

namespace verisim {

/// Looks up every point of the clusters and appends those in contact. Returns the number of candidates.
/// query() sees to it that `contacts` has room for all points, that no cluster has more than kBrickCells of them, and
/// that none has a local coordinate beyond 2^22.
std::uint64_t append_contacts(const QueryConstants& constants, const Pointshell& shell,
                              std::span<const PlacedCluster> clusters, ContactList& contacts);

}  // namespace verisim
