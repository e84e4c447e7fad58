#include "engine/record/object_walk.hpp"

#include <set>
#include <utility>
#include <vector>

#include "engine/record/hdf5_wrapper.hpp"

namespace verisim {
namespace {

using hdf5::check;
using hdf5::check_status;
using hdf5::Failure;
using hdf5::Handle;

constexpr std::size_t kNestedMax = 64;

/// The hard links of a group, by name.
std::vector<std::string> hard_links(hid_t group, const std::string& path, SoftLinks soft_links) {
  std::vector<std::pair<std::string, H5L_type_t>> links;
  const H5L_iterate_t collect = [](hid_t, const char* name, const H5L_info_t* info, void* into) -> herr_t {
    static_cast<std::vector<std::pair<std::string, H5L_type_t>>*>(into)->emplace_back(name, info->type);
    return 0;
  };
  hsize_t position = 0;
  check_status(H5Literate(group, H5_INDEX_NAME, H5_ITER_NATIVE, &position, collect, &links), "group");
  std::vector<std::string> names;
  for (auto& [name, type] : links) {
    if (type == H5L_TYPE_HARD)
      names.push_back(std::move(name));
    else if (type != H5L_TYPE_SOFT || soft_links == SoftLinks::refused)
      throw Failure(path + name + " is a link to another place");
  }
  return names;
}

/// Bytes that a dataset stores, all of them in this file.
std::uint64_t bytes_of_dataset(hid_t dataset, const std::string& path) {
  const Handle creation(check(H5Dget_create_plist(dataset), path.c_str()), H5Pclose);
  const H5D_layout_t layout = H5Pget_layout(creation);
  if (layout < 0) throw Failure(path + ": no layout");
  if (layout == H5D_VIRTUAL || (layout == H5D_CONTIGUOUS && H5Pget_external_count(creation) != 0))
    throw Failure(path + " keeps its values in another file");
  return H5Dget_storage_size(dataset);
}

class Walk {
 public:
  Walk(hid_t file, std::uint64_t file_bytes, SoftLinks soft_links)
      : file_(file), bytes_left_(file_bytes), soft_links_(soft_links) {}

  void run() {
    visit("/", 0);
    while (!groups_.empty()) {
      const auto [path, depth] = std::move(groups_.back());
      groups_.pop_back();
      if (depth > kNestedMax) throw Failure("groups within groups, more than " + std::to_string(kNestedMax) + " deep");
      const Handle group = hdf5::open_group(file_, path);
      for (const std::string& name : hard_links(group, path, soft_links_)) visit(path + name, depth + 1);
    }
  }

 private:
  void visit(const std::string& path, std::size_t depth) {
    const Handle object(check(H5Oopen(file_, path.c_str(), H5P_DEFAULT), path.c_str()), H5Oclose);
    H5O_info_t info;
    // All: reads every index of the object, also those that only other readers use (a visit in order of creation).
    check_status(H5Oget_info2(object, &info, H5O_INFO_ALL), path.c_str());
    if (!seen_.insert(info.addr).second) throw Failure(path + " is the same object as another: groups in a circle");
    if (info.type == H5O_TYPE_GROUP) groups_.emplace_back(path == "/" ? path : path + "/", depth);
    if (info.type != H5O_TYPE_DATASET) return;
    const std::uint64_t bytes = bytes_of_dataset(object, path);
    if (bytes > bytes_left_) throw Failure("its datasets hold more than the file has bytes");
    bytes_left_ -= bytes;
  }

  hid_t file_;
  std::uint64_t bytes_left_;
  SoftLinks soft_links_;
  std::set<haddr_t> seen_;
  std::vector<std::pair<std::string, std::size_t>> groups_;  ///< still to be looked into, with their depth
};

}  // namespace

void check_objects(hid_t file, std::uint64_t file_bytes, SoftLinks soft_links) {
  Walk(file, file_bytes, soft_links).run();
}

}  // namespace verisim
