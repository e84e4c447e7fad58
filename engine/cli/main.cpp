#include <algorithm>
#include <csignal>
#include <cstdio>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>

#include "engine/base/error.hpp"
#include "engine/base/standard_streams.hpp"
#include "engine/base/text.hpp"
#include "engine/cli/commands.hpp"
#include "engine/cli/memory_wanted.hpp"
#include "engine/cli/streams.hpp"
#include "engine/session/interrupts.hpp"
#include "engine/session/memory_use.hpp"

namespace {

/// Arguments end in the run file, in JSON and in messages: each is one line of UTF-8.
void check_arguments(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string fault = verisim::line_fault(argv[i]);
    if (!fault.empty())
      verisim::fail(verisim::ErrorKind::usage, "argument {} {}: '{}'; write it as one line of UTF-8", i, fault,
                    verisim::shown(argv[i], 60));
  }
}

/// Runs the chosen command. Whatever goes wrong ends in one line on stderr and the promised exit code.
int run_command(int argc, char** argv) {
  CLI::App app{"verisim: haptic virtual assembly, simulated one millisecond at a time, without a window"};
  app.set_version_flag("--version", VERISIM_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Example: verisim run scenarios/peg_in_hole.lua --set clearance=2mm\nverisim COMMAND --help explains each.");
  int exit_code = 0;
  verisim::cli::add_run(app, exit_code);
  verisim::cli::add_batch(app, exit_code);
  verisim::cli::add_replay(app, exit_code);
  verisim::cli::add_recover(app, exit_code);
  verisim::cli::add_inspect(app, exit_code);
  verisim::cli::add_trace(app, exit_code);
  verisim::cli::add_wii(app, exit_code);
  verisim::cli::add_robot(app, exit_code);
  verisim::cli::add_compare(app, exit_code);
  verisim::cli::add_stability(app, exit_code);
  verisim::cli::add_tradeoff(app, exit_code);
  verisim::cli::add_reproduce(app, exit_code);
  verisim::cli::add_doctor(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    std::ostringstream text;  // --help, --version
    const int done_code = app.exit(done, text, text);
    std::fputs(text.str().c_str(), stdout);
    return done_code;
  } catch (const CLI::ParseError& wrong) {
    verisim::cli::print_error((std::string(wrong.what()) + "; see verisim --help").c_str());
    return static_cast<int>(verisim::ErrorKind::usage);
  }
  return exit_code;
}

/// "verisim trace synth": the words before the first option.
std::string command_of(int argc, char** argv) {
  std::string command = "verisim";
  for (int i = 1; i < std::min(argc, 3) && argv[i][0] != '-'; ++i) command += std::string(" ") + argv[i];
  return command;
}

/// The same, and every error turned into its line and exit code.
int guarded_command(int argc, char** argv) {
  using verisim::ErrorKind;
  const verisim::MemoryUse use(command_of(argc, argv));
  try {
    check_arguments(argc, argv);
    return run_command(argc, argv);
  } catch (const verisim::Error& error) {
    const bool interrupted = error.kind() == ErrorKind::interrupted && verisim::was_interrupted();
    if (!interrupted) verisim::cli::print_error(error.what());
    return interrupted ? verisim::interrupted_exit_code() : error.exit_code();
  } catch (const std::bad_alloc&) {
    verisim::cli::print_error(verisim::cli::out_of_memory_text().c_str());
  } catch (const std::length_error&) {  // more than any memory could hold
    verisim::cli::print_error(verisim::cli::out_of_memory_text().c_str());
  } catch (const std::exception& error) {
    verisim::cli::print_error(error.what());
  }
  return static_cast<int>(ErrorKind::input);
}

}  // namespace

int main(int argc, char** argv) {
  verisim::occupy_standard_streams();
  verisim::cli::prepare_streams();
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is a failed write, not a death
  std::signal(SIGXFSZ, SIG_IGN);
  verisim::handle_interrupts();
  const int exit_code = guarded_command(argc, argv);
  if (verisim::was_interrupted() && exit_code == verisim::interrupted_exit_code())
    verisim::cli::print_error((verisim::interruption() + "; the files that it wrote are closed and valid").c_str());
  return verisim::cli::finish_streams(exit_code);
}
