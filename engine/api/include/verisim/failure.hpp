// What the functions of this library throw.
#pragma once

#include <stdexcept>
#include <string>

// What libverisim.so shows (its other names are its own).
#define VERISIM_PUBLIC __attribute__((visibility("default")))

namespace verisim {

/// One line: where, what, what to do. Memory that is out is std::bad_alloc.
class VERISIM_PUBLIC Failure : public std::runtime_error {
 public:
  Failure(int exit_code, const std::string& what) : std::runtime_error(what), exit_code_(exit_code) {}
  /// The program's for the same: 2 wrong usage, 3 bad input, 5 cannot be written.
  [[nodiscard]] int exit_code() const { return exit_code_; }

 private:
  int exit_code_;
};

}  // namespace verisim
