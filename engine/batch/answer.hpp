// What one run of a batch came to: what its process tells the batch, and a row of the index.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/base/run_figures.hpp"
#include "engine/batch/cell.hpp"

namespace verisim::batch {

/// What `status` of a row says.
inline constexpr const char* kStatuses[] = {"done", "failed", "diverged", "timeout", "memory"};

struct Answer {
  std::string status;    ///< of kStatuses
  std::string error;     ///< why it is not "done"
  bool answered = true;  ///< it would come to the same again; a kill, a crash, a time or a memory limit need not
  std::map<std::string, Cell> figures, timing;  ///< by the names of Layout's columns
  std::map<std::string, Cell> parameters;       ///< by their own names, as the run used them; empty: it never began
  std::vector<Measure> measures;
  std::map<std::string, std::string> inputs;  ///< file that the run read, its SHA-256
};

[[nodiscard]] std::string to_text(const Answer& answer);
/// Nothing that a process of ours did not write. @throws Json::exception for other texts.
[[nodiscard]] Answer answer_of(const std::string& text);

}  // namespace verisim::batch
