#include <cstdio>
#include <cstring>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/base/hash.hpp"
#include "engine/cli/commands.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/run_loop.hpp"
#include "engine/cli/session.hpp"
#include "engine/cli/summary.hpp"
#include "engine/contact/query.hpp"

namespace verisim::cli {
namespace {

/// The stored columns of a run that a replay must reproduce: /state and /cost.
class StoredRows {
 public:
  explicit StoredRows(const RunFile& file, const Schema& simulated) : rows_(file.rows()) {
    for (const Column& column : simulated.columns()) {
      const Column* stored = nullptr;
      for (const Column& candidate : file.schema().columns())
        if (candidate.path == column.path) stored = &candidate;
      if (stored == nullptr)
        fail(ErrorKind::check_failed, "{}: is in the simulation and not in the run file", column.path);
      if (stored->dtype != column.dtype || stored->width != column.width)
        fail(ErrorKind::check_failed, "{}: has another shape in the run file", column.path);
      columns_.push_back({column, file.column(*stored), rows_of_frames(column, simulated, file)});
    }
  }
  [[nodiscard]] std::size_t rows() const { return rows_; }

  /// "frame 1201, /state/body/pin/twist[3]: stored 3f68000000000001, simulated 3f68000000000000", or empty.
  [[nodiscard]] std::string first_difference(std::size_t frame, const std::vector<std::byte>& row) const {
    for (const Stored& s : columns_) {
      const std::size_t stored_row = s.row_of_frame.empty() ? frame : s.row_of_frame[frame];
      if (stored_row == kNoRow) continue;
      const std::byte* simulated = row.data() + s.column.offset;
      const std::byte* stored = s.bytes.data() + stored_row * s.column.bytes();
      if (std::memcmp(simulated, stored, s.column.bytes()) == 0) continue;
      return describe(frame, s.column, stored, simulated);
    }
    return {};
  }

 private:
  static constexpr std::size_t kNoRow = static_cast<std::size_t>(-1);
  struct Stored {
    Column column;
    std::vector<std::byte> bytes;
    std::vector<std::size_t> row_of_frame;  ///< empty: every frame has one
  };

  /// Where the values of each frame lie in a column to which not every frame adds a row.
  static std::vector<std::size_t> rows_of_frames(const Column& column, const Schema& simulated, const RunFile& file) {
    std::vector<std::size_t> rows;
    for (const Column& due : simulated.columns()) {
      if (column.due.empty() || due.path != column.due) continue;
      const std::vector<std::byte> counts = file.column(due);
      std::size_t next = 0;
      for (std::size_t at = 0; at < counts.size(); at += sizeof(std::uint32_t)) {
        std::uint32_t count = 0;
        std::memcpy(&count, &counts[at], sizeof count);
        rows.push_back(count != 0 ? next++ : kNoRow);
      }
    }
    return rows;
  }

  static std::string hex(const std::byte* bytes, std::size_t size) {
    std::string text;
    for (std::size_t i = size; i-- > 0;) text += fmt::format("{:02x}", static_cast<unsigned>(bytes[i]));
    return text;
  }
  static std::string describe(std::size_t frame, const Column& column, const std::byte* stored,
                              const std::byte* simulated) {
    const std::size_t size = size_of(column.dtype);
    std::size_t i = 0;
    while (std::memcmp(stored + i * size, simulated + i * size, size) == 0) ++i;
    const std::string index = column.width > 1 ? fmt::format("[{}]", i) : "";
    return fmt::format("frame {}, {}{}: stored {}, simulated {}", frame, column.path, index,
                       hex(stored + i * size, size), hex(simulated + i * size, size));
  }

  std::size_t rows_;
  std::vector<Stored> columns_;
};

void check_contents(const RunFile& file) {
  for (const InputFile& input : file.header().files) {
    if (!input.embedded)
      fail(ErrorKind::input,
           "{} was recorded with --no-embed: its content is not in the run file, so it cannot be replayed", input.name);
    if (sha256(input.content) != input.sha256)
      fail(ErrorKind::check_failed,
           "/inputs/files/{}: its content is not what its sha256 says; the run file is damaged", input.name);
  }
}

std::string stored_hash(const RunFile& file) {
  const auto& attributes = file.header().attributes;
  const auto found = attributes.find("state_hash");
  return found != attributes.end() && std::holds_alternative<std::string>(found->second)
             ? std::get<std::string>(found->second)
             : "";
}

/// The events of a run, one after the other, as recorded.
std::string first_different_event(const std::vector<Event>& stored, const std::vector<Event>& simulated) {
  for (std::size_t i = 0; i < std::max(stored.size(), simulated.size()); ++i) {
    if (i >= stored.size()) return fmt::format("event {}: '{}' is not in the run file", i, simulated[i].text);
    if (i >= simulated.size()) return fmt::format("event {}: '{}' did not happen again", i, stored[i].text);
    const auto cut = [](const std::string& text, std::size_t n) { return text.substr(0, n); };
    if (stored[i].time != simulated[i].time || stored[i].kind != cut(simulated[i].kind, 31) ||
        stored[i].text != cut(simulated[i].text, 223))
      return fmt::format("event {}: stored '{}', simulated '{}'", i, stored[i].text, simulated[i].text);
  }
  return {};
}

int replay(const std::string& path, bool verify, const SimulateOptions& o) {
  use_simd_target(o.simd);
  const RunFile file(path);
  if (file.recovered())
    std::fprintf(stderr, "notice: %s was left open by a killed run and has been closed\n", path.c_str());
  check_contents(file);
  const ScenarioOptions options = options_from_header(file.header());
  auto inputs = std::make_unique<Inputs>(Inputs::stored(file.header().files, file.header().models));
  Session session = open_session(options, std::move(inputs), o.threads, true);
  Simulation& simulation = *session.simulation;

  Schema schema;
  simulation.describe(schema);
  const std::unique_ptr<StoredRows> stored = verify ? std::make_unique<StoredRows>(file, schema) : nullptr;
  std::vector<std::byte> row(schema.row_bytes());
  std::vector<Event> events;
  catch_interrupts();
  for (std::size_t i = 0; i < file.rows(); ++i) {
    simulation.step();
    simulation.write_row(row.data());
    events.insert(events.end(), simulation.events().begin(), simulation.events().end());
    simulation.clear_events();
    if (!verify) continue;
    const std::string difference = stored->first_difference(i, row);
    if (!difference.empty()) fail(ErrorKind::check_failed, "{}: {}", path, difference);
  }
  const std::string hash = to_hex(simulation.state_hash());
  if (verify) {
    const std::string difference = first_different_event(file.events(), events);
    if (!difference.empty()) fail(ErrorKind::check_failed, "{}: {}", path, difference);
    if (!stored_hash(file).empty() && stored_hash(file) != hash)
      fail(ErrorKind::check_failed, "{}: state_hash says {}, simulated {}", path, stored_hash(file), hash);
  }
  if (o.json)
    std::printf("{\"run_file\":\"%s\",\"frames\":%zu,\"state_hash\":\"%s\",\"verified\":%s}\n", path.c_str(),
                file.rows(), hash.c_str(), verify ? "true" : "false");
  else if (!o.quiet)
    std::printf("%s: %zu frames simulated again, state hash %s%s\n", path.c_str(), file.rows(), hash.c_str(),
                verify ? ", every value of /state, /cost and /events equal" : "");
  return 0;
}

}  // namespace

void add_replay(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("replay", "Simulates again from the run file alone");
  auto path = std::make_shared<std::string>();
  auto verify = std::make_shared<bool>(false);
  auto options = std::make_shared<SimulateOptions>();
  command->add_option("RUN.h5", *path, "Run file")->required();
  command->add_flag("--verify", *verify, "Compare every value; name the first frame and field that differ (exit 1)");
  command->add_option("--threads", options->threads, "Threads (same bits for any number)")->check(CLI::Range(1, 256));
  command->add_option("--simd", options->simd, "SIMD target (same bits)");
  command->add_flag("--json", options->json, "One JSON object on stdout");
  command->add_flag("--quiet", options->quiet, "Say nothing");
  command->footer("Example: verisim replay runs/peg_in_hole.h5 --verify");
  command->callback([=, &exit_code] { exit_code = replay(*path, *verify, *options); });
}

}  // namespace verisim::cli
