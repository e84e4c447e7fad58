// Errors at the edge and contracts inside.
//
// Whatever comes from outside (scenario, model, trace, run file, command line, disk) is checked where it enters; what
// is wrong with it is thrown as an Error whose text is one line: where, what, what to do. The command line turns the
// kind into the promised exit code (INTERFACES section 1). Inside, a broken promise is VERISIM_ASSERT, on in every
// build.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace verisim {

/// What went wrong, in the numbers of the exit codes that users rely on.
enum class ErrorKind : int {
  check_failed = 1,  ///< --verify differs, compare found a regression
  usage = 2,         ///< wrong usage of the command line
  input = 3,         ///< scenario, model, trace or run file is not what it should be
  diverged = 4,      ///< the simulation produced a value that is not finite
  io = 5,            ///< disk full, not writable
  interrupted = 130  ///< Ctrl-C
};

class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& what) : std::runtime_error(what), kind_(kind) {}
  [[nodiscard]] ErrorKind kind() const { return kind_; }
  [[nodiscard]] int exit_code() const { return static_cast<int>(kind_); }

 private:
  ErrorKind kind_;
};

/// Throws Error(kind) with a formatted line: fail(ErrorKind::input, "{}:{}: ...; do this", file, row).
template <typename... Args>
[[noreturn]] void fail(ErrorKind kind, fmt::format_string<Args...> format, Args&&... args) {
  throw Error(kind, fmt::format(format, std::forward<Args>(args)...));
}

/// Prints where a promise was broken and aborts. Never returns.
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line);

/// The name in `known` that is nearest to `name` by edit distance, or an empty string if none is near. For "did you
/// mean".
[[nodiscard]] std::string nearest_name(const std::string& name, const std::vector<std::string>& known);

}  // namespace verisim

#define VERISIM_ASSERT(condition) \
  (static_cast<bool>(condition) ? static_cast<void>(0) : ::verisim::assertion_failed(#condition, __FILE__, __LINE__))
