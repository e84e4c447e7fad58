// Must not compile: circle and cylinder are recognized already, in the other order.
#include "tests/constraint/compile_fail/pair.hpp"
static_assert(verisim::kLookedAt<verisim::Recognizers::With<verisim::Another<verisim::Cylinder, verisim::Circle>>> > 0);
