// firmware_sim/avr/main.cpp
// The ATmega328P's side of the firmware: pins, timers, interrupts, the serial line. 16 MHz.
//
//   encoders    front left PC0 A, PC1 B   front right PC2, PC3   rear left PC4, PC5   rear right PB0, PB3
//   PWM         front left PD6 (OC0A)     front right PD5 (OC0B) rear left PB1 (OC1A) rear right PB2 (OC1B)
//   direction   front left PD2            front right PD3        rear left PD4        rear right PD7       1 = backward
//   timer 2     250 ticks of 64 clocks: the millisecond           USART 0  115,200 baud, 8 N 1
//
// Encoder inputs and direction outputs lie on different ports, so that no write to PORTD can touch an input.
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

#include "firmware_sim/firmware/firmware.hpp"

namespace fw = verisim::firmware;

// Names that verisim-avr looks for, to see what the firmware has counted and lost.
extern "C" {
fw::Encoder encoders[fw::kWheels];
volatile uint16_t bytes_lost = 0;
}

namespace {

fw::Firmware firmware(encoders);
volatile uint8_t begun = 0;  // milliseconds, counted by the timer
uint8_t seen_c = 0;          // levels of port C in the last interrupt

constexpr uint8_t kDirections[] = {_BV(PD2), _BV(PD3), _BV(PD4), _BV(PD7)};
constexpr uint8_t kEncoderC = 0x3f;
constexpr uint8_t kEncoderB = _BV(PB0) | _BV(PB3);

struct Stamp {
  uint16_t ms;
  uint8_t tick;
};

inline __attribute__((always_inline)) Stamp stamp() {
  const uint8_t tick = TCNT2;
  uint16_t ms = firmware.now_ms();
  // The millisecond has ended but its interrupt still waits for this one.
  if ((TIFR2 & _BV(OCF2A)) && tick < fw::kTicksPerMs / 2) ++ms;
  return {ms, tick};
}

inline __attribute__((always_inline)) uint8_t levels_b(uint8_t pins) {
  return static_cast<uint8_t>((pins & _BV(PB0) ? 1 : 0) | (pins & _BV(PB3) ? 2 : 0));
}

}  // namespace

ISR(PCINT1_vect) {
  const uint8_t pins = PINC & kEncoderC;
  const Stamp at = stamp();
  const uint8_t changed = pins ^ seen_c;
  seen_c = pins;
  if (changed & 0x03) encoders[0].edge(pins & 3, at.ms, at.tick);
  if (changed & 0x0c) encoders[1].edge((pins >> 2) & 3, at.ms, at.tick);
  if (changed & 0x30) encoders[2].edge(pins >> 4, at.ms, at.tick);
}

ISR(PCINT0_vect) {
  const uint8_t pins = PINB;
  const Stamp at = stamp();
  encoders[3].edge(levels_b(pins), at.ms, at.tick);
}

ISR(TIMER2_COMPA_vect) {
  firmware.tick();
  begun = static_cast<uint8_t>(begun + 1);
  if (firmware.has_bytes()) UCSR0B |= _BV(UDRIE0);
}

ISR(USART_RX_vect) {
  const uint8_t byte = UDR0;
  if (!firmware.byte_arrived(byte)) bytes_lost = bytes_lost + 1;
}

ISR(USART_UDRE_vect) {
  uint8_t byte;
  if (firmware.next_byte(byte))
    UDR0 = byte;
  else
    UCSR0B &= static_cast<uint8_t>(~_BV(UDRIE0));
}

namespace {

void start() {
  DDRB = _BV(PB1) | _BV(PB2);
  DDRD = _BV(PD1) | _BV(PD2) | _BV(PD3) | _BV(PD4) | _BV(PD5) | _BV(PD6) | _BV(PD7);
  // Phase-correct PWM, 8 bit: 0 and 255 are exactly off and on, which fast PWM cannot do. 490 Hz, as Arduino's core has
  // it.
  TCCR0A = _BV(COM0A1) | _BV(COM0B1) | _BV(WGM00);
  TCCR0B = _BV(CS01) | _BV(CS00);
  TCCR1A = _BV(COM1A1) | _BV(COM1B1) | _BV(WGM10);
  TCCR1B = _BV(CS11) | _BV(CS10);
  UCSR0A = _BV(U2X0);
  UBRR0 = 16;
  UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
  UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
  seen_c = PINC & kEncoderC;
  for (uint8_t wheel = 0; wheel < 3; ++wheel) encoders[wheel].levels = (seen_c >> (2 * wheel)) & 3;
  encoders[3].levels = levels_b(PINB);
  PCMSK1 = kEncoderC;
  PCMSK0 = kEncoderB;
  PCICR = _BV(PCIE0) | _BV(PCIE1);
  OCR2A = fw::kTicksPerMs - 1;
  TCCR2A = _BV(WGM21);
  TIMSK2 = _BV(OCIE2A);
  TCCR2B = _BV(CS22);
  GPIOR1 = 1;  // tells who watches: time runs
}

void drive(const int16_t (&duty)[fw::kWheels]) {
  uint8_t backward = 0;
  uint8_t pwm[fw::kWheels];
  for (uint8_t wheel = 0; wheel < fw::kWheels; ++wheel) {
    if (duty[wheel] < 0) backward |= kDirections[wheel];
    pwm[wheel] = static_cast<uint8_t>(duty[wheel] < 0 ? -duty[wheel] : duty[wheel]);
  }
  constexpr uint8_t all = _BV(PD2) | _BV(PD3) | _BV(PD4) | _BV(PD7);
  PORTD = static_cast<uint8_t>((PORTD & ~all) | backward);
  OCR0A = pwm[0];
  OCR0B = pwm[1];
  OCR1A = pwm[2];
  OCR1B = pwm[3];
  GPIOR0 = 1;  // tells who watches: a sample has acted
}

}  // namespace

int main() {
  start();
  set_sleep_mode(SLEEP_MODE_IDLE);
  bool has_sampled = false;
  for (uint8_t done = 0;; ++done) {
    cli();
    while (done == begun) {
      sleep_enable();
      sei();  // takes effect after the next instruction: no interrupt comes between and is slept through
      sleep_cpu();
      sleep_disable();
      cli();
    }
    sei();
    if (has_sampled) drive(firmware.duty());  // with the timer, however long the sample took: no jitter
    has_sampled = firmware.work();
    firmware.report();
  }
}
