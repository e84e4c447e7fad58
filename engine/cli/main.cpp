#include <csignal>
#include <cstdio>
#include <new>

#include "engine/base/error.hpp"
#include "engine/cli/commands.hpp"

namespace {

/// Runs the chosen command. Whatever goes wrong ends in one line on stderr and the promised exit code.
int run_command(int argc, char** argv) {
  CLI::App app{"verisim: haptic virtual assembly, simulated one millisecond at a time, without a window"};
  app.set_version_flag("--version", VERISIM_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Example: verisim run scenarios/peg_in_hole.lua --set clearance=mm(2)\nverisim COMMAND --help explains each.");
  int exit_code = 0;
  verisim::cli::add_run(app, exit_code);
  verisim::cli::add_replay(app, exit_code);
  verisim::cli::add_recover(app, exit_code);
  verisim::cli::add_inspect(app, exit_code);
  verisim::cli::add_trace(app, exit_code);
  verisim::cli::add_wii(app, exit_code);
  verisim::cli::add_reproduce(app, exit_code);
  verisim::cli::add_doctor(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    return app.exit(done);  // --help, --version
  } catch (const CLI::ParseError& wrong) {
    std::fprintf(stderr, "error: %s; see verisim --help\n", wrong.what());
    return static_cast<int>(verisim::ErrorKind::usage);
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is a failed write, not a death
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return run_command(argc, argv);
  } catch (const verisim::Error& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return error.exit_code();
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "error: out of memory; use larger voxels or fewer parts\n");
    return static_cast<int>(verisim::ErrorKind::input);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return static_cast<int>(verisim::ErrorKind::input);
  }
}
