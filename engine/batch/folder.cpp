#include "engine/batch/folder.hpp"
#include "engine/base/json.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <filesystem>
#include <functional>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/base/user_file.hpp"

namespace verisim::batch {

namespace {

namespace fs = std::filesystem;

constexpr const char* kManifest = "batch.json";
constexpr const char* kLock = "batch.lock";

std::string leaf_text(const Json& json) {
  return shown(json_text(json), 80);
}

/// Of an array's element: its parameter's name, else its number.
std::string element_name(const Json& element, std::size_t number) {
  if (element.is_object() && element.contains("parameter") && element["parameter"].is_string())
    return element["parameter"].get<std::string>();
  return fmt::format("{}", number);
}

std::string difference(const std::string& path, const Json& there, const Json& here) {
  const auto below = [&](const std::string& name) { return path.empty() ? name : path + "/" + name; };
  if (there == here) return {};
  if (there.is_object() && here.is_object()) {
    for (const auto& [name, value] : there.items()) {
      if (!here.contains(name)) return fmt::format("{} is {} there and not here", below(name), leaf_text(value));
      std::string found = difference(below(name), value, here[name]);
      if (!found.empty()) return found;
    }
    for (const auto& [name, value] : here.items())
      if (!there.contains(name)) return fmt::format("{} is {} here and not there", below(name), leaf_text(value));
    return {};
  }
  const auto has_objects = [](const Json& j) { return j.is_array() && !j.empty() && j[0].is_object(); };
  if (has_objects(there) && has_objects(here) && there.size() == here.size()) {
    for (std::size_t i = 0; i < there.size(); ++i) {
      std::string found = difference(below(element_name(there[i], i)), there[i], here[i]);
      if (!found.empty()) return found;
    }
  }
  return fmt::format("{} is {} there and {} here", path, leaf_text(there), leaf_text(here));
}

void make_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!error && !fs::is_directory(path, error)) error = std::make_error_code(std::errc::not_a_directory);
  if (error) fail(ErrorKind::io, "{}: the folder cannot be made ({}); choose another with -o", path, error.message());
}

/// Who asks SQLite for an index before the batch has made it makes an empty file of its name: that is no other thing.
bool holds_other_things(const std::string& path) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, error))
    if (entry.path() != index_of(path) || entry.file_size(error) != 0) return true;
  return false;
}

/// Its rows would be taken for those of any design.
void refuse_nameless_index(const std::string& path) {
  std::error_code none;
  const std::uintmax_t size = fs::file_size(index_of(path), none);
  if (!none && size > 0)
    fail(ErrorKind::input,
         "{}: has an index and no {}, which says of what design it is; put that back, or name another folder with -o",
         path, kManifest);
}

std::unique_ptr<MarkedFile> lock_of(const std::string& path) {
  // Workers of a batch that was killed this moment hold its lock until they are gone, too.
  constexpr int kTries = 20, kPauseMs = 100;
  const std::string file = path + "/" + kLock;
  for (int i = 0;; ++i) {
    auto lock = std::make_unique<MarkedFile>(file, MarkedFile::Mark::writer);
    if (lock->descriptor() < 0) refuse_write(file, system_cause());
    if (!lock->refused()) return lock;
    if (i == kTries)
      fail(ErrorKind::io, "{}: another batch writes in this folder; wait for it, or name another with -o", path);
    ::poll(nullptr, 0, kPauseMs);
  }
}

/// Of a merge that did not end nothing stays but its manifest, which the next one replaces.
void clear_half_merged(const std::string& folder) {
  const std::string index = index_of(folder);
  for (const std::string& path :
       {index, index + "-wal", index + "-shm", folder + "/index.csv", folder + "/timing.csv", folder + "/runs"}) {
    std::error_code error;
    fs::remove_all(path, error);
    if (error) refuse_write(path, error.message());
  }
}

/// The member that a merge and a summary read of it and that is not as it should be; empty: none.
std::string wrong_member(const Json& json) {
  const auto is_count = [](const Json& j) { return j.is_number_unsigned(); };
  const auto is_text = [](const Json& j) { return j.is_string(); };
  const auto is_object = [](const Json& j) { return j.is_object(); };
  const auto are_texts = [&](const Json& j) { return j.is_array() && std::all_of(j.begin(), j.end(), is_text); };
  const auto is_shard = [](const Json& j) { return j.is_null() || j.is_object(); };
  const std::pair<const char*, std::function<bool(const Json&)>> members[] = {
      {"version", is_text},  {"runs", is_count},  {"seed", is_count},
      {"design", is_object}, {"shard", is_shard}, {"groups", are_texts}};
  for (const auto& [name, is] : members)
    if (!json.contains(name) || !is(json[name])) return name;
  return {};
}

}  // namespace

std::string first_difference(const Json& there, const Json& here, const std::vector<std::string>& ignored) {
  Json a = there, b = here;
  for (Json* manifest : {&a, &b})
    for (const std::string& name : ignored) manifest->erase(name);
  return difference("", a, b);
}

Json read_any_manifest(const std::string& folder) {
  const std::string file = folder + "/" + kManifest;
  if (!identity_of(file))
    fail(ErrorKind::input, "{}: holds no batch ({} is not there); name a folder of verisim batch", folder, kManifest);
  Json json = parse_json_of(file, UserFile(file, file).content(), "move the folder away and run the batch again");
  const bool is_ours = json.is_object() && json.contains("format") && json["format"] == "verisim-batch";
  if (is_ours && json.value("format_version", Json()) != kManifestFormat)
    fail(ErrorKind::input, "{}: is of format {}, this program reads {}; go on with the version that wrote it", file,
         leaf_text(json.value("format_version", Json())), kManifestFormat);
  if (!is_ours)
    fail(ErrorKind::input, "{}: does not say what batch this is; move the folder away and run the batch again", file);
  if (const std::string member = wrong_member(json); !member.empty())
    fail(ErrorKind::input, "{}: '{}' is missing or not what it should be; move the folder away and run the batch again",
         file, member);
  return json;
}

bool is_half_merged(const Json& manifest) {
  return manifest.contains(kMerging);
}

Json read_manifest(const std::string& folder) {
  Json manifest = read_any_manifest(folder);
  if (is_half_merged(manifest))
    fail(ErrorKind::input, "{}: 'batch merge' did not end here; call it again with the same folders", folder);
  return manifest;
}

Folder::Folder(std::string path, const Json& manifest) : path_(std::move(path)) {
  make_folder(path_);
  const std::string file = path_ + "/" + kManifest;
  if (!identity_of(file) && !identity_of(path_ + "/" + kLock) && holds_other_things(path_))
    fail(ErrorKind::io, "{}: holds no batch, but other things; name an empty folder or a new one with -o", path_);
  lock_ = lock_of(path_);
  if (!identity_of(file)) refuse_nameless_index(path_);
  const bool merges_anew = is_half_merged(manifest) && (!identity_of(file) || is_half_merged(read_any_manifest(path_)));
  if (merges_anew) clear_half_merged(path_);
  if (identity_of(file) && !merges_anew) {
    const std::string found = first_difference(read_manifest(path_), manifest, kOfTheMaking);
    if (found.empty()) return;
    if (found.starts_with("version") || found.starts_with("commit") || found.starts_with("format"))
      fail(ErrorKind::input,
           "{}: was made by another version: {}; figures of two versions need not agree: go on with the version that "
           "began, or name another folder with -o",
           path_, found);
    fail(ErrorKind::input, "{}: holds another design: {}; name another folder with -o, or move this one away", path_,
         found);
  }
  write_manifest(manifest);
}

void Folder::write_manifest(const Json& manifest) {
  Replacement replacement(file(kManifest), ".part");
  replacement.write(json_text(manifest, 2) + "\n");
  replacement.commit();
}

std::string index_of(const std::string& folder) {
  return folder + "/index.sqlite";
}

std::string Folder::run_file(std::uint64_t run) {
  return fmt::format("runs/{:06}.h5", run);
}

}  // namespace verisim::batch
