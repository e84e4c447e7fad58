#include "engine/record/heap_check.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <set>
#include <string_view>
#include <type_traits>

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

/// The bytes of the whole heap that begins there; 0: there is none.
std::size_t heap_size(std::string_view bytes, std::size_t at) {
  if (at > bytes.size() || bytes.size() - at < kHeader) return 0;
  if (bytes.substr(at, kHeapSignature.size()) != kHeapSignature) return 0;
  const auto size = number_at<std::uint64_t>(bytes, at + 8);
  return size >= kHeader && size <= bytes.size() - at && is_whole(bytes.substr(at, size)) ? size : 0;
}

/// HDF5's file driver for bytes in memory, read only. It is a C structure that begins with HDF5's own part.
struct CheckedFile {
  H5FD_t of_hdf5;
  std::string_view bytes;
  haddr_t end_of_allocation;
};
static_assert(std::is_standard_layout_v<CheckedFile>);

const CheckedFile& checked(const H5FD_t* file) {
  return *reinterpret_cast<const CheckedFile*>(file);
}

/// What HDF5 does not pass on: the bytes that a file is opened of, the last heap that was asked for, and whether one
/// was damaged. Used under hdf5::Session, by one thread at a time.
struct Check {
  std::string_view bytes;
  std::size_t heap_begin = 0, heap_end = 0;
  bool found_damage = false;

  /// HDF5 fetches the beginning of a heap, which says how long it is, and then the rest.
  bool is_in_heap(std::size_t address, std::size_t size) {
    if (address >= heap_begin && address < heap_end && size <= heap_end - address) return true;
    heap_begin = address;
    heap_end = address + heap_size(bytes, address);
    found_damage = found_damage || heap_end == heap_begin;
    return heap_end != heap_begin;
  }
};
Check* current = nullptr;

H5FD_t* open_bytes(const char*, unsigned, hid_t, haddr_t) {
  auto* file = static_cast<CheckedFile*>(std::calloc(1, sizeof(CheckedFile)));
  if (file == nullptr) return nullptr;
  file->bytes = current->bytes;
  return &file->of_hdf5;
}

herr_t close_bytes(H5FD_t* file) {
  std::free(file);
  return 0;
}

haddr_t end_of_allocation(const H5FD_t* file, H5FD_mem_t) {
  return checked(file).end_of_allocation;
}

herr_t set_end_of_allocation(H5FD_t* file, H5FD_mem_t, haddr_t address) {
  reinterpret_cast<CheckedFile*>(file)->end_of_allocation = address;
  return 0;
}

haddr_t end_of_file(const H5FD_t* file, H5FD_mem_t) {
  return checked(file).bytes.size();
}

// HDF5 asks for a global heap as for values of a dataset (H5FD_MEM_DRAW), and no dataset is read here.
herr_t read_bytes(H5FD_t* file, H5FD_mem_t type, hid_t, haddr_t address, std::size_t size, void* to) {
  const std::string_view bytes = checked(file).bytes;
  if (address > bytes.size() || size > bytes.size() - address) return -1;
  if ((type == H5FD_MEM_DRAW || type == H5FD_MEM_GHEAP) && !current->is_in_heap(address, size)) return -1;
  std::memcpy(to, bytes.data() + address, size);
  return 0;
}

herr_t refuse_to_write(H5FD_t*, H5FD_mem_t, hid_t, haddr_t, std::size_t, const void*) {
  return -1;
}

hid_t driver() {
  static const hid_t id = [] {
    static H5FD_class_t kind = {};
    kind.name = "verisim_checked";
    kind.maxaddr = HADDR_MAX;
    kind.fc_degree = H5F_CLOSE_STRONG;
    kind.open = open_bytes;
    kind.close = close_bytes;
    kind.get_eoa = end_of_allocation;
    kind.set_eoa = set_end_of_allocation;
    kind.get_eof = end_of_file;
    kind.read = read_bytes;
    kind.write = refuse_to_write;
    constexpr H5FD_mem_t kMap[] = H5FD_FLMAP_DEFAULT;
    std::copy(std::begin(kMap), std::end(kMap), std::begin(kind.fl_map));
    return H5FDregister(&kind);
  }();
  return hdf5::check(id, "driver");
}

hdf5::Handle open_checked() {
  const hdf5::Handle access(hdf5::check(H5Pcreate(H5P_FILE_ACCESS), "access"), H5Pclose);
  hdf5::check_status(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), "access");
  hdf5::check_status(H5Pset_driver(access, driver(), nullptr), "access");
  const hbool_t forget = true;  // who wrote it and did not close it
  hdf5::check_status(H5Pset(access, "clear_status_flags", &forget), "access");
  return {hdf5::check(H5Fopen("bytes", H5F_ACC_RDONLY, access), "open"), H5Fclose};
}

/// Reads the texts of an object's attributes, and of all objects below it once each.
void read_texts(hid_t object, std::set<haddr_t>& seen) {
  H5O_info_t info;
  hdf5::check_status(H5Oget_info2(object, &info, H5O_INFO_BASIC), "object");
  if (!seen.insert(info.addr).second) return;
  hdf5::read_texts_of_attributes(object);
  if (info.type != H5O_TYPE_GROUP) return;
  for (const std::string& name : hdf5::children(object)) {
    H5L_info_t link;
    hdf5::check_status(H5Lget_info(object, name.c_str(), &link, H5P_DEFAULT), name.c_str());
    if (link.type != H5L_TYPE_HARD) continue;
    read_texts(hdf5::Handle(hdf5::check(H5Oopen(object, name.c_str(), H5P_DEFAULT), name.c_str()), H5Oclose), seen);
  }
}

}  // namespace

void check_text_heaps(const std::string& path) {
  check_text_heaps_of(MappedFile(path).bytes());
}

void check_text_heaps_of(std::string_view bytes) {
  Check check;
  check.bytes = bytes;
  current = &check;
  try {
    std::set<haddr_t> seen;
    const hdf5::Handle file = open_checked();
    read_texts(file, seen);
  } catch (const hdf5::Failure&) {
    if (check.found_damage) throw hdf5::Failure("a heap of texts is damaged");
    throw;
  }
}

}  // namespace verisim
