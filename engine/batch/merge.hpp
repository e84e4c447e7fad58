// Shards of one batch become one folder, as if one batch had made it.
#pragma once

#include <string>
#include <vector>

namespace verisim::batch {

/// Into `out`, which is new or empty. Error(input): the shards are of other designs or versions; runs are missing or
/// there twice, with their list. Error(io).
/// @param version what an index says of the program that made it
void merge(const std::string& out, const std::vector<std::string>& shards, const std::string& version);

}  // namespace verisim::batch
