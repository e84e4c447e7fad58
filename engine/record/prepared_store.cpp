#include "engine/record/prepared_store.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "engine/base/archive.hpp"
#include "engine/base/hash.hpp"
#include "engine/base/user_file.hpp"

namespace verisim {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSuffix = ".prepared";
constexpr std::uint64_t kFormat = 1;

/// What stands before the content.
struct Head {
  std::array<char, 16> magic = {'v', 'e', 'r', 'i', 's', 'i', 'm', '-', 'p', 'r', 'e', 'p', 'a', 'r', 'e', 'd'};
  std::uint64_t format = kFormat;
  std::string key_hash;
  std::array<std::uint64_t, 2> check = {};
  std::uint64_t size = 0;
  bool operator==(const Head&) const = default;

  static void fields(auto& archive, Head& self) {
    archive(self.magic, self.format, self.key_hash, self.check, self.size);
  }
};

Head head_of(const std::string& key_hash, std::string_view content) {
  Head head;
  head.key_hash = key_hash;
  // The key is hashed along: a whole entry under another's name is a damaged one.
  const std::uint64_t seed = hash_bytes(key_hash.data(), key_hash.size(), 1);
  head.check = {hash_bytes(content.data(), content.size(), seed), hash_bytes(content.data(), content.size(), ~seed)};
  head.size = content.size();
  return head;
}

struct Entry {
  std::pair<time_t, long> used;  ///< s, ns
  std::uint64_t size;            ///< bytes
  std::string name;
};

/// None if the folder cannot be read. What killed processes left counts too.
std::vector<Entry> entries_in(const std::string& folder) {
  std::vector<Entry> entries;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    struct stat facts {};
    if (name.find(kSuffix) == std::string::npos || ::stat(entry.path().c_str(), &facts) != 0) continue;
    entries.push_back({{facts.st_mtim.tv_sec, facts.st_mtim.tv_nsec}, static_cast<std::uint64_t>(facts.st_size), name});
  }
  return entries;
}

bool write_whole(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

}  // namespace

PreparedStore::PreparedStore(std::string folder, std::string version, std::uint64_t bytes_max)
    : folder_(std::move(folder)), version_(std::move(version)), bytes_max_(bytes_max) {}

std::string PreparedStore::path_of(std::string_view kind, const std::string& key_hash) const {
  return (fs::path(folder_) / (std::string(kind) + "-" + key_hash + kSuffix)).string();
}

std::optional<std::string> PreparedStore::find(std::string_view kind, std::string_view key) {
  ++asked_;
  const std::string key_hash = sha256(sha256(key) + version_);
  const std::string path = path_of(kind, key_hash);
  if (::access(path.c_str(), R_OK) != 0) return {};
  try {
    std::string bytes = UserFile(path, path).content();
    ArchiveWriter expected;
    expected(head_of(key_hash, {}));
    const std::size_t head_size = expected.bytes.size();
    Head head;
    ArchiveReader reader(bytes);
    reader(head);
    const std::string_view content = std::string_view(bytes).substr(std::min(head_size, bytes.size()));
    if (head == head_of(key_hash, content)) {
      static_cast<void>(::utimensat(AT_FDCWD, path.c_str(), nullptr, 0));  // used now; not ours to touch: no matter
      ++found_;
      bytes.erase(0, head_size);
      return bytes;
    }
  } catch (const Error&) {  // too short, or gone meanwhile
    if (::access(path.c_str(), F_OK) != 0) return {};
  }
  ++damaged_;
  static_cast<void>(::unlink(path.c_str()));
  return {};
}

void PreparedStore::keep(std::string_view kind, std::string_view key, std::string_view content) {
  if (content.size() > bytes_max_ / 4) return;
  std::error_code error;
  fs::create_directories(fs::path(folder_).parent_path(), error);
  if (::mkdir(folder_.c_str(), 0700) != 0 && errno != EEXIST) return;
  const std::string key_hash = sha256(sha256(key) + version_);
  ArchiveWriter head;
  head(head_of(key_hash, content));
  make_room(head.bytes.size() + content.size());
  const std::string path = path_of(kind, key_hash);
  const std::string part = path + fmt::format(".{}.{}", ::getpid(), kept_);
  const int descriptor = ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (descriptor < 0) return;
  bool done = write_whole(descriptor, head.bytes) && write_whole(descriptor, content);
  done = ::close(descriptor) == 0 && done;
  done = done && std::rename(part.c_str(), path.c_str()) == 0;
  if (!done) static_cast<void>(::unlink(part.c_str()));
  if (done) ++kept_;
}

PreparedStore::Size PreparedStore::size_of(const std::string& folder) {
  Size size;
  for (const Entry& entry : entries_in(folder)) {
    ++size.entries;
    size.bytes += entry.size;
  }
  return size;
}

/// Removes what was used longest ago until `bytes` more fit; and what killed processes left, when it comes to that. The
/// folder is looked through once, and again when what was there then and is kept since may be too much: a sixteenth of
/// the limit is made free at a time.
void PreparedStore::make_room(std::uint64_t bytes) {
  if (bytes_there_ && *bytes_there_ + bytes <= bytes_max_) {
    *bytes_there_ += bytes;
    return;
  }
  std::vector<Entry> entries = entries_in(folder_);
  std::uint64_t all = bytes;
  for (const Entry& entry : entries) all += entry.size;
  if (all > bytes_max_) {
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.used < b.used; });
    for (const Entry& entry : entries) {
      if (all <= bytes_max_ - bytes_max_ / 16) break;
      if (::unlink((folder_ + "/" + entry.name).c_str()) == 0) all -= entry.size;
    }
  }
  bytes_there_ = all;
}

}  // namespace verisim
