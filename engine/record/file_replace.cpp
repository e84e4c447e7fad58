#include "engine/record/file_replace.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

/// A file descriptor that is closed at the end of its scope.
struct Descriptor {
  int id;
  explicit Descriptor(int number) : id(number) {}
  ~Descriptor() {
    if (id >= 0) ::close(id);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
};

constexpr mode_t kPermissions = 0666;  // less the user's umask

[[noreturn]] void refuse(const std::string& path) {
  refuse_write(path, system_cause());
}

void write_all(const std::string& path, int to, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(to, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) refuse(path);
    data += written;
    size -= static_cast<std::size_t>(written);
  }
}

// For file systems between which copy_file_range does not work.
void copy_by_reading(const std::string& path, int from, int to) {
  std::vector<char> buffer(1 << 20);
  for (;;) {
    const ssize_t count = ::read(from, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse(path);
    if (count == 0) return;
    write_all(path, to, buffer.data(), static_cast<std::size_t>(count));
  }
}

struct flock whole_file(int type) {
  struct flock lock {};
  lock.l_type = static_cast<short>(type);
  lock.l_whence = SEEK_SET;
  return lock;
}

/// Opens a file to be written anew: a plain one or none. A FIFO would make the opening wait, a link would lead it away.
int open_anew(const std::string& path) {
  struct stat info {};
  if (::lstat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode)) refuse_write(path, "it is no plain file");
  const int flags = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
  const int descriptor = ::open(path.c_str(), flags, kPermissions);
  if (descriptor < 0) refuse(path);
  return descriptor;
}

bool marked_by_another(int descriptor) {
  struct flock lock = whole_file(F_WRLCK);
  return ::fcntl(descriptor, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

}  // namespace

void refuse_write(const std::string& path, const std::string& cause) {
  fail(ErrorKind::io, "{}: cannot be written ({}); free some space or choose another place", path, cause);
}

std::string system_cause() {
  return std::generic_category().message(errno);
}

Replacement::~Replacement() {
  struct stat info {};  // what is no plain file is not of its making
  if (committed_ || kept_) return;
  if (::lstat(path_.c_str(), &info) == 0 && S_ISREG(info.st_mode)) ::unlink(path_.c_str());
}

void copy_file(const std::string& path, int from, int to) {
  if (::lseek(from, 0, SEEK_SET) < 0) refuse(path);
  for (;;) {
    const ssize_t count = ::copy_file_range(from, nullptr, to, nullptr, std::size_t{1} << 30, 0);
    if (count == 0) return;
    if (count > 0 || errno == EINTR) continue;
    if (errno != EXDEV && errno != EINVAL && errno != ENOSYS && errno != EOPNOTSUPP) refuse(path);
    return copy_by_reading(path, from, to);
  }
}

void Replacement::copy_from(int descriptor) const {
  const Descriptor to(open_anew(path_));
  copy_file(path_, descriptor, to.id);
}

void Replacement::write(const std::string& content) const {
  const Descriptor to(open_anew(path_));
  write_all(path_, to.id, content.data(), content.size());
}

void Replacement::commit() {
  if (committed_) return;
  if (std::rename(path_.c_str(), target_.c_str()) != 0) refuse(target_);
  committed_ = true;
}

MarkedFile::MarkedFile(const std::string& path, Mark mark)
    : descriptor_(
          ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK | (mark == Mark::writer ? O_CREAT : 0), kPermissions)) {
  const bool read_only = descriptor_ < 0 && (errno == EACCES || errno == EROFS) && mark == Mark::recovery;
  if (read_only) descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor_ < 0) return;
  if (read_only) {  // cannot be marked, only asked
    refused_ = marked_by_another(descriptor_);
    return;
  }
  struct flock lock = whole_file(F_WRLCK);
  refused_ = ::fcntl(descriptor_, F_OFD_SETLK, &lock) != 0 && (errno == EAGAIN || errno == EACCES);
}

MarkedFile::~MarkedFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool MarkedFile::is_at(const std::string& path) const {
  struct stat mine {};
  struct stat named {};
  return ::fstat(descriptor_, &mine) == 0 && ::stat(path.c_str(), &named) == 0 && mine.st_dev == named.st_dev &&
         mine.st_ino == named.st_ino;
}

void MarkedFile::allow_readers() const {
  struct flock lock = whole_file(F_RDLCK);
  static_cast<void>(::fcntl(descriptor_, F_OFD_SETLK, &lock));
}

Reservation::Reservation(const std::string& path)
    : path_(path), descriptor_(::open(path.c_str(), O_WRONLY | O_CLOEXEC)) {
  if (descriptor_ < 0) refuse(path_);
}

Reservation::~Reservation() {
  struct stat info {};
  if (::fstat(descriptor_, &info) == 0 && static_cast<std::uint64_t>(info.st_size) < end_) {
    const auto rest = static_cast<off_t>(end_) - info.st_size;
    static_cast<void>(::fallocate(descriptor_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, info.st_size, rest));
  }
  ::close(descriptor_);
}

void Reservation::ensure(std::uint64_t bytes, std::uint64_t step) {
  VERISIM_ASSERT(step > 0);
  struct stat info {};
  if (::fstat(descriptor_, &info) != 0) refuse(path_);
  const auto size = static_cast<std::uint64_t>(info.st_size);
  rlimit limit{};
  if (::getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && size + bytes > limit.rlim_cur) {
    errno = EFBIG;  // the user's own limit, which reserving does not meet
    refuse(path_);
  }
  if (size + bytes <= end_) return;
  const auto reserve = [&](std::uint64_t length) {
    return ::fallocate(descriptor_, FALLOC_FL_KEEP_SIZE, info.st_size, static_cast<off_t>(length)) == 0;
  };
  end_ = size + bytes + step;
  if (reserve(bytes + step) || errno == EOPNOTSUPP || errno == ENOSYS) return;
  end_ = size + bytes;  // the last of the disk
  if (!reserve(bytes)) refuse(path_);
}

bool is_being_written(const std::string& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  return file.id >= 0 && marked_by_another(file.id);
}

}  // namespace verisim
