// Everything that a run reads from outside, in one place: so that a run file can hold all of it and `replay` needs
// nothing else. Live, files are read from disk and models loaded; stored, both come from a run file.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/user_file.hpp"
#include "engine/geometry/cad_client.hpp"
#include "engine/geometry/loader.hpp"
#include "engine/record/prepared_store.hpp"
#include "engine/record/run_file.hpp"

namespace verisim {

class Inputs {
 public:
  /// Reads from disk. Relative names are looked up in `folder`, except those in `named` (files and folders that the
  /// command line named, seen from the current folder). A name that leads outside `folder` (after resolving links) is
  /// refused unless it is one of `named` or below one of them.
  /// Parts that `store` has are taken from there; null: all are made here.
  static Inputs live(const std::string& folder, std::vector<std::string> named,
                     std::shared_ptr<PreparedStore> store = nullptr);
  /// Serves what a run file holds and nothing else.
  static Inputs stored(std::vector<InputFile> files, std::vector<StoredModel> models);

  /// Content of a file, read once. Error(input): not there, not a file, outside the allowed folders (says which is
  /// allowed).
  const std::string& read(const std::string& name);
  /// Is there such a file (and may it be read)? A folder is none; of a FIFO or a device, read() says what it is.
  [[nodiscard]] bool exists(const std::string& name) const;

  /// Parts of a model file, a Solid. Loaded once per (name, options).
  const std::vector<Part>& model(const std::string& name, const LoadOptions& options);
  const Part& solid(const Solid& solid, const LoadOptions& options);
  /// The scene is built: ends the program that made its solids. Another solid starts one anew.
  void end_of_scene() { cad_.reset(); }

  /// What prepares from these inputs may take from there what was prepared before; null: there is none.
  [[nodiscard]] const std::shared_ptr<PreparedStore>& store() const { return store_; }

  /// The files that were opened so far: what a command writes must be none of them.
  [[nodiscard]] const std::vector<FileIdentity>& opened() const { return opened_; }
  /// What was read so far, in order of first use: goes into the run file.
  [[nodiscard]] std::vector<InputFile> files() const;
  [[nodiscard]] std::vector<StoredModel> models() const;

 private:
  bool live_ = true;
  std::string folder_;
  std::vector<std::string> named_;  ///< absolute
  std::shared_ptr<PreparedStore> store_;
  std::shared_ptr<CadSession> cad_;  ///< null until a solid is to be made
  std::vector<FileIdentity> opened_;
  std::vector<std::string> order_;
  std::map<std::string, std::string> contents_;
  std::vector<std::string> model_order_;
  std::map<std::string, std::vector<Part>> parts_;
  std::string resolve(const std::string& name) const;
  /// What `make` makes of what `key` says, taken from the store if it is there.
  std::vector<Part> prepared(const std::string& key, const std::function<std::vector<Part>()>& make);
  const std::vector<Part>& remember(const std::string& key, std::vector<Part> parts);
};

}  // namespace verisim
