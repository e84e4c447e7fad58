#include "engine/record/hdf5_wrapper.hpp"

#include <cstring>
#include <limits>

#include "engine/base/error.hpp"

#if defined(VERISIM_SANITIZED)
// HDF5 1.10 forgets some memory when it refuses a damaged file; that would hide what this program forgets. The
// sanitizer, with g++ a library of its own, finds these functions only if they are not hidden (engine/CMakeLists.txt).
#define VERISIM_SANITIZER_HOOK extern "C" __attribute__((visibility("default")))
VERISIM_SANITIZER_HOOK const char* __lsan_default_suppressions() {
  return "leak:libhdf5";
}
VERISIM_SANITIZER_HOOK const char* __lsan_default_options() {
  return "print_suppressions=0";
}
#endif

namespace verisim::hdf5 {
namespace {

std::mutex& library_mutex() {
  static std::mutex mutex;
  return mutex;
}

// HDF5 reports the system's reason inside a sentence: "... errno = 28, error message = 'No space left on device', buf
// ...".
herr_t find_cause(unsigned, const H5E_error2_t* error, void* cause) {
  const std::string text = error->desc != nullptr ? error->desc : "";
  const std::string mark = "error message = '";
  auto& found = *static_cast<std::string*>(cause);
  const auto from = text.find(mark);
  if (from != std::string::npos) {
    const auto start = from + mark.size();
    found = text.substr(start, text.find('\'', start) - start);
  } else if (found.empty()) {
    found = text;  // the innermost sentence, if the system gave no reason
  }
  return 0;
}

Handle string_type(std::size_t size) {
  Handle type(check(H5Tcopy(H5T_C_S1), "string type"), H5Tclose);
  check_status(H5Tset_size(type, size), "string length");
  check_status(H5Tset_cset(type, H5T_CSET_UTF8), "string encoding");
  return type;
}

Handle simple_space(const Shape& shape) {
  if (shape.empty()) return {check(H5Screate(H5S_SCALAR), "shape"), H5Sclose};
  return {check(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), "shape"), H5Sclose};
}

void write_typed(hid_t object, const std::string& name, hid_t stored, hid_t memory, const Shape& shape,
                 const void* value) {
  const Handle space = simple_space(shape);
  const Handle attribute(check(H5Acreate2(object, name.c_str(), stored, space, H5P_DEFAULT, H5P_DEFAULT), name.c_str()),
                         H5Aclose);
  check_status(H5Awrite(attribute, memory, value), name.c_str());
}

std::string trimmed(std::string text) {
  const auto end = text.find('\0');
  if (end != std::string::npos) text.resize(end);
  return text;
}

// All elements of a string attribute, whether their length is fixed or not.
std::vector<std::string> string_elements(hid_t attribute, hid_t type, std::size_t count) {
  std::vector<std::string> values;
  if (H5Tis_variable_str(type) > 0) {
    std::vector<char*> pointers(count, nullptr);
    const Handle memory = string_type(H5T_VARIABLE);
    check_status(H5Aread(attribute, memory, pointers.data()), "text attribute");
    for (char* p : pointers) {
      values.emplace_back(p != nullptr ? p : "");
      H5free_memory(p);
    }
    return values;
  }
  const std::size_t size = H5Tget_size(type);
  std::string bytes(size * count, '\0');
  check_status(H5Aread(attribute, type, bytes.data()), "text attribute");
  for (std::size_t i = 0; i < count; ++i) values.push_back(trimmed(bytes.substr(i * size, size)));
  return values;
}

struct OpenAttribute {
  Handle id, type, space;
  std::size_t count = 0;
};

OpenAttribute open_attribute(hid_t object, const std::string& name) {
  OpenAttribute a;
  a.id = Handle(check(H5Aopen(object, name.c_str(), H5P_DEFAULT), name.c_str()), H5Aclose);
  a.type = Handle(check(H5Aget_type(a.id), name.c_str()), H5Tclose);
  a.space = Handle(check(H5Aget_space(a.id), name.c_str()), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(a.space);
  if (count < 0 || static_cast<hsize_t>(count) > H5Aget_storage_size(a.id)) throw Failure(name + ": damaged attribute");
  a.count = static_cast<std::size_t>(count);
  return a;
}

}  // namespace

Session::Session() : lock_(library_mutex()) {
  // Files are closed by their owners. A file that the disk refused cannot be closed, and HDF5's own clean-up at exit
  // would then retry and complain on the terminal.
  static const herr_t no_exit_handler = H5dont_atexit();
  static_cast<void>(no_exit_handler);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // per thread in a thread-safe build
}

hid_t check(hid_t result, const char* what) {
  if (result >= 0) return result;
  std::string cause;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, find_cause, &cause);
  H5Eclear2(H5E_DEFAULT);
  throw Failure(cause.empty() ? std::string(what) : cause);
}

Handle file_access() {
  Handle list(check(H5Pcreate(H5P_FILE_ACCESS), "access"), H5Pclose);
  check_status(H5Pset_libver_bounds(list, H5F_LIBVER_V110, H5F_LIBVER_V110), "format");
  check_status(H5Pset_fclose_degree(list, H5F_CLOSE_STRONG), "access");
  check_status(H5Pset_file_locking(list, true, true), "locking");
  return list;
}

Handle reader_access() {
  Handle list = file_access();
  check_status(H5Pset_fclose_degree(list, H5F_CLOSE_DEFAULT), "access");
  return list;
}

Handle writer_access() {
  Handle list = file_access();
  H5AC_cache_config_t cache;
  cache.version = H5AC__CURR_CACHE_CONFIG_VERSION;
  check_status(H5Pget_mdc_config(list, &cache), "cache");
  cache.evictions_enabled = false;  // which asks that nothing resizes the cache
  cache.incr_mode = H5C_incr__off;
  cache.flash_incr_mode = H5C_flash_incr__off;
  cache.decr_mode = H5C_decr__off;
  check_status(H5Pset_mdc_config(list, &cache), "cache");
  return list;
}

namespace {

/// Keeps all links of a group in its header, which has a checksum. The heap that many links would go to has none, and
/// HDF5 1.10 frees what it finds there in a damaged file.
void keep_links_in_header(const Handle& creation) {
  check_status(H5Pset_link_phase_change(creation, 0xffff, 0xffff), "links");
}

Handle file_creation() {
  Handle list(check(H5Pcreate(H5P_FILE_CREATE), "creation"), H5Pclose);
  check_status(H5Pset_obj_track_times(list, false), "times");
  // The system's cache is written page by page, so kill -9 tears what lies across two of its pages. In a file with
  // pages of its own no index block does that unless it is larger than one.
  constexpr hsize_t kPage = 4096;  // bytes, of the system
  check_status(H5Pset_file_space_strategy(list, H5F_FSPACE_STRATEGY_PAGE, false, 1), "pages");
  check_status(H5Pset_file_space_page_size(list, kPage), "pages");
  check_status(H5Pset_link_creation_order(list, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED), "order");
  keep_links_in_header(list);
  return list;
}

Handle link_creation() {
  Handle list(check(H5Pcreate(H5P_LINK_CREATE), "links"), H5Pclose);
  check_status(H5Pset_char_encoding(list, H5T_CSET_UTF8), "links");
  return list;
}

/// Creates the groups on the way to `path` that are missing. HDF5 would, but as its default says: with times, and with
/// a heap for many links.
void make_way(hid_t location, const std::string& path) {
  for (std::size_t at = path.find('/', 1); at != std::string::npos; at = path.find('/', at + 1)) {
    const std::string group = path.substr(0, at);
    if (!exists(location, group)) static_cast<void>(create_group(location, group));
  }
}

/// HDF5's own default for groups, without times as long as this lives. A file with pages has an object header that HDF5
/// makes from it, whatever the file's list says: its times would make equal content differ by the second.
class GroupsWithoutTimes {
 public:
  GroupsWithoutTimes() {
    check_status(H5Pget_obj_track_times(H5P_GROUP_CREATE_DEFAULT, &before_), "times");
    check_status(H5Pset_obj_track_times(H5P_GROUP_CREATE_DEFAULT, false), "times");
  }
  ~GroupsWithoutTimes() { H5Pset_obj_track_times(H5P_GROUP_CREATE_DEFAULT, before_); }
  GroupsWithoutTimes(const GroupsWithoutTimes&) = delete;
  GroupsWithoutTimes& operator=(const GroupsWithoutTimes&) = delete;

 private:
  hbool_t before_ = true;
};

}  // namespace

Handle create_file(const std::string& path) {
  const GroupsWithoutTimes no_times;
  return {check(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, file_creation(), file_access()), path.c_str()), H5Fclose};
}

Handle open_group(hid_t location, const std::string& path) {
  return {check(H5Gopen2(location, path.c_str(), H5P_DEFAULT), path.c_str()), H5Gclose};
}

Handle create_group(hid_t location, const std::string& path) {
  make_way(location, path);
  const Handle links = link_creation();
  const Handle creation(check(H5Pcreate(H5P_GROUP_CREATE), "group"), H5Pclose);
  check_status(H5Pset_obj_track_times(creation, false), "times");
  keep_links_in_header(creation);
  return {check(H5Gcreate2(location, path.c_str(), links, creation, H5P_DEFAULT), path.c_str()), H5Gclose};
}

Handle create_dataset(hid_t location, const std::string& path, hid_t type, hid_t space, hid_t creation) {
  make_way(location, path);
  const Handle links = link_creation();
  check_status(H5Pset_obj_track_times(creation, false), "times");
  return {check(H5Dcreate2(location, path.c_str(), type, space, links, creation, H5P_DEFAULT), path.c_str()), H5Dclose};
}

Handle open_dataset(hid_t location, const std::string& path) {
  return {check(H5Dopen2(location, path.c_str(), H5P_DEFAULT), path.c_str()), H5Dclose};
}

bool exists(hid_t location, const std::string& name) {
  return H5Lexists(location, name.c_str(), H5P_DEFAULT) > 0;
}

hid_t stored_type(Dtype dtype) {
  switch (dtype) {
    case Dtype::f64:
      return H5T_IEEE_F64LE;
    case Dtype::f32:
      return H5T_IEEE_F32LE;
    case Dtype::u64:
      return H5T_STD_U64LE;
    case Dtype::u32:
      return H5T_STD_U32LE;
    case Dtype::u16:
      return H5T_STD_U16LE;
    case Dtype::u8:
      return H5T_STD_U8LE;
    case Dtype::i32:
      return H5T_STD_I32LE;
    case Dtype::i8:
      return H5T_STD_I8LE;
  }
  return -1;
}

hid_t memory_type(Dtype dtype) {
  switch (dtype) {
    case Dtype::f64:
      return H5T_NATIVE_DOUBLE;
    case Dtype::f32:
      return H5T_NATIVE_FLOAT;
    case Dtype::u64:
      return H5T_NATIVE_UINT64;
    case Dtype::u32:
      return H5T_NATIVE_UINT32;
    case Dtype::u16:
      return H5T_NATIVE_UINT16;
    case Dtype::u8:
      return H5T_NATIVE_UINT8;
    case Dtype::i32:
      return H5T_NATIVE_INT32;
    case Dtype::i8:
      return H5T_NATIVE_INT8;
  }
  return -1;
}

Dtype dtype_of_stored(hid_t type) {
  for (const Dtype d : {Dtype::f64, Dtype::f32, Dtype::u64, Dtype::u32, Dtype::u16, Dtype::u8, Dtype::i32, Dtype::i8}) {
    if (H5Tequal(type, stored_type(d)) > 0) return d;
  }
  throw Failure("a number type that this program does not write");
}

Shape unchecked_shape(hid_t dataset) {
  const Handle space(check(H5Dget_space(dataset), "shape"), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0 || rank > H5S_MAX_RANK) throw Failure("damaged shape");
  Shape shape(static_cast<std::size_t>(rank));
  check_status(H5Sget_simple_extent_dims(space, shape.data(), nullptr), "shape");
  return shape;
}

Shape checked_shape(hid_t dataset, std::size_t element_bytes) {
  Shape shape = unchecked_shape(dataset);
  const hsize_t stored = H5Dget_storage_size(dataset) / element_bytes;
  hsize_t elements = 1;
  for (const hsize_t n : shape) {
    if (n != 0 && elements > stored / n) throw Failure("a dataset claims more values than it holds");
    elements *= n;
  }
  return shape;
}

Handle write_array(hid_t location, const std::string& path, Dtype dtype, const Shape& shape, const void* data,
                   const std::string& units, const std::string& description) {
  const Handle creation(check(H5Pcreate(H5P_DATASET_CREATE), "dataset"), H5Pclose);
  const Handle space = simple_space(shape);
  Handle dataset = create_dataset(location, path, stored_type(dtype), space, creation);
  if (H5Sget_simple_extent_npoints(space) > 0) {
    VERISIM_ASSERT(data != nullptr);
    check_status(H5Dwrite(dataset, memory_type(dtype), H5S_ALL, H5S_ALL, H5P_DEFAULT, data), path.c_str());
  }
  write_attribute(dataset, "units", units);
  write_attribute(dataset, "description", description);
  return dataset;
}

void write_attribute(hid_t object, const std::string& name, const Attribute& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    const Handle type = string_type(H5T_VARIABLE);
    const char* pointer = text->c_str();
    write_typed(object, name, type, type, {}, &pointer);
  } else if (const auto* number = std::get_if<double>(&value)) {
    write_typed(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {}, number);
  } else if (const auto* large = std::get_if<std::uint64_t>(&value)) {
    write_typed(object, name, H5T_STD_U64LE, H5T_NATIVE_UINT64, {}, large);
  } else {
    write_typed(object, name, H5T_STD_I64LE, H5T_NATIVE_INT64, {}, &std::get<std::int64_t>(value));
  }
}

void write_attribute(hid_t object, const std::string& name, const std::vector<std::string>& values) {
  const Handle type = string_type(H5T_VARIABLE);
  std::vector<const char*> pointers;
  for (const std::string& value : values) pointers.push_back(value.c_str());
  write_typed(object, name, type, type, {values.size()}, pointers.data());
}

bool has_attribute(hid_t object, const std::string& name) {
  return H5Aexists(object, name.c_str()) > 0;
}

Attribute read_attribute(hid_t object, const std::string& name) {
  const OpenAttribute a = open_attribute(object, name);
  if (a.count != 1) throw Failure("attribute '" + name + "' is not a single value");
  switch (H5Tget_class(a.type)) {
    case H5T_STRING:
      return string_elements(a.id, a.type, 1).front();
    case H5T_FLOAT: {
      double value = 0;
      check_status(H5Aread(a.id, H5T_NATIVE_DOUBLE, &value), name.c_str());
      return value;
    }
    case H5T_INTEGER: {
      std::uint64_t large = 0;
      check_status(H5Aread(a.id, H5T_NATIVE_UINT64, &large), name.c_str());  // what is negative becomes 0
      if (large > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) return large;
      std::int64_t value = 0;
      check_status(H5Aread(a.id, H5T_NATIVE_INT64, &value), name.c_str());
      return value;
    }
    default:
      throw Failure("attribute '" + name + "' is neither text nor number");
  }
}

std::string read_string(hid_t object, const std::string& name) {
  const Attribute value = read_attribute(object, name);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  throw Failure("attribute '" + name + "' is not text");
}

std::int64_t read_integer(hid_t object, const std::string& name) {
  const Attribute value = read_attribute(object, name);
  if (const auto* number = std::get_if<std::int64_t>(&value)) return *number;
  throw Failure("attribute '" + name + "' is not a whole number");
}

std::vector<std::string> read_strings(hid_t object, const std::string& name) {
  const OpenAttribute a = open_attribute(object, name);
  if (H5Tget_class(a.type) != H5T_STRING) throw Failure("attribute '" + name + "' is not text");
  return string_elements(a.id, a.type, a.count);
}

std::vector<std::string> attribute_names(hid_t object) {
  std::vector<std::string> names;
  const H5A_operator2_t collect = [](hid_t, const char* name, const H5A_info_t*, void* into) -> herr_t {
    static_cast<std::vector<std::string>*>(into)->emplace_back(name);
    return 0;
  };
  hsize_t position = 0;
  check_status(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, &position, collect, &names), "attributes");
  return names;
}

std::map<std::string, Attribute> read_attributes(hid_t object) {
  std::map<std::string, Attribute> attributes;
  for (const std::string& name : attribute_names(object)) attributes.emplace(name, read_attribute(object, name));
  return attributes;
}

void read_texts_of_attributes(hid_t object) {
  for (const std::string& name : attribute_names(object)) {
    const OpenAttribute a = open_attribute(object, name);
    if (H5Tget_class(a.type) == H5T_STRING && H5Tis_variable_str(a.type) > 0)
      static_cast<void>(string_elements(a.id, a.type, a.count));
  }
}

std::vector<std::string> children(hid_t group) {
  std::vector<std::string> names;
  const H5L_iterate_t collect = [](hid_t, const char* name, const H5L_info_t*, void* into) -> herr_t {
    static_cast<std::vector<std::string>*>(into)->emplace_back(name);
    return 0;
  };
  hsize_t position = 0;
  check_status(H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, &position, collect, &names), "group");
  return names;
}

}  // namespace verisim::hdf5
