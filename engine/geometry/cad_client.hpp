// Requests to the CAD program (verisim-cad), a child process. A damaged file may crash it or make it hang; here that is
// bad input.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "engine/geometry/message.hpp"

namespace verisim {

inline constexpr double kCadTimeLimit = 120;  ///< s; the largest model known to load takes a tenth of it

/// Its path: the environment variable VERISIM_CAD, or beside the program or library that holds this code, or one folder
/// above, or where `cmake --install` puts it. Error(io) if there is none.
[[nodiscard]] std::string cad_program();

/// Starts verisim-cad, sends the request and returns its answer. `subject` (a file's path) begins the error texts.
/// Leaves no process and no descriptor behind. 15 to 60 ms for starting the program.
///
/// Errors: what the program reports, with its kind; Error(input) if it crashes, passes the time limit or is out of
/// memory; Error(io) if it cannot be started, or lacks a library, which the text names with its package.
/// @pre time_limit_s > 0
[[nodiscard]] Message ask_cad(const Message& request, const std::string& subject, double time_limit_s = kCadTimeLimit);

/// A verisim-cad that stays for one request after the other: to start it takes longer than to build most solids. It is
/// started with the first request and ends with this object. For one thread.
class CadSession {
 public:
  CadSession();
  ~CadSession();
  CadSession(const CadSession&) = delete;
  CadSession& operator=(const CadSession&) = delete;

  /// Its answer. Nothing if there is no good one, whatever the reason: the program is then ended, so that a later
  /// request finds a new one, and whoever asks ask_cad() the same hears what is wrong, of this request alone.
  [[nodiscard]] std::optional<Message> ask(const Message& request);

 private:
  struct Running;
  std::unique_ptr<Running> running_;
};

}  // namespace verisim
