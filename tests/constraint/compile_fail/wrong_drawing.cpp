// Must not compile: a list that is not the one drawn in recognizers.hpp.
#include "tests/constraint/compile_fail/pair.hpp"
using namespace verisim;
static_assert(recognizing::is_as_drawn<Recognizers::With<Another<Line, Cylinder>>>(),
              "the drawing does not show the list of recognizers");
