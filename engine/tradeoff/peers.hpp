// What other people's engines did on the same task: the list that the program verisim-peers (bench/peers) prints as
// JSON and `verisim tradeoff --peers` shows. A row is an engine, or one of this project's methods, each at its best of
// all settings that were tried:
//
//   name, version        of the engine; version null and `missing`, a Debian package: it was not there
//   setting, searched    words of the best, for `poses` and for `insertion`; figures of every setting that was tried
//   poses                contact queries: query_us, depth_error_m, gap_error_m, missed, imagined; null: the engine has
//                        no query of its own
//   insertion            driven insertions: passed, of, overlap_m, overlap_of_clearance, force_error_N, step_us
//
// Truths are closed forms of poses (bench/peers/insertion.hpp). SI units, times in us.
#pragma once

#include <string>

#include "engine/base/json.hpp"

namespace verisim::tradeoff {

inline constexpr const char* kPeersFormat = "verisim-peers";

/// For people: a table of queries, one of insertions, what was searched, what is missing. Error(input): no such list.
[[nodiscard]] std::string text_of_peers(const Json& peers);

}  // namespace verisim::tradeoff
