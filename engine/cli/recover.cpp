#include <cstdio>
#include <memory>

#include "engine/cli/commands.hpp"
#include "engine/record/run_file.hpp"

namespace verisim::cli {

void add_recover(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("recover", "Closes the file of a run that was killed");
  auto path = std::make_shared<std::string>();
  command->add_option("RUN.h5", *path, "Run file")->required();
  command->footer("Example: verisim recover runs/peg_in_hole.h5");
  command->callback([=, &exit_code] {
    const std::optional<std::size_t> rows = recover(*path);
    if (rows)
      std::printf("%s: closed, %zu frames kept\n", path->c_str(), *rows);
    else
      std::printf("%s: is closed already, nothing to do\n", path->c_str());
    exit_code = 0;
  });
}

}  // namespace verisim::cli
