// The vectorised inner loop of a query, dispatched at run time. Private to this folder.
#pragma once

#include <span>

#include "engine/contact/query_arithmetic.hpp"

namespace verisim {

/// Looks up every point of the clusters and appends those in contact. Returns the number of candidates.
/// @pre clusters are in the shell's order, also from call to call, and `contacts` has room for all of its points; no
/// cluster has more than kBrickCells points, nor a local coordinate beyond 2^22 (this query() asserts, cluster by
/// cluster)
std::uint64_t append_contacts(const QueryConstants& constants, const Pointshell& shell,
                              std::span<const PlacedCluster> clusters, ContactList& contacts);

}  // namespace verisim
