// The folder of a batch: batch.json says which design its index belongs to; one batch at a time writes in it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/base/json.hpp"
#include "engine/record/file_replace.hpp"

namespace verisim::batch {

class Folder {
 public:
  /// Makes the folder or goes on in it. `manifest` is what batch.json holds or has to hold: members of kOfTheMaking may
  /// differ. Error(input): it holds another design, which is named; Error(io): it holds other things, cannot be made,
  /// or another batch writes in it. A
  /// manifest that is half merged begins anew where another such one is.
  Folder(std::string path, const Json& manifest);
  /// The lock alone stays: a name that another process may be waiting for is not taken away.
  ~Folder() = default;
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }
  /// Replaces batch.json. Error(io).
  void write_manifest(const Json& manifest);
  /// runs/000123.h5, below the folder.
  [[nodiscard]] static std::string run_file(std::uint64_t run);

 private:
  std::string path_;
  std::unique_ptr<MarkedFile> lock_;
};

/// The index of a batch's folder: index.sqlite.
[[nodiscard]] std::string index_of(const std::string& folder);

inline constexpr int kManifestFormat = 1;  ///< format_version of batch.json

/// batch.json of a folder. Error(input): there is none, or it is something else.
[[nodiscard]] Json read_any_manifest(const std::string& folder);
/// Likewise, and Error(input) if what makes the folder is a merge that has not ended.
[[nodiscard]] Json read_manifest(const std::string& folder);

/// Members of batch.json: what the times of its runs hang on (conditions.hpp); how many shards were merged.
inline constexpr const char* kComputed = "computed";
inline constexpr const char* kShardsMerged = "shards_merged";
/// What may differ between two manifests of one batch: where and how it was computed.
inline const std::vector<std::string> kOfTheMaking = {"machine", "scenario", kComputed, kShardsMerged};
/// Member of batch.json while shards are merged into its folder.
inline constexpr const char* kMerging = "merging";
[[nodiscard]] bool is_half_merged(const Json& manifest);

/// The first difference of two manifests: "design/vary/clearance/values is [1,2] there and [1,3]
/// here"; empty: none. Members of `ignored` count for nothing.
[[nodiscard]] std::string first_difference(const Json& there, const Json& here,
                                           const std::vector<std::string>& ignored);

}  // namespace verisim::batch
