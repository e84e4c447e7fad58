// Which build a program file is: what its linker wrote into it, another for every other content.
#pragma once

#include <string>

namespace verisim {

/// The GNU build id of an ELF file in hex digits; of a file without one the SHA-256 of its content; empty if it cannot
/// be read.
[[nodiscard]] std::string build_id_of(const std::string& path);

}  // namespace verisim
