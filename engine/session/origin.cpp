#include "engine/session/origin.hpp"

#include <fstream>

namespace verisim {

std::string compiler() {
#if defined(__clang__)
  return __VERSION__;  // which begins with its name
#else
  return "g++ " __VERSION__;
#endif
}

std::string cpu_model() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

}  // namespace verisim
