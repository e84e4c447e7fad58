// Must not compile: circle and cylinder are recognized already.
#include "tests/constraint/compile_fail/pair.hpp"
static_assert(verisim::kLookedAt<verisim::Recognizers::With<verisim::Another<verisim::Circle, verisim::Cylinder>>> > 0);
