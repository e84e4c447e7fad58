#include "engine/base/own_file.hpp"

#include <link.h>

#include <cstdint>
#include <filesystem>

namespace verisim {
namespace {

struct Wanted {
  std::uintptr_t address;
  std::string name;
  bool found = false;
};

int look_at(dl_phdr_info* object, std::size_t /*size*/, void* data) {
  auto& wanted = *static_cast<Wanted*>(data);
  for (std::size_t i = 0; i < object->dlpi_phnum; ++i) {
    const ElfW(Phdr)& segment = object->dlpi_phdr[i];
    const std::uintptr_t begin = object->dlpi_addr + segment.p_vaddr;
    if (segment.p_type != PT_LOAD || wanted.address < begin || wanted.address - begin >= segment.p_memsz) continue;
    wanted.name = object->dlpi_name;
    wanted.found = true;
    return 1;
  }
  return 0;
}

}  // namespace

std::string own_file() {
  Wanted wanted{reinterpret_cast<std::uintptr_t>(&look_at), {}};
  ::dl_iterate_phdr(look_at, &wanted);
  std::error_code ignored;
  if (!wanted.found) return {};
  const std::filesystem::path name =
      wanted.name.empty() ? "/proc/self/exe" : wanted.name;  // the program has no name here
  return std::filesystem::canonical(name, ignored).string();
}

std::string own_program(const std::string& name) {
  constexpr const char* kInstalled = "libexec/verisim";  // below the prefix; engine/api/CMakeLists.txt
  const std::filesystem::path folder = std::filesystem::path(own_file()).parent_path(), above = folder.parent_path();
  std::error_code ignored;
  for (const std::filesystem::path& place : {folder, above, above / kInstalled, above.parent_path() / kInstalled}) {
    if (std::filesystem::exists(place / name, ignored)) return (place / name).string();
  }
  return {};
}

}  // namespace verisim
