#include "engine/record/heap_check.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <set>
#include <string_view>

#include "engine/record/hdf5_wrapper.hpp"

namespace verisim {
namespace {

/// A file's bytes, read only, while in scope.
class MappedFile {
 public:
  explicit MappedFile(const std::string& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat info {};
    if (descriptor >= 0 && ::fstat(descriptor, &info) == 0 && info.st_size > 0) {
      size_ = static_cast<std::size_t>(info.st_size);
      data_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
    }
    if (descriptor >= 0) ::close(descriptor);
    if (data_ == MAP_FAILED) throw hdf5::Failure("cannot be read");
  }
  ~MappedFile() { ::munmap(data_, size_); }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  [[nodiscard]] std::string_view bytes() const { return {static_cast<const char*>(data_), size_}; }

 private:
  void* data_ = MAP_FAILED;
  std::size_t size_ = 0;
};

template <typename T>
T number_at(std::string_view bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// HDF5 File Format Specification, III.E, version 1: signature, version, 3 reserved bytes, size of the collection; then
// objects: index (2 bytes), reference count (2), reserved (4), size (8), content padded to 8. Index 0 is the free rest,
// whose size counts its own header.
constexpr std::string_view kHeapSignature("GCOL\1\0\0\0", 8);
constexpr std::size_t kHeader = 16;

bool is_whole(std::string_view collection) {
  std::set<std::uint16_t> seen;
  std::size_t at = kHeader;
  while (at + kHeader <= collection.size()) {
    const auto index = number_at<std::uint16_t>(collection, at);
    const auto size = number_at<std::uint64_t>(collection, at + 8);
    const std::size_t rest = collection.size() - at;
    if (index == 0) return size == rest;
    if (size > rest - kHeader || !seen.insert(index).second) return false;
    at += kHeader + (size + 7) / 8 * 8;
  }
  return at <= collection.size();  // too little is left for a header: full
}

}  // namespace

void check_text_heaps(const std::string& path) {
  check_text_heaps_of(MappedFile(path).bytes());
}

void check_text_heaps_of(std::string_view bytes) {
  for (std::size_t at = bytes.find(kHeapSignature); at != std::string_view::npos;
       at = bytes.find(kHeapSignature, at + 1)) {
    if (bytes.size() - at < kHeader) throw hdf5::Failure("a heap of texts is cut off");
    const auto size = number_at<std::uint64_t>(bytes, at + 8);
    if (size > bytes.size() - at || !is_whole(bytes.substr(at, size)))
      throw hdf5::Failure("a heap of texts is damaged");
  }
}

}  // namespace verisim
