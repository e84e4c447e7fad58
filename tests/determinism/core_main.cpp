// Runs the core scenes and prints one line each: built by two compilers at several levels, all must print the same.
#include <cstdio>

#include "engine/base/hash.hpp"
#include "tests/determinism/core_scenes.hpp"

int main() {
  for (const verisim::determinism::CoreScene& scene : verisim::determinism::core_scenes()) {
    const verisim::determinism::CoreResult result = run_core(scene, 1);
    std::printf("%-24s %s %llu contacts\n", scene.name.c_str(), verisim::to_hex(result.hash).c_str(),
                static_cast<unsigned long long>(result.contacts));
  }
}
