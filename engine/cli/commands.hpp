// The commands of verisim. Each add_… declares a command and its options on `app`; its work runs as CLI11's callback
// and sets the process's exit code.
#pragma once

#include <CLI/CLI.hpp>

namespace verisim::cli {

void add_run(CLI::App& app, int& exit_code);
void add_batch(CLI::App& app, int& exit_code);
void add_replay(CLI::App& app, int& exit_code);
void add_recover(CLI::App& app, int& exit_code);
void add_inspect(CLI::App& app, int& exit_code);
void add_trace(CLI::App& app, int& exit_code);
void add_wii(CLI::App& app, int& exit_code);
void add_robot(CLI::App& app, int& exit_code);
void add_compare(CLI::App& app, int& exit_code);
void add_stability(CLI::App& app, int& exit_code);
void add_tradeoff(CLI::App& app, int& exit_code);
void add_reproduce(CLI::App& app, int& exit_code);
void add_doctor(CLI::App& app, int& exit_code);

}  // namespace verisim::cli
