// What to say when memory is out: what wanted how much. The program's operator new notes the request that failed.
#pragma once

#include <string>

namespace verisim::cli {

/// One line about the request that failed: "out of memory: recording 90000000 frames wanted 720.0 MB more; …".
[[nodiscard]] std::string out_of_memory_text();

}  // namespace verisim::cli
