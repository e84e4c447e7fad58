#include "engine/simulation/inputs.hpp"

#include <algorithm>
#include <filesystem>

#include "engine/base/error.hpp"
#include "engine/base/hash.hpp"
#include "engine/base/user_file.hpp"
#include "engine/geometry/message.hpp"

namespace verisim {
namespace {

namespace fs = std::filesystem;

/// Whole from the root on, also for a file that is not there: weakly_canonical alone leaves that one's name bare.
fs::path from_root(const fs::path& path, std::error_code& error) {
  const fs::path folder = path.is_absolute() ? fs::path() : fs::current_path(error);
  return error ? fs::path() : fs::weakly_canonical(folder / path, error);
}

fs::path from_root(const fs::path& path) {
  std::error_code error;
  if (!path.is_absolute()) (void)fs::current_path(error);
  if (error)
    fail(ErrorKind::input, "the working directory cannot be found ({}); change to another or give whole paths",
         error.message());
  fs::path real = from_root(path, error);
  if (error)
    fail(ErrorKind::input, "{}: cannot be reached ({}); check the links and folders on the way", path.string(),
         error.message());
  return real;
}

bool is_below(const fs::path& path, const fs::path& folder) {
  const auto [at_folder, at_path] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  (void)at_path;
  return at_folder == folder.end() || (std::next(at_folder) == folder.end() && at_folder->empty());
}

void check_is_there(const std::string& name, const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error) && !error)
    fail(ErrorKind::input, "{}: there is no such file in {}; check the name and the folder", name,
         path.parent_path().string());
}

std::string options_key(const LoadOptions& o) {
  return fmt::format("scale={} deflection={} angle={}{}", o.scale, o.deflection, o.angular_deflection,
                     o.recover ? " recover" : "");
}

}  // namespace

Inputs Inputs::live(const std::string& folder, std::vector<std::string> named, std::shared_ptr<PreparedStore> store) {
  Inputs inputs;
  inputs.store_ = std::move(store);
  std::error_code lost;  // the working directory: whole paths of the command line are still good
  (void)fs::current_path(lost);
  if (!lost || fs::path(folder).is_absolute()) inputs.folder_ = from_root(folder.empty() ? "." : folder).string();
  for (const std::string& path : named) inputs.named_.push_back(from_root(path).string());
  return inputs;
}

Inputs Inputs::stored(std::vector<InputFile> files, std::vector<StoredModel> models) {
  Inputs inputs;
  inputs.live_ = false;
  for (InputFile& file : files) {
    inputs.order_.push_back(file.name);
    inputs.contents_[file.name] = std::move(file.content);
  }
  for (StoredModel& model : models) {
    std::vector<Part> parts;
    for (const auto& [name, tables] : model.parts) parts.push_back(from_tables(name, tables));
    inputs.remember(model.key, std::move(parts));
  }
  return inputs;
}

std::string Inputs::resolve(const std::string& name) const {
  // A name from the command line is meant from where the user stands, as a shell completes it.
  std::error_code elsewhere;  // where the user stands may be no place, or lead to none of that name
  const fs::path from_here = from_root(name, elsewhere);
  if (std::find(named_.begin(), named_.end(), from_here.string()) != named_.end()) return from_here.string();
  const fs::path given(name);
  const fs::path path = from_root(given.is_absolute() ? given : fs::path(folder_) / given);
  if (!folder_.empty() && is_below(path, folder_)) return path.string();
  for (const std::string& folder : named_)
    if (is_below(path, folder)) return path.string();
  fail(ErrorKind::input,
       "{}: lies outside the scenario's folder; only that folder and files named on the command line may be read",
       name);
}

bool Inputs::exists(const std::string& name) const {
  if (contents_.count(name) != 0) return true;
  if (!live_) return false;
  try {
    std::error_code error;
    const fs::path path = resolve(name);
    return fs::exists(path, error) && !fs::is_directory(path, error);
  } catch (const Error&) {
    return false;
  }
}

const std::string& Inputs::read(const std::string& name) {
  const auto known = contents_.find(name);
  if (known != contents_.end()) return known->second;
  if (!live_) fail(ErrorKind::input, "{}: is not among the run file's inputs; the run was recorded without it", name);
  const std::string path = resolve(name);
  check_is_there(name, path);
  const UserFile file(name, path);
  std::string content = file.content();
  opened_.push_back(file.identity());
  order_.push_back(name);
  return contents_[name] = std::move(content);
}

const std::vector<Part>& Inputs::remember(const std::string& key, std::vector<Part> parts) {
  model_order_.push_back(key);
  return parts_[key] = std::move(parts);
}

std::vector<Part> Inputs::prepared(const std::string& key, const std::function<std::vector<Part>()>& make) {
  constexpr const char* kKind = "parts";
  if (!store_) return make();
  std::vector<Part> parts;
  if (const std::optional<std::string> bytes = store_->find(kKind, key)) {
    for (const Group& group : decode(*bytes)) parts.push_back(from_tables(group.name, group.tables));
    return parts;
  }
  parts = make();
  Message message;
  for (const Part& part : parts) message.push_back({part.name, to_tables(part)});
  store_->keep(kKind, key, encode(message));
  return parts;
}

const std::vector<Part>& Inputs::model(const std::string& name, const LoadOptions& options) {
  const std::string key = name + " " + options_key(options);
  const auto known = parts_.find(key);
  if (known != parts_.end()) return known->second;
  if (!live_) fail(ErrorKind::input, "{}: is not among the run file's models; the run was recorded without it", name);
  const std::string& content = read(name);
  return remember(key, prepared(key + " " + sha256(content), [&] { return load_model(name, content, options); }));
}

const Part& Inputs::solid(const Solid& solid, const LoadOptions& options) {
  const std::string key = solid.text() + " " + options_key(options);
  const auto known = parts_.find(key);
  if (known != parts_.end()) return known->second.front();
  if (!live_)
    fail(ErrorKind::input, "{}: is not among the run file's solids; the run was recorded without it", solid.text());
  const auto make = [&] {
    if (!cad_) cad_ = std::make_shared<CadSession>();
    return std::vector<Part>{load_solid(solid, options, cad_.get())};
  };
  return remember(key, prepared(key, make)).front();
}

std::vector<InputFile> Inputs::files() const {
  std::vector<InputFile> files;
  for (const std::string& name : order_) {
    const std::string& content = contents_.at(name);
    files.push_back({name, sha256(content), content, true});
  }
  return files;
}

std::vector<StoredModel> Inputs::models() const {
  std::vector<StoredModel> models;
  for (const std::string& key : model_order_) {
    StoredModel model;
    model.key = key;
    for (const Part& part : parts_.at(key)) model.parts.emplace_back(part.name, to_tables(part));
    models.push_back(std::move(model));
  }
  return models;
}

}  // namespace verisim
