// Where this code was loaded from.
#pragma once

#include <string>

namespace verisim {

/// The file that holds this code: the running program, or the shared library that another program has loaded. Empty if
/// the system does not say.
[[nodiscard]] std::string own_file();

}  // namespace verisim
