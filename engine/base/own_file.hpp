// Where this code was loaded from, and the programs that belong to it.
#pragma once

#include <string>

namespace verisim {

/// The file that holds this code: the running program, or the shared library that another program has loaded. Empty if
/// the system does not say.
[[nodiscard]] std::string own_file();

/// A program that this code starts: beside own_file(), one folder above it (tests, the Python module of a build), or
/// where `cmake --install` puts it. Empty if it is in none of these.
[[nodiscard]] std::string own_program(const std::string& name);

}  // namespace verisim
