// Writes the models that the scenarios ship: make-models FOLDER. The same bytes every time (tests compare them).
#include <cstdio>

#include "engine/base/error.hpp"
#include "engine/geometry/loader.hpp"

namespace {

using verisim::Solid;

std::shared_ptr<const Solid> primitive(Solid::Kind kind, std::vector<double> sizes) {
  Solid solid;
  solid.kind = kind;
  solid.sizes = std::move(sizes);
  return std::make_shared<const Solid>(std::move(solid));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make-models FOLDER\n");
    return 2;
  }
  try {
    // The dissertation's trial, section 8.5: block 200 mm with a hole of 75 mm radius, pin of 70 mm radius and 400 mm.
    Solid block;
    block.kind = Solid::Kind::difference;
    block.children = {primitive(Solid::Kind::box, {0.375, 0.375, 0.2}), primitive(Solid::Kind::cylinder, {0.075, 0.2})};
    verisim::write_step(std::string(argv[1]) + "/peg_in_hole.step",
                        {{"block", block}, {"pin", *primitive(Solid::Kind::cylinder, {0.07, 0.4})}});
    return 0;
  } catch (const verisim::Error& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return error.exit_code();
  }
}
