// The recorded runs of upstream's tracker (reference/wii): channels in, upstream's pose out.
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "engine/wii/channels.hpp"
#include "tests/support/paths.hpp"

namespace verisim::wii {

struct RecordedRow {
  double t = 0;
  std::array<double, 7> truth{};  ///< px py pz qx qy qz qw in L
  Channels channels{};
  std::array<std::string, 7> upstream;  ///< as printed: px py pz qx qy qz qw
  bool lock = false;
};

/// Empty if the reference folder is not there.
inline std::vector<RecordedRow> read_recording(const std::string& name) {
  std::ifstream file(paths::in_shared_reference("wii/") + name);
  std::vector<RecordedRow> rows;
  std::string line;
  std::getline(file, line);  // column names
  while (std::getline(file, line)) {
    std::vector<std::string> cells;
    std::stringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    RecordedRow row;
    row.t = std::stod(cells.at(0));
    for (std::size_t i = 0; i < 7; ++i) row.truth[i] = std::stod(cells.at(1 + i));
    for (std::size_t i = 0; i < kChannels; ++i) row.channels[i] = std::stod(cells.at(8 + i));
    for (std::size_t i = 0; i < 7; ++i) row.upstream[i] = cells.at(24 + i);
    row.lock = cells.at(31) == "1";
    rows.push_back(row);
  }
  return rows;
}

}  // namespace verisim::wii
