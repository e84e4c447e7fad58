// What the record tells of the one pair of bodies of a small scene.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "engine/simulation/simulation.hpp"

namespace verisim::test {

/// The wrench of the frame's one link [N, N m]; none if its bodies are not near.
inline Wrench link_wrench(const Simulation& simulation) {
  if (simulation.table_rows().empty()) return {};
  Schema schema;
  simulation.describe(schema);
  for (const Column& column : schema.table()) {
    if (column.path != "/state/links/wrench") continue;
    std::array<double, 6> v{};
    std::memcpy(v.data(), simulation.table_rows().data() + column.offset, sizeof v);
    return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  }
  ADD_FAILURE() << "no wrench in the table";
  return {};
}

}  // namespace verisim::test
