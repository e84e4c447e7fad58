// What a command says on stdout and stderr, and whether it arrived. A full disk behind a redirection, or a stream that
// was closed, would otherwise look like success.
#pragma once

namespace verisim::cli {

/// Lets stdout hold all that a command usually says until the end, when the cause of a failure can still be told. A
/// terminal sees each line at once. To be called before anything is said.
void prepare_streams();

/// Writes out what stdout still holds and returns the exit code: `exit_code`, or 5 if something that was said on either
/// stream did not arrive and no signal ended the command. The error then stands on the other stream; of a pipe that its
/// reader closed there is none. To be called last.
[[nodiscard]] int finish_streams(int exit_code);

/// "error: TEXT" on stderr; if that fails, on stdout.
void print_error(const char* text);

}  // namespace verisim::cli
