// Whatever becomes of the CAD program is an error here, never a crash, and leaves nothing behind.
#include "engine/geometry/cad_client.hpp"

#include <sys/wait.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "tests/geometry/models.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/paths.hpp"

namespace verisim::cad_client_test {
namespace {

using testing::error_of;

Message request(const std::string& operation, const std::string& ballast = {}) {
  return {{"request", {text_table("operation", operation), text_table("content", ballast)}}};
}

void expect_no_child_left() {
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

std::size_t open_descriptors() {
  const std::filesystem::directory_iterator list("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(list), end(list)));
}

/// Sets VERISIM_CAD for one test.
class Program {
 public:
  explicit Program(const char* path) { setenv("VERISIM_CAD", path, 1); }
  ~Program() { unsetenv("VERISIM_CAD"); }
};

TEST(AskCad, TurnsACrashOfTheKernelIntoBadInput) {
  const std::string error =
      error_of(ErrorKind::input, [] { static_cast<void>(ask_cad(request("crash"), "damaged.step")); });
  EXPECT_EQ(
      error,
      "damaged.step: the CAD kernel or mesh reader crashed while reading (signal 6); the file is damaged or beyond it; "
      "open it in a CAD program and export it again");
  expect_no_child_left();
}

TEST(AskCad, StopsAKernelThatHangs) {
  const auto start = std::chrono::steady_clock::now();
  const std::string error =
      error_of(ErrorKind::input, [] { static_cast<void>(ask_cad(request("hang"), "endless.step", 0.2)); });
  EXPECT_NE(error.find("endless.step: the CAD kernel or mesh reader did not finish within 0.2 s"), std::string::npos)
      << error;
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
  expect_no_child_left();
}

// The request is larger than any socket buffer and nobody reads it: neither a SIGPIPE nor a deadlock.
TEST(AskCad, SurvivesAProgramThatReadsNothing) {
  const Program program("/bin/true");
  const std::string error = error_of(
      ErrorKind::input, [] { static_cast<void>(ask_cad(request("step", std::string(16 << 20, 'x')), "large.step")); });
  EXPECT_NE(error.find("exit code 0"), std::string::npos) << error;
  expect_no_child_left();
}

TEST(AskCad, RefusesAnAnswerThatIsNone) {
  const Program program("/bin/cat");  // sends the request back, whole but without sense
  EXPECT_NO_THROW(static_cast<void>(ask_cad(request("step"), "x.step")));
  const Program other("/usr/bin/env");
  EXPECT_THROW(static_cast<void>(ask_cad(request("step"), "x.step")), Error);
}

TEST(AskCad, SaysWhereTheProgramShouldBe) {
  const Program program("/nowhere/verisim-cad");
  const std::string error = error_of(ErrorKind::io, [] { static_cast<void>(ask_cad(request("step"), "x.step")); });
  EXPECT_NE(error.find("/nowhere/verisim-cad"), std::string::npos) << error;
}

std::string error_of_program(const std::string& path, ErrorKind kind) {
  const Program program(path.c_str());
  std::string error = error_of(kind, [] { static_cast<void>(ask_cad(request("step"), "x.step")); });
  expect_no_child_left();
  return error;
}

/// The program, but what it is to be loaded with is called "BEGIN.so.X", which nobody has.
std::string without_library(const test::Folder& folder, const std::string& begin) {
  std::ifstream in(paths::in_build("verisim-cad"), std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(in), {});
  const std::size_t at = bytes.find(begin + ".so.");
  EXPECT_NE(at, std::string::npos) << begin;
  bytes.at(at + begin.size() + 4) = 'X';
  const std::string path = folder.file("without " + begin);
  std::ofstream(path, std::ios::binary) << bytes;
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

std::string script(const test::Folder& folder, const std::string& text) {
  const std::string path = folder.file("script");
  std::ofstream(path) << "#!/bin/sh\n" << text << "\n";
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

TEST(AskCad, NamesALibraryThatIsNotInstalledAndItsPackage) {
  const test::Folder folder;
  EXPECT_EQ(error_of_program(without_library(folder, "libassimp"), ErrorKind::io),
            "x.step: verisim-cad cannot be loaded: the library libassimp.so.X is not installed; apt install "
            "libassimp-dev");
  EXPECT_EQ(error_of_program(without_library(folder, "libTKSTEP"), ErrorKind::io),
            "x.step: verisim-cad cannot be loaded: the library libTKSTEP.so.X is not installed; apt install "
            "libocct-data-exchange-dev");
  EXPECT_EQ(
      error_of_program(without_library(folder, "libsleef"), ErrorKind::io),
      "x.step: verisim-cad cannot be loaded: the library libsleef.so.X is not installed; install the package that "
      "has it (packages.txt)");
}

TEST(AskCad, TellsWantOfMemoryFromALibraryThatIsNotInstalled) {
  const test::Folder folder;
  const std::string wanted = "x.step: verisim-cad cannot be loaded: out of memory; give it more";
#ifndef VERISIM_SANITIZED  // whose shadow memory is larger than any limit
  const std::string limited = "ulimit -v 60000; exec '" + paths::in_build("verisim-cad") + "'";
  EXPECT_EQ(error_of_program(script(folder, limited), ErrorKind::input), wanted);
#endif
  EXPECT_EQ(error_of_program(script(folder, "exit 127"), ErrorKind::input), wanted);
  EXPECT_EQ(error_of_program(script(folder, "echo 'symbol lookup error: f' >&2; exit 127"), ErrorKind::io),
            "x.step: verisim-cad cannot be loaded (symbol lookup error: f); build or install it again");
}

Message request_of(const Solid& solid) {
  Message message = {{"request",
                      {text_table("operation", "build"), text_table("path", "solid"), number_table("scale", 1),
                       number_table("deflection", 0), number_table("angular_deflection", 0.1)}}};
  for (NamedArray& table : tables_of(solid)) message.front().tables.push_back(std::move(table));
  return message;
}

Solid bored(double radius) {
  using testing::make;
  return make(Solid::Kind::difference, make(Solid::Kind::box, {0.2, 0.1, 0.1}),
              make(Solid::Kind::cylinder, {radius, 0.2}));
}

TEST(CadSession, AnswersAsAProgramForEachRequestDoes) {
  const std::size_t before = open_descriptors();
  {
    CadSession session;
    for (int i = 1; i <= 6; ++i) {
      const Message request = request_of(bored(0.006 * i));
      const std::optional<Message> answer = session.ask(request);
      ASSERT_TRUE(answer.has_value()) << i;
      EXPECT_EQ(encode(*answer), encode(ask_cad(request, "solid"))) << i;
      EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), 0) << "it stays";
    }
  }
  expect_no_child_left();
  EXPECT_EQ(open_descriptors(), before);
}

TEST(CadSession, IsStartedAnewAfterARequestThatItCouldNotAnswer) {
  CadSession session;
  EXPECT_FALSE(session.ask(request("crash")).has_value());
  EXPECT_FALSE(session.ask(request_of(bored(0.5))).has_value());  // nothing is left of the box
  EXPECT_TRUE(session.ask(request_of(bored(0.01))).has_value());
  EXPECT_FALSE(session.ask(request("what?")).has_value());
  expect_no_child_left();
  for (const char* other : {"/bin/true", "/bin/cat", "/usr/bin/env", "/nowhere/verisim-cad"}) {
    const Program program(other);
    EXPECT_FALSE(session.ask(request_of(bored(0.01))).has_value()) << other;
    expect_no_child_left();
  }
}

TEST(CadSession, LeavesErrorsAsTheyAre) {
  CadSession session;
  const auto load = [&](CadSession* in) {
    return error_of(ErrorKind::input, [&] { static_cast<void>(load_solid(bored(0.5), {}, in)); });
  };
  EXPECT_EQ(load(&session), load(nullptr));
  EXPECT_NE(load(&session).find("nothing is left of the solid"), std::string::npos);
  expect_no_child_left();
}

TEST(AskCad, LeavesNoDescriptorOpen) {
  const std::size_t before = open_descriptors();
  for (int i = 0; i < 3; ++i) EXPECT_THROW(static_cast<void>(ask_cad(request("crash"), "x")), Error);
  EXPECT_EQ(open_descriptors(), before);
}

TEST(Message, ComesBackAsItWent) {
  const Message sent = {{"a", {text_table("t", "text"), number_table("n", 0.1)}}, {"", {}}};
  const Message back = decode(encode(sent));
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(text_of(back[0], "t"), "text");
  EXPECT_EQ(number_of(back[0], "n"), 0.1);
  EXPECT_TRUE(back[1].tables.empty());
}

TEST(Message, CutOffAnywhereIsRefused) {
  const std::string whole = encode({{"a", {text_table("t", "text"), number_table("n", 0.1)}}});
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_THROW(static_cast<void>(decode(whole.substr(0, n))), Error) << n;
}

TEST(Message, CarriesSolidsWithoutLoss) {
  using testing::make;
  const Solid pin =
      testing::placed(make(Solid::Kind::cylinder, {0.05, 0.4}), {0.1, 0.2, 0.3}, rotation_from_vector({1, 2, 3}));
  const Solid solid =
      make(Solid::Kind::difference, make(Solid::Kind::sum, make(Solid::Kind::box, {1, 2, 3}), pin), pin);
  EXPECT_EQ(solid_from({"s", tables_of(solid)}).text(), solid.text());
}

}  // namespace
}  // namespace verisim::cad_client_test
