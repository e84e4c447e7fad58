// verisim-cad: the only program that links the CAD kernel and the readers of mesh files. verisim starts it for one
// request, or with the argument "many" for all solids of a scene, so that a crash of theirs (each has some) ends this
// process and not a simulation.
//
// stdin: a message (engine/geometry/message.hpp) with one group "request", whose "operation" is
//   step, brep, mesh   content, path, scale, deflection, angular_deflection   -> one group per part
//   build        the solid's tables, path, deflection, angular_deflection -> one group
//   write_step   further groups, one solid each, named as in the file   -> a group "file" with its content
//   crash, hang  for the tests of what happens then
// stdout: the answer, or a group "error" with one line. Exit code: 0, or that of the error. With "many", messages have
// their lengths before them (with_length), and an error is the last answer.
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <iterator>
#include <optional>

#include "engine/base/standard_streams.hpp"
#include "engine/geometry/cad/kernel.hpp"
#include "engine/geometry/message.hpp"

namespace {

using namespace verisim;

/// A file that exists in memory alone: the kernel reads and writes files by their path.
class MemoryFile {
 public:
  MemoryFile() : descriptor_(memfd_create("model", MFD_CLOEXEC)) {
    if (descriptor_ < 0) fail(ErrorKind::io, "no memory file can be made for the CAD kernel; is memory left?");
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] std::string path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

  void write(const std::string& content) const {
    for (std::size_t done = 0; done < content.size();) {
      const ssize_t n = ::write(descriptor_, content.data() + done, content.size() - done);
      if (n <= 0) fail(ErrorKind::io, "the model does not fit into memory beside the CAD kernel");
      done += static_cast<std::size_t>(n);
    }
  }
  [[nodiscard]] std::string read() const {
    std::string content(static_cast<std::size_t>(lseek(descriptor_, 0, SEEK_END)), '\0');
    for (std::size_t done = 0; done < content.size();) {
      const ssize_t n = pread(descriptor_, content.data() + done, content.size() - done, static_cast<off_t>(done));
      if (n <= 0) fail(ErrorKind::io, "the memory file cannot be read back");
      done += static_cast<std::size_t>(n);
    }
    return content;
  }

 private:
  int descriptor_;
};

Message answer_of(const std::vector<Part>& parts) {
  Message answer;
  for (const Part& part : parts) answer.push_back({part.name, to_tables(part)});
  return answer;
}

Message read_file(const Group& request, const cad::Options& options, bool is_step) {
  const MemoryFile file;
  file.write(text_of(request, "content"));
  return answer_of(is_step ? cad::read_step(file.path(), options) : cad::read_brep(file.path(), options));
}

Message write_file(const Message& message) {
  std::vector<std::pair<std::string, Solid>> solids;
  for (auto group = message.begin() + 1; group != message.end(); ++group)
    solids.emplace_back(group->name, solid_from(*group));
  const MemoryFile file;
  cad::write_step(file.path(), solids);
  return {{"file", {text_table("content", file.read())}}};
}

Message serve(const Message& message, std::string& path) {
  if (message.empty()) fail(ErrorKind::usage, "verisim-cad: the request is empty; verisim starts this program itself");
  const Group& request = message.front();
  const std::string operation = text_of(request, "operation");
  if (operation == "crash") std::abort();
  if (operation == "hang") {
    for (;;) pause();
  }
  if (operation == "write_step") return write_file(message);
  path = text_of(request, "path");
  const cad::Options options{path, number_of(request, "scale"), number_of(request, "deflection"),
                             number_of(request, "angular_deflection")};
  if (operation == "build") return answer_of({cad::build(solid_from(request), options)});
  if (operation == "mesh") return answer_of(cad::read_mesh(text_of(request, "content"), options));
  return read_file(request, options, operation == "step");
}

/// The answer to the request; on failure one group "error", and its exit code.
std::pair<std::string, int> answer(const std::string& request) {
  const auto failure = [](const std::string& text, ErrorKind kind) {
    return std::pair(encode({{"error", {text_table("text", text)}}}), static_cast<int>(kind));
  };
  std::string path = "solid";
  try {
    return {encode(serve(decode(request), path)), 0};
  } catch (const Error& error) {
    return failure(error.what(), error.kind());
  } catch (const std::bad_alloc&) {
    return failure(
        path + ": out of memory: the CAD kernel needs more than it may have; simplify the model, or allow more",
        ErrorKind::input);
  } catch (...) {
    const std::string kernel = cad::describe_exception();
    return failure(fmt::format("{}: the CAD kernel fails ({}); the model is damaged or beyond it, export it again",
                               path, kernel.empty() ? "for an unknown reason" : kernel),
                   ErrorKind::input);
  }
}

/// The next request; nothing if there is none.
std::optional<std::string> next_request() {
  std::uint64_t length = 0;
  if (!std::cin.read(reinterpret_cast<char*>(&length), sizeof length)) return std::nullopt;
  std::string request(length, '\0');
  if (!std::cin.read(request.data(), static_cast<std::streamsize>(length))) return std::nullopt;
  return request;
}

bool write_all(int descriptor, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = write(descriptor, bytes.data() + done, bytes.size() - done);
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

/// Answers one request after the other. Returns the exit code.
int answer_many(int out) {
  while (const std::optional<std::string> request = next_request()) {
    const auto [bytes, code] = answer(*request);
    if (!write_all(out, with_length(bytes))) return static_cast<int>(ErrorKind::io);
    if (code != 0) return code;
  }
  return 0;
}

int answer_one(int out) {
  const std::string request(std::istreambuf_iterator<char>(std::cin), {});
  const auto [bytes, code] = answer(request);
  return write_all(out, bytes) ? code : static_cast<int>(ErrorKind::io);
}

void limit_harm() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // who would read the answer?
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
#ifndef VERISIM_SANITIZED  // whose shadow memory is larger than any limit
  const rlimit memory{rlim_t{4} << 30, rlim_t{4} << 30};
  setrlimit(RLIMIT_AS, &memory);
#endif
}

}  // namespace

int main(int count, char** arguments) {
  occupy_standard_streams();
  limit_harm();
  // What the kernel prints must not get into the answer.
  const int out = dup(STDOUT_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  cad::initialize();
  const bool many = count == 2 && std::string_view(arguments[1]) == kManyRequests;
  const int code = many ? answer_many(out) : answer_one(out);
  // The kernel's static objects are not destroyed: some of its versions crash there, after the answer was good.
  std::_Exit(code);
}
