// firmware_sim/firmware/interrupts.hpp
// Keeps interrupts out while what they write is read. On a board without interrupts it is nothing.
#pragma once

#if defined(__AVR__)
#include <avr/interrupt.h>
#include <avr/io.h>
#endif

namespace verisim {
namespace firmware {

class InterruptsOff {
 public:
#if defined(__AVR__)
  InterruptsOff() : status_(SREG) {
    cli();
  }
  ~InterruptsOff() {
    __asm__ volatile("" ::: "memory");  // what was read or written in between stays in between
    SREG = status_;
  }

 private:
  unsigned char status_;
#else
  InterruptsOff() {}
  ~InterruptsOff() {}
#endif

 public:
  InterruptsOff(const InterruptsOff&) = delete;
  InterruptsOff& operator=(const InterruptsOff&) = delete;
};

}  // namespace firmware
}  // namespace verisim
