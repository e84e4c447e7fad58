// What a run file says beside its rows, held against a simulation that went the same way again: attributes of "/" and
// of /summary, events. The rows: stored_run.hpp. What no simulation computes again: RunFile::altered.
//
// Each function returns what differs first, with both values, or an empty text.
#pragma once

#include <string>
#include <vector>

#include "engine/session/summary.hpp"

namespace verisim::cli {

/// Was the file written by this very program? Another one may have other attributes: then only those count that both
/// have.
[[nodiscard]] bool is_from_here(const RunFile& file);

/// Scenario with its sha256, parameters, seed, dt, invocation, and state_hash unless the run was killed.
[[nodiscard]] std::string difference_in_attributes(const RunFile& file, const Session& session);

/// How the run ended, and every figure of /summary that is neither wall clock nor the file's place. Steps on by a frame
/// where the file says that the run ended by itself before its time. Nothing for the file of a killed run, which has no
/// summary. That a run was interrupted is taken as it is said.
/// @pre the file's frames have been simulated
[[nodiscard]] std::string difference_in_summary(const RunFile& file, Session& session);

/// @param simulated  of the file's frames, in their order
/// The file of a killed run may lack the last events, and hold some of the frames that it lost. One of a paced run says
/// how many events found no room; the others are compared.
[[nodiscard]] std::string difference_in_events(const RunFile& file, const std::vector<Event>& simulated, double time);

}  // namespace verisim::cli
