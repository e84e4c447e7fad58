// Where the shipped scenarios are.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/own_file.hpp"

namespace verisim::cli {

/// In the folder beside the program's own, or one further up, or installed there.
[[nodiscard]] inline std::string scenarios_folder() {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path program = own_file();
  for (fs::path folder = program.parent_path(); folder != folder.root_path(); folder = folder.parent_path())
    for (const fs::path& place : {folder / "scenarios", folder / "share" / "verisim" / "scenarios"})
      if (fs::exists(place / "peg_in_hole.lua", ignored)) return place.string();
  return "scenarios";
}

}  // namespace verisim::cli
