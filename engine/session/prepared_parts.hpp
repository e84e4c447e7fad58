// The folder of parts that runs prepared before (engine/record/prepared_store.hpp): where it is, and for which build.
#pragma once

#include <memory>
#include <string>

#include "engine/record/prepared_store.hpp"

namespace verisim {

/// The folder that VERISIM_CACHE names, else verisim in XDG_CACHE_HOME, else in ~/.cache; empty: there is no home.
[[nodiscard]] std::string prepared_folder();

/// The store of this program, verisim-cad beside it and this CPU (tessellations differ in their last bits between
/// CPUs). Null if it is not wanted, there is no folder, or a program cannot be told from another build.
[[nodiscard]] std::shared_ptr<PreparedStore> prepared_parts(bool wanted = true);

/// How many entries were not what was written; empty: none.
[[nodiscard]] std::string damage_warning(const PreparedStore* store);
/// Says so on stderr.
void warn_of_damage(const PreparedStore* store);

}  // namespace verisim
