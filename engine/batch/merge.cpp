#include "engine/batch/merge.hpp"
#include "engine/base/json.hpp"

#include <algorithm>
#include <filesystem>

#include "engine/base/error.hpp"
#include "engine/base/user_file.hpp"
#include "engine/batch/conditions.hpp"
#include "engine/batch/design_text.hpp"
#include "engine/batch/folder.hpp"
#include "engine/batch/index.hpp"

namespace verisim::batch {

namespace {

namespace fs = std::filesystem;

/// Error(input) if a run of 0 … all - 1 is in no shard, or in two.
void check_runs(const std::vector<std::string>& shards, std::uint64_t all, const std::string& version) {
  std::vector<std::uint8_t> found(all, 0);
  std::vector<std::uint64_t> missing, doubled;
  for (const std::string& shard : shards)
    for (const std::uint64_t run : Index::open(index_of(shard), version).runs()) {
      if (run >= all)
        fail(ErrorKind::input, "{}: has a run {}, and its design ends before; run the shard again", shard, run);
      if (++found[run] == 2) doubled.push_back(run);
    }
  for (std::uint64_t run = 0; run < all; ++run)
    if (found[run] == 0) missing.push_back(run);
  std::sort(doubled.begin(), doubled.end());
  if (!missing.empty())
    fail(ErrorKind::input,
         "runs are missing: {} of {}: {}; run or name the shard that they belong to (run modulo shards)",
         missing.size(), all, ranges_text(missing));
  if (!doubled.empty())
    fail(ErrorKind::input, "runs are there twice: {}: {}; name each shard once", doubled.size(), ranges_text(doubled));
}

void copy_run_files(const std::string& from, const std::string& to, const std::vector<std::uint64_t>& runs) {
  std::error_code error;
  if (!fs::is_directory(fs::path(from) / "runs", error)) return;
  fs::create_directories(fs::path(to) / "runs", error);
  for (const std::uint64_t run : runs) {
    const std::string name = Folder::run_file(run);
    if (!identity_of(from + "/" + name)) continue;
    fs::copy_file(from + "/" + name, to + "/" + name, fs::copy_options::overwrite_existing, error);
    if (error) refuse_write(to + "/" + name, error.message());
  }
}

}  // namespace

void merge(const std::string& out, const std::vector<std::string>& shards, const std::string& version) {
  Json manifest = read_manifest(shards.front());
  std::vector<std::string> ignored = kOfTheMaking;
  ignored.emplace_back("shard");
  for (const std::string& shard : shards) {
    const std::string found = first_difference(manifest, read_manifest(shard), ignored);
    if (!found.empty())
      fail(ErrorKind::input, "{} and {} are no shards of one batch: {}", shards.front(), shard, found);
  }
  check_runs(shards, manifest.at("runs").get<std::uint64_t>(), version);
  manifest["shard"] = nullptr;
  manifest.erase(kComputed);
  manifest[kShardsMerged] = shards.size();
  if (identity_of(out + "/batch.json") && !is_half_merged(read_any_manifest(out)))
    fail(ErrorKind::input, "{}: holds a batch already; name a new folder to merge into", out);
  Json unfinished = manifest;
  unfinished[kMerging] = true;
  Folder folder(out, unfinished);
  Index index(index_of(out), Index::open(index_of(shards.front()), version).layout(), version);
  for (const std::string& shard : shards) {
    index.take_over(index_of(shard));
    copy_run_files(shard, out, Index::open(index_of(shard), version).runs());
  }
  index.write_csv(out);
  manifest[kComputed] = conditions_json(index);
  folder.write_manifest(manifest);
}

}  // namespace verisim::batch
