// The format of a model file, by its extension.
#pragma once

#include <string>

namespace verisim {

/// The extension in lower case without its dot: "stl" for "a/Peg.STL".
[[nodiscard]] std::string extension_of(const std::string& path);

}  // namespace verisim
