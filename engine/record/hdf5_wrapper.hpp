// A wrapper of HDF5's C API: handles that close themselves, one lock, errors as exceptions, attributes.
//
// HDF5 keeps global state and is not thread-safe in every build: every caller holds an Hdf5Session. HDF5's own error
// printing is off. Functions throw Hdf5Failure, whose text is the cause (“No space left
// on device”) where HDF5 knows it; callers turn it into Error(input) or Error(io) with the file's name.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/named_array.hpp"
#include "engine/record/run_file.hpp"

namespace verisim::hdf5 {

/// The lock for calls of HDF5 from this thread. Not recursive: public functions take it, helpers never do.
class Session {
 public:
  Session();

 private:
  std::unique_lock<std::mutex> lock_;
};

class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// `result` of an HDF5 call if it is not negative; else throws Failure(`what`: cause).
hid_t check(hid_t result, const char* what);
inline void check_status(herr_t status, const char* what) {
  check(status, what);
}

/// An HDF5 identifier that is closed at the end of its scope.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), closer_(other.closer_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(closer_, other.closer_);
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { reset(); }
  operator hid_t() const { return id_; }
  void reset() {
    if (id_ >= 0) closer_(id_);
    id_ = -1;
  }
  /// Releases the identifier without closing it.
  hid_t release() { return std::exchange(id_, -1); }

 private:
  hid_t id_ = -1;
  Closer closer_ = nullptr;
};

/// Shape of a dataset in memory or file; an empty list is a scalar.
using Shape = std::vector<hsize_t>;

[[nodiscard]] Handle file_access();  ///< property list: format 1.10 (SWMR), files locked where the system can
/// The same for a file that many datasets grow in: nothing leaves HDF5's cache of metadata. What it holds of a dataset,
/// some 5 kB, depends on each other under SWMR, and HDF5 1.10 fails once it throws a part of that out (thousands of
/// datasets; "Child entry doesn't have a flush dependency parent array").
[[nodiscard]] Handle writer_access();
/// The same for files that stay open while others may read them in this process: h5py closes as HDF5's default says,
/// and two that have a file open at a time have to agree.
[[nodiscard]] Handle reader_access();
/// A new file, in place of any at `path`: no times (equal content, equal bytes), links in order of creation.
[[nodiscard]] Handle create_file(const std::string& path);
[[nodiscard]] Handle open_group(hid_t location, const std::string& path);
/// A group, with those on the way to it, without times.
[[nodiscard]] Handle create_group(hid_t location, const std::string& path);
/// A dataset, with the groups on the way to it, without times. `creation`: the caller's list, which loses its times.
[[nodiscard]] Handle create_dataset(hid_t location, const std::string& path, hid_t type, hid_t space, hid_t creation);
[[nodiscard]] Handle open_dataset(hid_t location, const std::string& path);
[[nodiscard]] bool exists(hid_t location, const std::string& name);  ///< a link of that name, one level

[[nodiscard]] hid_t stored_type(Dtype dtype);  ///< little endian; not to be closed
[[nodiscard]] hid_t memory_type(Dtype dtype);  ///< native; not to be closed
/// The Dtype of a stored number type. Throws Failure for anything else.
[[nodiscard]] Dtype dtype_of_stored(hid_t type);

[[nodiscard]] Shape unchecked_shape(hid_t dataset);
/// Shape of a dataset, refused (Failure) if it claims more bytes than it stores: a damaged length must not allocate.
[[nodiscard]] Shape checked_shape(hid_t dataset, std::size_t element_bytes);

/// A dataset of fixed shape with `units` and `description`, written whole; left open for further attributes.
/// @pre there is data, unless the shape holds nothing
Handle write_array(hid_t location, const std::string& path, Dtype dtype, const Shape& shape, const void* data,
                   const std::string& units, const std::string& description);

void write_attribute(hid_t object, const std::string& name, const Attribute& value);
void write_attribute(hid_t object, const std::string& name, const std::vector<std::string>& values);
[[nodiscard]] bool has_attribute(hid_t object, const std::string& name);
/// Strings of fixed or variable length, any integer, any float. Throws Failure for anything else.
[[nodiscard]] Attribute read_attribute(hid_t object, const std::string& name);
[[nodiscard]] std::string read_string(hid_t object, const std::string& name);  ///< Failure if not there or no string
[[nodiscard]] std::int64_t read_integer(hid_t object, const std::string& name);
[[nodiscard]] std::vector<std::string> read_strings(hid_t object, const std::string& name);
[[nodiscard]] std::map<std::string, Attribute> read_attributes(hid_t object);
[[nodiscard]] std::vector<std::string> attribute_names(hid_t object);
/// Reads every text that an attribute holds in a heap, and forgets it.
void read_texts_of_attributes(hid_t object);

/// Names of the links of a group, by name.
[[nodiscard]] std::vector<std::string> children(hid_t group);

}  // namespace verisim::hdf5
