// Events that are also said on stderr, because a result may not be what was asked for.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "engine/base/text.hpp"
#include "engine/record/run_file.hpp"

namespace verisim {

[[nodiscard]] inline bool is_warning(const Event& event) {
  return event.kind == "hybrid" || event.kind == "gravity" || event.kind == "sinking" || event.kind == "overlap";
}

/// Likewise, and those that the script's own words and errors are: they are said when they come.
[[nodiscard]] inline bool is_any_warning(const Event& event) {
  return is_warning(event) || event.kind == "warning" || event.kind == "script error";
}

/// One line each; of very many the first, for /events has them all.
inline void print_warnings(const std::vector<std::string>& texts) {
  constexpr std::size_t kMost = 8;
  const std::size_t printed = texts.size() > kMost ? kMost - 1 : texts.size();
  for (std::size_t i = 0; i < printed; ++i) std::fprintf(stderr, "warning: %s\n", shown(texts[i]).c_str());
  if (printed < texts.size())
    std::fprintf(stderr, "warning: and %zu more of this kind; /events has them all\n", texts.size() - printed);
}

}  // namespace verisim
