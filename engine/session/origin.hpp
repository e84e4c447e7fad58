// Where a run comes from: the program and the machine. Stands in every run file (INTERFACES section 2).
#pragma once

#include <string>

namespace verisim {

/// First 12 hex digits of the commit that was built, "-dirty" behind it if files differ from it; "unknown" outside of a
/// repository.
[[nodiscard]] std::string commit();
[[nodiscard]] std::string compiler();   ///< "g++ 12.2.0"
[[nodiscard]] std::string cpu_model();  ///< as the system names it; "unknown" if it does not

}  // namespace verisim
