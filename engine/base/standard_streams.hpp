// The three descriptors that every program is given: 0, 1 and 2.
#pragma once

namespace verisim {

/// Occupies those that were closed when the program started (`2>&-`), so that no file of ours gets such a number and
/// with it what is meant for the terminal. To be called first in main. What is read from or written to one that was
/// closed goes on failing. Ends the program with exit code 5 if not even that can be done.
void occupy_standard_streams();

}  // namespace verisim
