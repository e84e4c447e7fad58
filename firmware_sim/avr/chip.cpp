#include "firmware_sim/avr/chip.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "firmware_sim/firmware/encoder.hpp"
extern "C" {
#include <avr_extint.h>
#include <avr_ioport.h>
#include <avr_uart.h>
#include <sim_avr.h>
#include <sim_elf.h>
}

DEFINE_FIFO(uint16_t, uart_fifo);

namespace verisim::firmware {
namespace {

// Registers of the ATmega328P as addresses of data memory (data sheet, chapter 30).
constexpr int kPcifr = 0x3b, kPortD = 0x2b, kGpior0 = 0x3e, kGpior1 = 0x4a;
constexpr int kTccr0a = 0x44, kTccr1a = 0x80;
constexpr std::array<int, 4> kCompare{0x47, 0x48, 0x88, 0x8a};  // OCR0A, OCR0B, OCR1AL, OCR1BL
constexpr std::array<int, 4> kControl{kTccr0a, kTccr0a, kTccr1a, kTccr1a};
constexpr std::array<int, 4> kConnected{0x80, 0x20, 0x80, 0x20};  // COMnA1, COMnB1: the compare unit drives the pin
constexpr std::array<int, 4> kBackward{1 << 2, 1 << 3, 1 << 4, 1 << 7};
constexpr std::uint32_t kDataInElf = 0x800000;
constexpr std::uint64_t kBootMax = 10 * kCyclesPerMs;
constexpr int kInterruptCycles = 4;

struct Pin {
  char port;
  int bit;
};
constexpr std::array<std::array<Pin, 2>, 4> kEncoderPins{
    {{{{'C', 0}, {'C', 1}}}, {{{'C', 2}, {'C', 3}}}, {{{'C', 4}, {'C', 5}}}, {{{'B', 0}, {'B', 3}}}}};

std::uint32_t address_of(const elf_firmware_t& elf, const char* name) {
  for (std::uint32_t i = 0; i < elf.symbolcount; ++i)
    if (std::strcmp(elf.symbol[i]->symbol, name) == 0) return elf.symbol[i]->addr - kDataInElf;
  throw std::runtime_error(std::string("the firmware has no variable '") + name + "'; build it anew");
}

void keep_quiet(avr_t* /*avr*/, int level, const char* format, va_list arguments) {
  if (level <= LOG_ERROR) std::vfprintf(stderr, format, arguments);
}

}  // namespace

struct Chip::Hooks {
  static Chip& of(void* chip) { return *static_cast<Chip*>(chip); }

  static void on_sleep(avr_t* avr, avr_cycle_count_t cycles) { of(avr->custom.data).slept_ += cycles + 1; }

  static void on_interrupt(avr_irq_t* /*irq*/, std::uint32_t vector, void* chip) {
    avr_t& avr = *of(chip).avr_;
    if (vector != 0) {
      of(chip).entered_ = avr.cycle;
      avr.cycle += kInterruptCycles;
    } else {
      of(chip).state_.load.interrupt_cycles += avr.cycle - of(chip).entered_ + kInterruptCycles;  // RETI takes 4, too
    }
  }

  static void on_byte(avr_irq_t* /*irq*/, std::uint32_t value, void* chip) {
    Chip& self = of(chip);
    const std::uint64_t start = std::max<std::uint64_t>(self.avr_->cycle, self.line_is_free_);
    self.line_is_free_ = start + kCyclesPerByte;
    self.leaving_.push_back({self.line_is_free_, static_cast<std::uint8_t>(value)});
  }

  static void on_clock(avr_t* avr, avr_io_addr_t /*address*/, std::uint8_t /*value*/, void* chip) {
    of(chip).clock_began_ = avr->cycle;
  }

  static void on_sample(avr_t* avr, avr_io_addr_t /*address*/, std::uint8_t /*value*/, void* chip) {
    Chip& self = of(chip);
    BoardLoad& load = self.state_.load;
    if (self.last_sample_ != 0) {
      const auto period = static_cast<std::uint32_t>(avr->cycle - self.last_sample_);
      load.control_period_min = load.control_period_max == 0 ? period : std::min(load.control_period_min, period);
      load.control_period_max = std::max(load.control_period_max, period);
    }
    self.last_sample_ = avr->cycle;
  }

  static avr_cycle_count_t on_event(avr_t* /*avr*/, avr_cycle_count_t when, void* chip) {
    of(chip).apply_events(when);
    return of(chip).next_event();
  }

  static avr_cycle_count_t on_end(avr_t* /*avr*/, avr_cycle_count_t /*when*/, void* /*chip*/) { return 0; }
};

Chip::Chip(const std::string& elf) {
  avr_global_logger_set(keep_quiet);
  elf_firmware_t program{};
  if (elf_read_firmware(elf.c_str(), &program) != 0)
    throw std::runtime_error(elf + ": no firmware can be read there; build it with avr-gcc, or name another");
  encoders_ = address_of(program, "encoders");
  bytes_lost_ = address_of(program, "bytes_lost");
  avr_ = avr_make_mcu_by_name("atmega328p");
  if (avr_ == nullptr) throw std::runtime_error("this simavr does not know the ATmega328P");
  avr_init(avr_);
  avr_->frequency = kClockHz;
  avr_load_firmware(avr_, &program);
  avr_->frequency = kClockHz;
  avr_->custom.data = this;
  avr_->sleep = Hooks::on_sleep;
  avr_irq_register_notify(avr_get_interrupt_irq(avr_, AVR_INT_ANY) + AVR_INT_IRQ_RUNNING, Hooks::on_interrupt, this);
  avr_irq_register_notify(avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), Hooks::on_byte, this);
  avr_register_io_write(avr_, kGpior0, Hooks::on_sample, this);
  avr_register_io_write(avr_, kGpior1, Hooks::on_clock, this);
  std::uint32_t no_flags = 0;  // neither waits for the wall clock nor prints
  avr_ioctl(avr_, AVR_IOCTL_UART_SET_FLAGS('0'), &no_flags);
  for (avr_io_t* io = avr_->io_port; io != nullptr; io = io->next)
    if (std::strcmp(io->kind, "uart") == 0) uart_ = reinterpret_cast<avr_uart_t*>(io);
  if (uart_ == nullptr) throw std::runtime_error("this simavr's ATmega328P has no serial line");
  for (std::size_t wheel = 0; wheel < 4; ++wheel)
    for (std::size_t bit = 0; bit < 2; ++bit) {
      const Pin pin = kEncoderPins[wheel][bit];
      pins_[wheel][bit] = avr_io_getirq(avr_, AVR_IOCTL_IOPORT_GETIRQ(pin.port), pin.bit);
    }
  boot();
}

Chip::~Chip() {
  if (avr_ != nullptr) avr_terminate(avr_);
}

void Chip::boot() {
  edges_lost_before_ = state_.load.edges_lost;
  edges_ = {};
  bytes_ = {};
  expected_ = {};
  bytes_lost_seen_ = 0;
  leaving_.clear();
  last_sample_ = 0;
  clock_began_ = 0;
  avr_reset(avr_);
  for (std::uint8_t pin = 0; pin < 2; ++pin) avr_extint_set_strict_lvl_trig(avr_, pin, 0);
  for (std::uint8_t wheel = 0; wheel < 4; ++wheel) apply({0, wheel, levels_[wheel]}, true);
  const std::uint64_t begun = avr_->cycle;
  while (clock_began_ == 0) {
    if (avr_->cycle - begun > kBootMax) throw std::runtime_error("the firmware does not start its clock");
    run_until(avr_->cycle + 1);
  }
  uart_->cycles_per_byte = kCyclesPerByte;
  for (std::uint8_t wheel = 0; wheel < 4; ++wheel) apply({0, wheel, levels_[wheel]}, true);
  begin_ = line_is_free_ = clock_began_;
  slept_before_ = slept_;
  state_.duty = {};
  state_.sent_count = 0;
}

void Chip::run_until(std::uint64_t cycle) {
  if (avr_->cycle < cycle) avr_cycle_timer_register(avr_, cycle - avr_->cycle, Hooks::on_end, this);
  while (avr_->cycle < cycle) {
    avr_run(avr_);
    if (avr_->state == cpu_Done || avr_->state == cpu_Crashed)
      throw std::runtime_error("the firmware has crashed or stopped its processor");
  }
}

void Chip::apply(const EncoderEdge& edge, bool anew) {
  const unsigned changed = anew ? 3U : static_cast<unsigned>(levels_[edge.wheel] ^ edge.levels);
  for (int bit = 0; bit < 2; ++bit) {
    if ((changed >> bit & 1U) == 0) continue;
    avr_raise_irq(pins_[edge.wheel][static_cast<std::size_t>(bit)], edge.levels >> bit & 1U);
  }
  Encoder counter;
  counter.levels = levels_[edge.wheel];
  counter.edge(edge.levels, 0, 0);
  if (!anew) expected_[edge.wheel] = static_cast<std::uint16_t>(expected_[edge.wheel] + counter.count);
  if (!anew && counter.illegal != 0) edges_lost_before_ += 2;
  levels_[edge.wheel] = edge.levels;
}

void Chip::arrive(const TimedByte& byte) {
  if (!avr_regbit_get(avr_, uart_->rxen)) return;
  if (uart_fifo_get_read_size(&uart_->input) >= 3) {  // two in the buffer and one in the shift register
    ++state_.load.bytes_lost;
    return;
  }
  uart_->rx_cnt = 0;
  uart_fifo_write(&uart_->input, byte.value);
  avr_raise_interrupt(avr_, &uart_->rxc);
}

std::uint64_t Chip::next_event() const {
  std::uint64_t next = 0;
  if (!edges_.empty()) next = begin_ + edges_.front().cycle;
  if (!bytes_.empty() && (next == 0 || begin_ + bytes_.front().cycle < next)) next = begin_ + bytes_.front().cycle;
  return next;
}

void Chip::apply_events(std::uint64_t until) {
  for (; !edges_.empty() && begin_ + edges_.front().cycle <= until; edges_ = edges_.subspan(1))
    apply(edges_.front(), false);
  for (; !bytes_.empty() && begin_ + bytes_.front().cycle <= until; bytes_ = bytes_.subspan(1)) arrive(bytes_.front());
}

void Chip::advance(std::span<const EncoderEdge> edges, std::span<const TimedByte> in) {
  if (!is_powered_) {
    for (const EncoderEdge& edge : edges) levels_[edge.wheel] = edge.levels;
    return;
  }
  edges_ = edges;
  bytes_ = in;
  state_.load.edges_seen += edges.size();
  apply_events(avr_->cycle);  // the last instruction of the millisecond before may have reached into this one
  if (const std::uint64_t first = next_event(); first != 0)
    avr_cycle_timer_register(avr_, first - avr_->cycle, Hooks::on_event, this);
  run_until(begin_ + kCyclesPerMs);
  apply_events(begin_ + kCyclesPerMs - 1);
  avr_cycle_timer_cancel(avr_, Hooks::on_event, this);
  begin_ += kCyclesPerMs;
  state_.load.cycles += kCyclesPerMs;
  state_.load.busy_cycles += kCyclesPerMs - (slept_ - slept_before_);
  awake_ms_ = slept_ == slept_before_ ? awake_ms_ + 1 : 0;
  slept_before_ = slept_;
  read_outputs();
  read_losses();
}

void Chip::read_outputs() {
  for (std::size_t wheel = 0; wheel < 4; ++wheel) {
    const bool is_connected = (avr_->data[kControl[wheel]] & kConnected[wheel]) != 0;
    const int pwm = is_connected ? avr_->data[kCompare[wheel]] : 0;
    state_.duty[wheel] = static_cast<std::int16_t>((avr_->data[kPortD] & kBackward[wheel]) != 0 ? -pwm : pwm);
  }
  state_.sent_count = 0;
  for (; !leaving_.empty() && leaving_.front().cycle < begin_; leaving_.pop_front())
    state_.sent[state_.sent_count++] = {static_cast<std::uint32_t>(leaving_.front().cycle + kCyclesPerMs - begin_),
                                        leaving_.front().value};
}

/// Compares what came with what the firmware has counted, whenever no edge is on its way to it. A processor that is in
/// interrupts all the time always has some on their way: after 5 ms without sleep they count as lost.
void Chip::read_losses() {
  const std::uint16_t bytes_lost = word_at(bytes_lost_);
  state_.load.bytes_lost += static_cast<std::uint16_t>(bytes_lost - bytes_lost_seen_);
  bytes_lost_seen_ = bytes_lost;
  const bool has_pending = (avr_->data[kPcifr] & 3) != 0 || !avr_->sreg[S_I];
  if (has_pending && awake_ms_ < 5) return;
  std::uint64_t lost = edges_lost_before_;
  for (std::size_t wheel = 0; wheel < 4; ++wheel) {
    const std::uint16_t counted = word_at(encoders_ + static_cast<std::uint32_t>(wheel * sizeof(Encoder)));
    const auto missing = static_cast<std::int16_t>(expected_[wheel] - counted);
    lost += static_cast<std::uint64_t>(missing < 0 ? -missing : missing);
  }
  state_.load.edges_lost = lost;
}

std::uint16_t Chip::word_at(std::uint32_t address) const {
  return static_cast<std::uint16_t>(avr_->data[address] | avr_->data[address + 1] << 8);
}

void Chip::reset() {
  if (is_powered_) boot();
}

void Chip::set_powered(bool on) {
  if (on && !is_powered_) boot();
  is_powered_ = on;
  state_.duty = {};
  state_.sent_count = 0;
}

}  // namespace verisim::firmware
