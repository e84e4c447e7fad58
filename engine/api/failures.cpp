#include "engine/api/failures.hpp"

#include "engine/base/text.hpp"

namespace verisim {

void check_line(const std::string& what, const std::string& text) {
  if (const std::string fault = line_fault(text); !fault.empty())
    fail(ErrorKind::usage, "{} {}: '{}'; write it as one line of UTF-8", what, fault, shown(text, 60));
}

std::string unknown_name(const std::string& what, const std::string& name, const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(name, known);
  return fmt::format("no {} is called '{}'{}", what, shown(name),
                     nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest));
}

}  // namespace verisim
