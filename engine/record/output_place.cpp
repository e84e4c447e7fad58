#include "engine/record/output_place.hpp"

#include <filesystem>

#include "engine/base/error.hpp"
#include "engine/record/file_replace.hpp"
#include "engine/record/hdf5_wrapper.hpp"
#include "engine/record/heap_check.hpp"
#include "engine/record/object_walk.hpp"
#include "engine/record/run_writer.hpp"

namespace verisim {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kHdf5Signature("\x89HDF\r\n\x1a\n", 8);

bool begins_with(const std::string& path, const std::string& beginning) {
  return UserFile(path, path).beginning(beginning.size()) == beginning;
}

/// True if the HDF5 file has such root attributes. A file that a run was killed over has them too.
template <typename Test>
bool hdf5_passes(const std::string& path, Test test) {
  if (!begins_with(path, std::string(kHdf5Signature))) return false;
  const hdf5::Session session;
  try {
    check_text_heaps(path);
    for (const unsigned mode : {H5F_ACC_RDONLY, H5F_ACC_RDONLY | H5F_ACC_SWMR_READ}) {
      const hdf5::Handle file(H5Fopen(path.c_str(), mode, hdf5::reader_access()), H5Fclose);
      if (file >= 0) return test(file);
    }
  } catch (const hdf5::Failure&) {  // damaged: of no kind that can be told
  }
  return false;
}

bool is_run(const std::string& path) {
  return hdf5_passes(path, [](hid_t file) {
    return hdf5::has_attribute(file, "format") &&
           hdf5::read_attribute(file, "format") == Attribute(std::string(kRunFormat));
  });
}

bool is_trace(const std::string& path) {
  if (begins_with(path, "# verisim-trace")) return true;
  return hdf5_passes(path, [](hid_t file) {
    return hdf5::has_attribute(file, "kind") && hdf5::has_attribute(file, "source") && hdf5::exists(file, "t");
  });
}

bool is_of_kind(const std::string& path, const OutputPlace& place) {
  switch (place.kind) {
    case OutputKind::run:
      return is_run(path);
    case OutputKind::trace:
      return is_trace(path);
    case OutputKind::text:
      return begins_with(path, place.beginning);
  }
  return false;
}

const char* name_of(OutputKind kind) {
  switch (kind) {
    case OutputKind::run:
      return "a run file";
    case OutputKind::trace:
      return "a trace";
    case OutputKind::text:
      return "such a table or plot";
  }
  return "";
}

/// What a symbolic link leads to; else the path itself.
std::string end_of_links(const std::string& path) {
  std::error_code error;
  if (!fs::is_symlink(path, error)) return path;
  const fs::path end = fs::canonical(path, error);
  if (error) refuse_write(path, "a symbolic link that leads nowhere: " + error.message());
  return end.string();
}

void check_no_input(const std::string& named, const std::string& path, const std::vector<FileIdentity>& inputs) {
  const std::optional<FileIdentity> there = identity_of(path);
  for (const FileIdentity& input : inputs)
    if (there == input)
      fail(ErrorKind::io, "{}: is an input of this command, which is never replaced; choose another name", named);
}

/// A file that a writer leaves beside its own until it is done: what stands there is a killed one's rest, or is not
/// ours.
void check_rest(const std::string& path, const OutputPlace& place, const std::vector<FileIdentity>& inputs) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(path, error);
  if (!fs::exists(status)) return;
  check_no_input(path, path, inputs);
  if (!fs::is_regular_file(status))
    fail(ErrorKind::io, "{}: is no plain file, and this name is needed while writing; rename it", path);
  const std::uint64_t size = UserFile(path, path).size();
  const bool is_rest = size == 0 || begins_with(path, std::string(kHdf5Signature)) ||
                       begins_with(path, std::string(kHdf5Signature.size(), '\0')) ||  // HDF5 writes its beginning last
                       is_of_kind(path, place);
  if (!is_rest && !place.force)
    fail(ErrorKind::io, "{}: is not of verisim, and this name is needed while writing; rename it, or use --force",
         path);
}

void check_replaceable(const std::string& path, const OutputPlace& place) {
  std::error_code error;
  if (!fs::exists(path, error)) return;
  if (place.force || is_being_written(path)) return;  // a run's writer refuses what another is writing
  bool is_ours = false;
  try {
    is_ours = UserFile(path, path).size() == 0 || is_of_kind(path, place);
  } catch (const Error& unreadable) {
    fail(ErrorKind::io, "{}", unreadable.what());
  }
  if (!is_ours)
    fail(ErrorKind::io, "{}: is not {}, which alone is replaced; choose another name, or use --force", path,
         name_of(place.kind));
}

}  // namespace

std::string check_output(const OutputPlace& place, const std::vector<FileIdentity>& inputs) {
  if (place.path.ends_with('/')) fail(ErrorKind::io, "{}: is a folder; name a file in it", place.path);
  std::string path = end_of_links(place.path);
  const std::string type = other_than_plain(path);
  if (type == "a folder") fail(ErrorKind::io, "{}: is a folder; name a file in it", place.path);
  if (!type.empty()) fail(ErrorKind::io, "{}: is {}, which is never replaced; name a plain file", place.path, type);
  check_no_input(place.path, path, inputs);
  check_replaceable(path, place);
  for (const char* suffix : {".part", ".closing"}) check_rest(path + suffix, place, inputs);
  return path;
}

std::string beginning_of(const std::string& content) {
  const std::string line = content.substr(0, content.find('\n') + 1);
  return line.starts_with("<svg ") ? line.substr(0, line.find("viewBox")) : line;
}

void write_text(const std::string& path, const std::string& content, bool force,
                const std::vector<FileIdentity>& inputs) {
  const OutputPlace place{path, OutputKind::text, force, beginning_of(content)};
  Replacement file(check_output(place, inputs), ".part");
  file.write(content);
  file.commit();
}

}  // namespace verisim
