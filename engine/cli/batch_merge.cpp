#include "engine/cli/batch_merge.hpp"

#include <cstdio>

#include "engine/base/json.hpp"
#include "engine/batch/folder.hpp"
#include "engine/batch/merge.hpp"
#include "engine/batch/summary.hpp"
#include "engine/cli/batch_output.hpp"
#include "engine/session/stop_watch.hpp"

namespace verisim::cli {

CLI::App* add_merge(CLI::App& batch, MergeOptions& options) {
  auto* merge = batch.add_subcommand("merge", "Joins the folders of shards");
  merge->add_option("OUT", options.out, "Folder to write: new, or empty")->required();
  merge->add_option("SHARD", options.shards, "Folders of the shards")->required();
  merge->add_flag("--json", options.json, "One JSON object on stdout");
  merge->add_flag("--quiet", options.quiet, "No summary");
  merge->footer("Example: verisim batch merge runs/all runs/shard1 runs/shard2");
  return merge;
}

int run_merge(const MergeOptions& o) {
  const StopWatch watch;
  batch::merge(o.out, o.shards, program_version());
  batch::Index index = batch::Index::open(batch::index_of(o.out), program_version());
  const Json manifest = batch::read_manifest(o.out);
  if (!o.quiet || o.json) {
    const batch::Summary summary = batch::summarize(index, manifest.at("groups"), manifest.at("seed"));
    Json json = json_of(index, summary, o.out);
    json["wall_s"] = watch.seconds();
    json["jobs"] = 1;
    std::printf("%s", o.json ? (json_text(json) + "\n").c_str() : table_of(index, summary, o.out).c_str());
  }
  return exit_code_of(index, o.out);
}

}  // namespace verisim::cli
