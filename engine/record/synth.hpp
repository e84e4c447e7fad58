// Synthesized haptic traces: every sample is a formula of time. For scenes without a recorded hand, and for tests that
// need a known answer. Pinned functions and named random streams: equal parameters and seed give equal bits everywhere.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "engine/record/trace.hpp"

namespace verisim {

/// Names of all kinds: "sine" (sum of two sines per axis), "reach" (minimum jerk, point to point and back), "tremor"
/// (physiological tremor around a point), "insertion" (down and up along an axis, again and again), "step" (a jump).
[[nodiscard]] std::vector<std::string> synthesizers();

/// All kinds, and below each its parameters, one line each: name, default, unit, meaning. For --help.
[[nodiscard]] std::string synthesizer_help();

/// A haptic trace of that kind. Its `source` says kind, parameters and seed, so that it can be made again.
/// Error(usage) for an unknown parameter (with the nearest name), one that is not finite, a rate or duration of 0.
[[nodiscard]] Trace synthesize(const std::string& kind, const std::map<std::string, double>& parameters,
                               std::uint64_t seed);

}  // namespace verisim
