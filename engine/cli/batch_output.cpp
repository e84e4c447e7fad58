#include "engine/cli/batch_output.hpp"
#include "engine/base/json.hpp"

#include "engine/base/text.hpp"
#include "engine/cli/streams.hpp"
#include "engine/session/origin.hpp"

namespace verisim::cli {

std::string program_version() {
  return std::string(VERISIM_VERSION) + " (commit " + commit() + ")";
}

Json json_of(batch::Index& index, const batch::Summary& summary, const std::string& folder) {
  Json json = {{"folder", folder}, {"runs", index.runs().size()}};
  for (const char* status : batch::kStatuses) json[status] = index.count(status);
  json["groups"] = to_json(summary);
  return json;
}

std::string table_of(batch::Index& index, const batch::Summary& summary, const std::string& folder) {
  std::string counts;
  for (const char* status : batch::kStatuses)
    if (const std::uint64_t n = index.count(status))
      counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", n, status);
  const std::size_t runs = index.runs().size();
  return fmt::format("{}: {} run{}: {}\n{}", folder, runs, runs == 1 ? "" : "s", counts, batch::table_of(summary));
}

int exit_code_of(batch::Index& index, const std::string& folder) {
  const std::uint64_t undone = index.count_unanswered();
  if (undone == 0) return 0;
  std::string advice = "; verisim batch with the same design and --retry-failed does them again";
  if (index.count_unanswered("timeout") > 0) advice += ", --time-limit gives more time";
  if (index.count_unanswered("memory") > 0) advice += ", --memory-limit gives more memory";
  print_error(fmt::format("{}: {} of {} runs could not be done; the column error of index.csv says why{}", folder,
                          undone, index.runs().size(), advice)
                  .c_str());
  return 1;
}

}  // namespace verisim::cli
