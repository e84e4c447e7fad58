// Where this build, its sources and the recordings of other people lie. Defined in one small file that CMake writes, so
// that all else is the same in every clone, and the compiler cache knows it.
#pragma once

#include <string>

namespace verisim::paths {

/// A file below the folder of the sources, of the build, of shared data or of shared reference. The last two may be
/// absent.
[[nodiscard]] std::string in_sources(const std::string& file);
[[nodiscard]] std::string in_build(const std::string& file);
[[nodiscard]] std::string in_shared_data(const std::string& file);
[[nodiscard]] std::string in_shared_reference(const std::string& file);

}  // namespace verisim::paths
