#include "engine/cli/tradeoff_peers.hpp"
#include "engine/base/json.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/own_file.hpp"
#include "engine/base/text.hpp"
#include "engine/session/origin.hpp"
#include "engine/tradeoff/peers.hpp"

namespace verisim::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kName = "verisim-peers";

/// Starts it with its stdout in a pipe. Returns the pipe's end to read from.
int start(const std::string& program, const std::vector<std::string>& options, pid_t& child) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail(ErrorKind::io, "{}: no pipe to it ({})", program, errno);
  std::vector<std::string> words = {program};
  words.insert(words.end(), options.begin(), options.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  const int failure = posix_spawn(&child, program.c_str(), &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (failure == 0) return ends[0];
  ::close(ends[0]);
  fail(ErrorKind::input, "{}: cannot be started ({}); build it again: ninja -C build {}", program,
       std::generic_category().message(failure), kName);
}

/// What it says on stdout, when it has ended well.
std::string said_by(const std::string& program, const std::vector<std::string>& options) {
  pid_t child = -1;
  const int from = start(program, options, child);
  std::string said;
  std::array<char, 65536> buffer{};
  for (ssize_t n = 0; (n = ::read(from, buffer.data(), buffer.size())) != 0;) {
    if (n < 0 && errno != EINTR) break;
    if (n > 0) said.append(buffer.data(), static_cast<std::size_t>(n));
  }
  ::close(from);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status))
    fail(ErrorKind::input, "{}: was ended by signal {}; run it by itself to see why", program, WTERMSIG(status));
  if (WEXITSTATUS(status) != 0)
    fail(ErrorKind::input, "{}: ended with exit code {}; run it by itself to see why", program, WEXITSTATUS(status));
  return said;
}

}  // namespace

std::string peers_program() {
  const fs::path folder = fs::path(own_file()).parent_path();
  std::error_code ignored;
  if (fs::exists(folder / kName, ignored)) return (folder / kName).string();
  fail(ErrorKind::input,
       "--peers: {} is not beside this program (in '{}'); apt install libmujoco-dev libbullet-dev libode-dev "
       "libfcl-dev, then cmake --preset default and ninja -C build {}",
       kName, folder.string(), kName);
}

PeersFound ask_peers(const std::string& program, bool quick, bool quiet) {
  std::vector<std::string> options = {"--json"};
  if (quick) options.emplace_back("--quick");
  if (quiet) options.emplace_back("--quiet");
  const Json said = parse_json_or_discard(said_by(program, options));
  const auto has = [&](const char* key) { return said.is_object() && said.contains(key); };
  if (!has("format") || said["format"] != tradeoff::kPeersFormat || !has("format_version") ||
      said["format_version"] != 1 || !has("peers") || !has("commit") || !said["commit"].is_string())
    fail(ErrorKind::input, "{}: does not say what this program reads; build it again: ninja -C build {}", program,
         kName);
  (void)tradeoff::text_of_peers(said["peers"]);  // an error if it is no such list
  const std::string of = said["commit"].get<std::string>();
  PeersFound found{said["peers"], {}};
  if (of != commit())
    found.note =
        fmt::format("{} was built from commit {}, this program from {}: build both", kName, shown(of, 40), commit());
  return found;
}

}  // namespace verisim::cli
