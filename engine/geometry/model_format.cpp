#include "engine/geometry/model_format.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace verisim {

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

}  // namespace verisim
