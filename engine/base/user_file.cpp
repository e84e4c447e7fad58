#include "engine/base/user_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

std::string name_of_type(mode_t mode) {
  if (S_ISREG(mode)) return {};
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

void check_plain(const std::string& name, const struct stat& info) {
  const std::string type = name_of_type(info.st_mode);
  if (!type.empty()) fail(ErrorKind::input, "{}: is {}, a file is wanted; name a plain file", name, type);
}

/// What is short or broken may be there again when the same is asked for once more: no fault of the input.
[[noreturn]] void refuse_for_now(const std::string& name, int cause) {
  fail(ErrorKind::io, "{}: cannot be read now ({}); give the system what it lacks and try again", name,
       std::generic_category().message(cause));
}

[[noreturn]] void refuse_reading(const std::string& name, int cause) {
  if (cause == EMFILE || cause == ENFILE || cause == ENOMEM) refuse_for_now(name, cause);
  const bool is_gone = cause == ENOENT || cause == ENOTDIR;
  fail(ErrorKind::input, "{}: cannot be read ({}); check its {}", name, std::generic_category().message(cause),
       is_gone ? "name and folder" : "permissions");
}

}  // namespace

std::optional<FileIdentity> identity_of(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return {};
  return FileIdentity{info.st_dev, info.st_ino};
}

std::string other_than_plain(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 ? name_of_type(info.st_mode) : std::string();
}

// Looked at before it is opened, for to open some devices is to act on them; and after, for it may have been replaced
// in between. O_NONBLOCK: that replacement may be a FIFO, and some files of /proc wait for news.
UserFile::UserFile(const std::string& name, const std::string& path) : name_(name) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) refuse_reading(name, errno);
  check_plain(name, info);
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor_ < 0) refuse_reading(name, errno);
  try {
    if (::fstat(descriptor_, &info) != 0) refuse_reading(name, errno);
    check_plain(name, info);
  } catch (const Error&) {
    ::close(descriptor_);
    throw;
  }
  size_ = static_cast<std::uint64_t>(info.st_size);
  identity_ = {info.st_dev, info.st_ino};
}

UserFile::~UserFile() {
  ::close(descriptor_);
}

std::string UserFile::read(std::size_t size_max) const {
  constexpr std::size_t kStep = 1 << 20;  // for files whose size the system does not know, as those of /proc
  std::string content;
  std::size_t done = 0;
  while (done < size_max) {
    content.resize(std::min(size_max, std::max<std::size_t>(size_, done) + kStep));
    const ssize_t count = ::pread(descriptor_, content.data() + done, content.size() - done, static_cast<off_t>(done));
    if (count < 0 && errno == EINTR) continue;
    // A disk that fails gives EIO; so do files of the system that have no size, for they are not for reading.
    if (count < 0 && errno == EIO && size_ > 0) refuse_for_now(name_, errno);
    if (count < 0) refuse_reading(name_, errno);
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  content.resize(done);
  return content;
}

std::string UserFile::content(std::uint64_t size_max) const {
  if (size_ > size_max)
    fail(ErrorKind::input, "{}: has {} bytes, more than the {} that are read; give a smaller file", name_, size_,
         size_max);
  std::string content = read(size_max + 1);
  if (content.size() > size_max)
    fail(ErrorKind::input, "{}: has no end within the {} bytes that are read; give a plain file", name_, size_max);
  return content;
}

std::string UserFile::beginning(std::size_t size) const {
  return read(size);
}

std::uint64_t UserFile::stored_bytes() const {
  std::uint64_t stored = 0;
  const auto end = static_cast<off_t>(size_);
  for (off_t at = 0; at < end;) {
    const off_t data = ::lseek(descriptor_, at, SEEK_DATA);
    if (data < 0) break;  // holes up to the end
    const off_t hole = ::lseek(descriptor_, data, SEEK_HOLE);
    if (hole < 0) return size_;  // a file system that does not tell
    stored += static_cast<std::uint64_t>(hole - data);
    at = hole;
  }
  return stored;
}

}  // namespace verisim
