// `verisim tradeoff --peers`: the program verisim-peers beside this one measures other engines and this project's
// methods on the same poses and insertions. It links their libraries, which few have, so it is a program of its own.
#pragma once

#include <string>

#include "engine/base/json.hpp"

namespace verisim::cli {

/// The path of verisim-peers. Error(input) that says what to install and how to build it, if it is not there.
[[nodiscard]] std::string peers_program();

struct PeersFound {
  Json peers;        ///< as engine/tradeoff/peers.hpp says
  std::string note;  ///< that it was built from another commit; empty: it was not
};
/// Runs it: minutes, with `quick` one or two. Its progress goes to stderr; it ends with this program.
/// Error(input): it cannot be started, ends badly, or says something else than a list of engines.
[[nodiscard]] PeersFound ask_peers(const std::string& program, bool quick, bool quiet);

}  // namespace verisim::cli
