#include "engine/geometry/write_file.hpp"

#include <cerrno>
#include <fstream>
#include <system_error>

#include "engine/base/error.hpp"

namespace verisim {
void write_file(const std::string& path, const std::string& content) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  if (!file) {
    fail(ErrorKind::io, "{}: cannot be written ({}); check the folder and the space left", path,
         std::generic_category().message(errno));
  }
}

}  // namespace verisim
