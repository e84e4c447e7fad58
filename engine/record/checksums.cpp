#include "engine/record/checksums.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "engine/base/hash.hpp"
#include "engine/record/hdf5_wrapper.hpp"

namespace verisim {
namespace {

using hdf5::check;
using hdf5::check_status;
using hdf5::Handle;

/// One value after the other into one hash.
class Checksum {
 public:
  void add(const void* bytes, std::size_t size) { hash_ = hash_bytes(bytes, size, hash_); }
  void add(std::uint64_t number) { add(&number, sizeof number); }
  void add(const std::string& text) {
    add(text.size());  // so that "ab", "c" is not "a", "bc"
    add(text.data(), text.size());
  }
  [[nodiscard]] std::string hex() const { return to_hex(hash_); }

 private:
  std::uint64_t hash_ = 0;
};

std::string member_name(hid_t type, unsigned i) {
  char* const name = H5Tget_member_name(type, i);
  if (name == nullptr) throw hdf5::Failure("a member without a name");
  std::string text = name;
  H5free_memory(name);
  return text;
}

void add_type(Checksum& sum, hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  sum.add(static_cast<std::uint64_t>(kind));
  const bool in_heap = kind == H5T_VLEN || H5Tis_variable_str(type) > 0;
  sum.add(in_heap ? 0 : H5Tget_size(type));
  if (kind == H5T_INTEGER) sum.add(static_cast<std::uint64_t>(H5Tget_sign(type)));
  if (kind != H5T_ENUM && kind != H5T_COMPOUND) return;
  const int members = H5Tget_nmembers(type);
  for (unsigned i = 0; i < static_cast<unsigned>(std::max(0, members)); ++i) {
    sum.add(member_name(type, i));
    if (kind == H5T_COMPOUND) {
      add_type(sum, Handle(check(H5Tget_member_type(type, i), "member"), H5Tclose));
      continue;
    }
    std::vector<char> value(H5Tget_size(type));
    check_status(H5Tget_member_value(type, i, value.data()), "enum");
    sum.add(value.data(), value.size());
  }
}

hdf5::Shape shape_of(hid_t space) {
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0 || rank > H5S_MAX_RANK) throw hdf5::Failure("damaged shape");
  hdf5::Shape shape(static_cast<std::size_t>(rank));
  check_status(H5Sget_simple_extent_dims(space, shape.data(), nullptr), "shape");
  return shape;
}

void add_attribute(Checksum& sum, hid_t object, const std::string& name) {
  const Handle id(check(H5Aopen(object, name.c_str(), H5P_DEFAULT), name.c_str()), H5Aclose);
  const Handle type(check(H5Aget_type(id), name.c_str()), H5Tclose);
  add_type(sum, type);
  for (const hsize_t n : shape_of(Handle(check(H5Aget_space(id), name.c_str()), H5Sclose))) sum.add(n);
  switch (H5Tget_class(type)) {
    case H5T_STRING:
      for (const std::string& text : hdf5::read_strings(object, name)) sum.add(text);
      break;
    case H5T_INTEGER:
    case H5T_FLOAT: {
      std::vector<char> value(H5Aget_storage_size(id));
      check_status(H5Aread(id, type, value.data()), name.c_str());
      sum.add(value.data(), value.size());
      break;
    }
    default:  // no program of ours writes one
      break;
  }
}

/// In pieces of some megabytes, as they are stored.
void add_values(Checksum& sum, hid_t dataset, hid_t type, const hdf5::Shape& shape) {
  const std::size_t element = H5Tget_size(type);
  std::size_t row_bytes = element;
  for (std::size_t i = 1; i < shape.size(); ++i) row_bytes *= shape[i];
  const hsize_t rows = shape.empty() ? 1 : shape[0];
  if (rows == 0 || row_bytes == 0) return;
  const Handle space(check(H5Dget_space(dataset), "shape"), H5Sclose);
  const hsize_t at_once = std::max<hsize_t>(1, (hsize_t{4} << 20) / row_bytes);
  std::vector<char> bytes(std::min(rows, at_once) * row_bytes);
  for (hsize_t from = 0; from < rows; from += at_once) {
    hdf5::Shape start(shape.size(), 0), block = shape;
    if (!shape.empty()) {
      start[0] = from;
      block[0] = std::min(at_once, rows - from);
      check_status(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr), "rows");
    }
    const Handle memory(shape.empty()
                            ? check(H5Screate(H5S_SCALAR), "shape")
                            : check(H5Screate_simple(static_cast<int>(block.size()), block.data(), nullptr), "shape"),
                        H5Sclose);
    check_status(H5Dread(dataset, type, memory, space, H5P_DEFAULT, bytes.data()), "values");
    sum.add(bytes.data(), (shape.empty() ? 1 : block[0]) * row_bytes);
  }
}

bool is_computed_again(const std::string& path) {
  return path.starts_with("/state/") || path.starts_with("/cost/") || path == "/events";
}

class Listing {
 public:
  [[nodiscard]] std::string text() const { return text_; }

  void group(hid_t id, const std::string& path) {
    H5O_info_t info;
    check_status(H5Oget_info2(id, &info, H5O_INFO_BASIC), path.c_str());
    if (!groups_.insert(info.addr).second) return line({}, path + " (again)");
    if (path.empty() || path == "/summary") {
      each_attribute(id, path.empty() ? "/" : path);
    } else {
      Checksum sum;
      attributes(sum, id);
      line(sum, path);
    }
    for (const std::string& name : hdf5::children(id)) child(id, path, name);
  }

 private:
  std::string text_;
  std::set<haddr_t> groups_;

  void line(const Checksum& sum, const std::string& what) { text_ += sum.hex() + "  " + what + "\n"; }

  void each_attribute(hid_t id, const std::string& path) {
    for (const std::string& name : hdf5::attribute_names(id)) {
      if (name == kChecksums && path == "/") continue;
      Checksum sum;
      add_attribute(sum, id, name);
      line(sum, "attribute '" + name + "' of " + path);
    }
  }

  static void attributes(Checksum& sum, hid_t id) {
    for (const std::string& name : hdf5::attribute_names(id)) {
      sum.add(name);
      add_attribute(sum, id, name);
    }
  }

  void child(hid_t id, const std::string& parent, const std::string& name) {
    const std::string path = parent + "/" + name;
    H5L_info_t link;
    check_status(H5Lget_info(id, name.c_str(), &link, H5P_DEFAULT), path.c_str());
    Checksum sum;
    if (link.type != H5L_TYPE_HARD) return line(sum, path + " (a link)");
    const Handle object(check(H5Oopen(id, name.c_str(), H5P_DEFAULT), path.c_str()), H5Oclose);
    switch (H5Iget_type(object)) {
      case H5I_GROUP:
        return group(object, path);
      case H5I_DATASET:
        dataset(sum, object, path);
        return line(sum, path);
      default:
        return line(sum, path + " (a type)");
    }
  }

  static void dataset(Checksum& sum, hid_t id, const std::string& path) {
    const Handle type(check(H5Dget_type(id), path.c_str()), H5Tclose);
    const bool values = !is_computed_again(path);
    const hdf5::Shape shape =
        values ? hdf5::checked_shape(id, std::max<std::size_t>(1, H5Tget_size(type))) : hdf5::unchecked_shape(id);
    add_type(sum, type);
    for (const hsize_t n : shape) sum.add(n);
    attributes(sum, id);
    const bool in_heap = H5Tdetect_class(type, H5T_VLEN) > 0 || H5Tis_variable_str(type) > 0;
    if (values && !in_heap) add_values(sum, id, type, shape);
  }
};

/// What each line is of, and its sum.
std::map<std::string, std::string> lines_of(const std::string& text) {
  std::map<std::string, std::string> lines;
  constexpr std::size_t kSum = 16, kGap = 2;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);)
    lines[line.size() > kSum + kGap ? line.substr(kSum + kGap) : line] = line.substr(0, kSum);
  return lines;
}

}  // namespace

std::string checksums_of(hid_t file) {
  Listing listing;
  listing.group(hdf5::open_group(file, "/"), "");
  return listing.text();
}

void write_checksums(hid_t file) {
  const std::string text = checksums_of(file);
  if (hdf5::has_attribute(file, kChecksums)) check_status(H5Adelete(file, kChecksums), kChecksums);
  hdf5::write_attribute(file, kChecksums, text);
}

std::vector<std::string> altered(const std::string& stored, const std::string& now) {
  if (stored == now) return {};
  const std::map<std::string, std::string> before = lines_of(stored), after = lines_of(now);
  std::vector<std::string> found;
  for (const auto& [what, sum] : after) {
    const auto at = before.find(what);
    if (at == before.end())
      found.push_back(what + ": was added");
    else if (at->second != sum)
      found.push_back(what + ": is not what was recorded");
  }
  for (const auto& [what, sum] : before)
    if (after.count(what) == 0) found.push_back(what + ": is missing");
  if (found.empty()) found.push_back(std::string("attribute '") + kChecksums + "' of /: is damaged");
  return found;
}

}  // namespace verisim
