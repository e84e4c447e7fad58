// Must compile: the pair is new.
#include "tests/constraint/compile_fail/pair.hpp"
static_assert(verisim::kLookedAt<verisim::Recognizers::With<verisim::Another<verisim::Line, verisim::Cylinder>>> == 14);
