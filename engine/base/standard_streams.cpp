#include "engine/base/standard_streams.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "engine/base/error.hpp"

namespace verisim {

// A folder that is open for reading: neither can be read from nor written to, and "/" is always there. open() takes the
// lowest number that is free, which is the one looked at.
void occupy_standard_streams() {
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor) {
    const bool is_closed = ::fcntl(descriptor, F_GETFD) < 0 && errno == EBADF;
    if (is_closed && ::open("/", O_RDONLY | O_DIRECTORY) != descriptor) ::_exit(static_cast<int>(ErrorKind::io));
  }
}

}  // namespace verisim
