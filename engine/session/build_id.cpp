#include "engine/session/build_id.hpp"

#include <elf.h>

#include <cstring>
#include <string_view>

#include "engine/base/error.hpp"
#include "engine/base/hash.hpp"
#include "engine/base/user_file.hpp"

namespace verisim {
namespace {

constexpr std::size_t kBeginning = 1 << 16;  // notes stand there

/// Copies a T at `offset`; false if it is not all there.
template <typename T>
bool read_at(std::string_view bytes, std::size_t offset, T& value) {
  if (offset > bytes.size() || sizeof value > bytes.size() - offset) return false;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return true;
}

/// The build id among the notes [begin, end); empty if it is none of them.
std::string build_id_among(std::string_view bytes, std::size_t begin, std::size_t end) {
  const auto padded = [](std::size_t n) { return (n + 3) / 4 * 4; };
  Elf64_Nhdr note{};
  while (begin < end && read_at(bytes, begin, note)) {
    const std::size_t name = begin + sizeof note, content = name + padded(note.n_namesz);
    begin = content + padded(note.n_descsz);
    if (begin > bytes.size()) break;
    if (note.n_type != NT_GNU_BUILD_ID || bytes.substr(name, note.n_namesz) != std::string_view("GNU\0", 4)) continue;
    std::string hex;
    for (const char byte : bytes.substr(content, note.n_descsz))
      hex += fmt::format("{:02x}", static_cast<unsigned char>(byte));
    return hex;
  }
  return {};
}

}  // namespace

std::string build_id_of(const std::string& path) {
  try {
    const UserFile file(path, path);
    const std::string bytes = file.beginning(kBeginning);
    Elf64_Ehdr head{};
    if (read_at(bytes, 0, head) && std::memcmp(head.e_ident, ELFMAG, SELFMAG) == 0) {
      for (std::size_t i = 0; i < head.e_phnum; ++i) {
        Elf64_Phdr segment{};
        if (!read_at(bytes, head.e_phoff + i * sizeof segment, segment)) break;
        if (segment.p_type != PT_NOTE || segment.p_offset > bytes.size()) continue;
        std::string id = build_id_among(bytes, segment.p_offset, segment.p_offset + segment.p_filesz);
        if (!id.empty()) return id;
      }
    }
    return sha256(file.content());
  } catch (const Error&) {
    return {};
  }
}

}  // namespace verisim
